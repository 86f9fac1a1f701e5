"""The start of the terminal user interface: what it needs, who shows what, and its end by a signal."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Final, NoReturn

from catseye.app.errors import ConfigError, UsageError
from catseye.app.exitcode import ExitCode
from catseye.app.files.documents import read_toml

_LEAVE_S: Final = 3.0
"""For the program to end by itself on a signal, s."""


def show(
    cell: Path | None, root: Path, speed: float, campaign: Path | None = None, job: str = ""
) -> NoReturn:
    """Show the interface until the user quits.

    Args:
        cell: cell file; None for the only one in this folder, else set-up.
        speed: bench seconds in one real second; emulators only.
        campaign: file whose stages are the day's; None for the whole way of the cell.
        job: of that campaign; empty: any run of the cell counts.

    Raises:
        UsageError: there is no terminal to draw on, or no such cell file.
    """
    _require_terminal()
    _give_way()
    from catseye.app.service.command_process import Commands
    from catseye.app.tui.app import CatseyeApp
    from catseye.app.tui.heap import modules_left_alone
    from catseye.app.tui.keys import keys_file, read_keymap
    from catseye.app.tui.link import EngineLink
    from catseye.app.tui.login import Login
    from catseye.app.tui.preferences import preferences_file
    from catseye.app.tui.session import Session
    from catseye.drivers.roles.clock import SystemClock

    keymap: dict[str, str] = {}
    trouble: tuple[str, str] | None = None
    try:
        keymap = read_keymap(keys_file())
    except ConfigError as error:
        trouble = ("Your keys are not used; the program's own apply", str(error))
    clock = SystemClock()
    found = cell if cell is not None else _only_cell(Path())
    if cell is not None and not cell.is_file():
        raise UsageError(
            f"{cell}: there is no such file; write one with catseye init {cell}, or without --cell"
        )
    if cell is not None and not _is_cell(cell):
        raise UsageError(
            f'{cell}: not a cell file: its first key is format = "catseye-cell/1"; see catseye init'
        )
    login = Login()
    link = EngineLink(root, found, clock, login.before_engine)
    session = Session(link, Commands(), root, found, clock.monotonic_s, speed, login=login)
    session.campaign, session.job = campaign, job
    app = CatseyeApp(session, keymap, "bench" if found is not None else "setup", trouble, preferences_file())
    with modules_left_alone(), _ends_on_signals(app.leave_on_signal):
        code = app.run()
    if code is None and app.return_code:
        sys.stderr.write(
            "catseye tui ended because of the fault shown above. The engine continues without it: a run is held "
            "unless [engine] on_client_lost in the cell file says otherwise, and a jog is stopped. Start catseye "
            "tui again.\n"
        )
        code = ExitCode.FAULT
    sys.exit(code or 0)


@contextmanager
def _ends_on_signals(leave: Callable[[int], None]) -> Iterator[None]:
    """End the program on SIGTERM and SIGHUP.

    The handlers are those of the interpreter: the event loop hears of no signal while it waits for a terminal to take
    what is drawn, and a terminal that is gone or stands still never does.

    Args:
        leave: called with the signal's number; when the process has not ended some seconds later it is ended.
    """

    def heard(number: int, _frame: FrameType | None) -> None:
        watchdog = threading.Timer(_LEAVE_S, os._exit, (128 + number,))
        watchdog.daemon = True
        watchdog.start()
        leave(number)

    before = {number: signal.signal(number, heard) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _give_way() -> None:
    """Wait for a processor that is free, where the system knows such a thing: readings come before pictures.

    The engine that is started from here does not take after its parent in this.
    """
    with suppress(AttributeError, OSError):
        os.sched_setscheduler(0, os.SCHED_BATCH | os.SCHED_RESET_ON_FORK, os.sched_param(0))


def _require_terminal() -> None:
    # Textual draws on stderr.
    if not (sys.stdin.isatty() and sys.stdout.isatty() and sys.stderr.isatty()):
        raise UsageError("the terminal interface needs a terminal: use catseye run in scripts")
    if os.environ.get("TERM", "dumb") == "dumb":
        raise UsageError(
            "the terminal interface needs a terminal that can position text: TERM is not set, or dumb"
        )
    if "utf" not in sys.stderr.encoding.lower():
        raise UsageError(
            f"the terminal interface draws with Unicode and this terminal is set to {sys.stderr.encoding}: "
            "LANG=C.UTF-8 catseye tui"
        )


def _only_cell(folder: Path) -> Path | None:
    """Return the only cell file of a folder; None when there is none, or several."""
    found = [path for path in sorted(folder.glob("*.toml")) if _is_cell(path)]
    return found[0] if len(found) == 1 else None


def _is_cell(path: Path) -> bool:
    try:
        return str(read_toml(path).get("format", "")).startswith("catseye-cell/")
    except ConfigError:
        return False
