"""Whatever goes wrong in the process of a command, its exit code says what kind of thing it was."""

import asyncio
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from catseye import entry
from catseye.app import cli
from catseye.app.errors import UsageError
from catseye.app.protocol import procedures
from tests.patience import HANG_S

ROOT = Path(__file__).parents[3]


def code_of(*words: str, stderr: int = subprocess.PIPE) -> int:
    """Return the exit code of the command in a process of its own."""
    command = [sys.executable, "-m", "catseye", *words]
    return subprocess.run(
        command, stdout=subprocess.PIPE, stderr=stderr, cwd=ROOT, timeout=60, check=False
    ).returncode


def code_with(error: BaseException, monkeypatch: pytest.MonkeyPatch) -> object:
    """Return the exit code of a command that fails with this."""

    def fail() -> list[object]:
        raise error

    monkeypatch.setattr(procedures, "procedures", fail)
    monkeypatch.setattr(sys, "argv", ["catseye", "procedures"])
    return _code(monkeypatch)


def _code(monkeypatch: pytest.MonkeyPatch) -> object:
    # The process of the tests goes on.
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    with pytest.raises(SystemExit) as ended:
        entry.main()
    return ended.value.code


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (ZeroDivisionError("x"), 70),
        (BrokenPipeError(32, "Broken pipe"), 70),
        (ExceptionGroup("two", [UsageError("x"), ZeroDivisionError("y")]), 70),
        (ExceptionGroup("two", [UsageError("x"), UsageError("y")]), 2),
        (BaseExceptionGroup("two", [KeyboardInterrupt(), UsageError("y")]), 130),
        (asyncio.CancelledError(), 143),
    ],
)
def test_each_error_has_its_exit_code(
    error: BaseException, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert code_with(error, monkeypatch) == code


def test_what_cannot_be_imported_is_a_fault(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delattr(sys.modules["catseye.app"], "cli")
    for name in [name for name in sys.modules if name.startswith(cli.__name__)]:
        monkeypatch.setitem(sys.modules, name, None)
    assert _code(monkeypatch) == 70
    assert "internal error" in capsys.readouterr().err


def test_a_full_disk_behind_stderr_changes_no_exit_code() -> None:
    with open("/dev/full", "wb") as full:
        assert code_of("doctor", "none.toml", stderr=full.fileno()) == 2


ENDING = """
import os, signal, sys, types
from catseye import entry

def cli():
    sys.exit(CODE)

sys.modules["catseye.app.cli"] = types.SimpleNamespace(cli=cli)
sys.modules["catseye.app.cli.event_channel"] = types.SimpleNamespace(open_channel=lambda: None)
class Late:
    def __del__(self, kill=os.kill, own=os.getpid(), number=signal.SIGINT):
        kill(own, number)

late = Late()
late.itself = late
try:
    print("said", end="")
    entry.main()
finally:
    os.kill(os.getpid(), signal.SIGINT)
"""
"""A signal comes as soon as the command has ended, another one when the interpreter has no handlers any more."""


@pytest.mark.parametrize(("code", "expected"), [("0", 0), ("4", 4), ("", 0), ("'fault'", 1)])
def test_ctrl_c_at_the_very_end_keeps_the_exit_code(code: str, expected: int) -> None:
    text = ENDING.replace("CODE", code)
    done = subprocess.run(
        [sys.executable, "-c", text], capture_output=True, text=True, timeout=HANG_S, check=False
    )
    assert (done.returncode, done.stdout) == (expected, "said"), done.stderr
