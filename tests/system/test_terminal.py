"""The terminal as a process of its own, in front of emulators on TCP and on a serial line."""

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.patience import HANG_S
from tests.system.command import Emulated, emulated, environment

LINE = re.compile(
    r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6}\+00:00 (?P<direction>tx|rx) (?P<hex>[0-9a-f ]+)\|(?P<text>.*)\|"
)
PORT = '"tcp://127.0.0.1:10002"'


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with emulated(tmp_path_factory.mktemp("terminal")) as running:
        yield running


def started(cell: Path, device: str, *options: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "catseye", "terminal", device, "--cell", str(cell), *options],
        cwd=cell.parent,
        env=environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def talk(cell: Path, device: str, typed: str, *options: str) -> tuple[int, str, str]:
    """Run the terminal with this input; return exit code, stdout and stderr."""
    process = started(cell, device, *options)
    stdout, stderr = process.communicate(typed, timeout=HANG_S)
    return process.returncode, stdout, stderr


def traffic(stdout: str, direction: str) -> bytes:
    """Return the bytes that were shown, after a check of each line."""
    found = [LINE.fullmatch(line) for line in stdout.splitlines()]
    assert all(found), stdout
    return b"".join(bytes.fromhex(m["hex"]) for m in found if m and m["direction"] == direction)


def test_typed_bytes_are_sent_and_traffic_is_shown_and_logged(bench: Emulated) -> None:
    log = bench.cell.parent / "counter.log"
    code, stdout, stderr = talk(bench.cell, "interferometer", "I\nS\n", "--log", str(log), "--wait", "0.3")
    assert code == 0, stderr
    assert traffic(stdout, "tx") == b"I\r\nS\r\n"
    assert traffic(stdout, "rx").startswith(b"CATSEYE LINE COUNTER EMULATOR")
    assert log.read_text() == stdout
    assert "interferometer at tcp://127.0.0.1:" in stderr
    code, again, _ = talk(bench.cell, "interferometer", "49 0d", "--hex", "--log", str(log), "--wait", "0.3")
    assert code == 0
    assert traffic(again, "tx") == b"I\r"
    assert log.read_text() == stdout + again


def test_what_comes_unasked_is_shown_until_ctrl_c(bench: Emulated) -> None:
    process = started(bench.cell, "interferometer")
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write("B1000\n")
    process.stdin.flush()
    shown = "".join(process.stdout.readline() for _ in range(8))
    assert traffic(shown, "rx").count(b" mm\r\n") >= 2
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=HANG_S)
    assert process.returncode == 130
    assert stderr.splitlines()[-1] == "catseye: interrupted"


def test_nothing_goes_to_the_robot_without_its_cells_name(bench: Emulated) -> None:
    before = len(bench.ask(op="log", device="robot")["entries"])
    code, stdout, stderr = talk(bench.cell, "robot", "1;1;STATE\n", "--eol", "cr")
    assert (code, stdout) == (2, "")
    assert "listening only" in stderr
    assert "not sent: the robot may move" in stderr
    code, stdout, stderr = talk(bench.cell, "robot", "1;1;STATE\n", "--arm", "other-cell")
    assert (code, stdout) == (5, "")
    assert "nothing was sent" in stderr
    assert len(bench.ask(op="log", device="robot")["entries"]) == before
    code, stdout, _ = talk(
        bench.cell, "robot", "1;1;STATE\n", "--eol", "cr", "--arm", "lab-1", "--wait", "0.3"
    )
    assert code == 0
    assert traffic(stdout, "rx").startswith(b"QoK")


@pytest.mark.parametrize(
    ("device", "typed", "code", "text"),
    [
        ("interferometr", "", 2, "did you mean interferometer?"),
        ("interferometer", "\\q\n", 2, "is no escape"),
        ("environment", "", 0, "environment at tcp://"),
    ],
)
def test_bad_input_is_a_sentence(bench: Emulated, device: str, typed: str, code: int, text: str) -> None:
    ended, _, stderr = talk(bench.cell, device, typed, "--wait", "0.1")
    assert ended == code
    assert text in stderr
    assert "Traceback" not in stderr


def test_a_device_that_is_not_there_is_exit_code_3(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    with emulated(tmp_path) as gone:
        cell.write_text(gone.cell.read_text())
    code, _, stderr = talk(cell, "interferometer", "I\n")
    assert code == 3
    assert "cannot connect" in stderr


def test_it_speaks_over_a_serial_line(tmp_path: Path) -> None:
    line = f"serial://{tmp_path}/counter?baud=115200&parity=E"
    with emulated(tmp_path, edit={PORT: f'"{line}"'}) as bench:
        code, stdout, stderr = talk(bench.cell, "interferometer", "I\n", "--wait", "0.3")
        assert code == 0, stderr
        assert traffic(stdout, "rx").startswith(b"CATSEYE LINE COUNTER EMULATOR")


def test_a_log_without_room_is_reported_before_anything_is_sent(bench: Emulated) -> None:
    code, _, stderr = talk(bench.cell, "interferometer", "I\n", "--log", "/dev/full")
    assert code == 2, stderr
    assert "--log /dev/full: cannot be written: No space left on device" in stderr
    assert "fault of the program" not in stderr
