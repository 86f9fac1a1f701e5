"""Where the `catseye` command begins: whatever fails from here on has an exit code, what cannot be imported included.

Nothing but the standard library is imported before that.
"""

import os
import signal
import sys
from contextlib import suppress
from typing import Final, NoReturn

from catseye.app.exitcode import ExitCode

_STREAMS: Final = (("stdin", "r"), ("stdout", "w"), ("stderr", "w"))
"""By their descriptors."""


def main() -> None:
    """Run the command line; every error becomes a sentence on stderr and an exit code."""
    open_closed_descriptors()
    # The matrices are small: threads of the linear algebra would wait for one another and for busy cores.
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    try:
        from catseye.app.cli import cli
        from catseye.app.cli.event_channel import open_channel

        open_channel()
        cli()
    except SystemExit:
        # Another Ctrl-C must not change the exit code. A handler would not do: the interpreter takes it away while it
        # ends, and dies by the signal.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        raise
    except BaseException as error:  # noqa: BLE001  # the outermost frame reports it and ends the process
        _end(error)


def open_closed_descriptors() -> None:
    """Open stdin, stdout and stderr on nothing where they were closed when the process began.

    A file, or a link to a device, would get their numbers, and everything that is said would go there.
    """
    for number, (name, mode) in enumerate(_STREAMS):
        if getattr(sys, name) is None:
            nothing = os.open(os.devnull, os.O_RDWR)
            if nothing != number:
                os.dup2(nothing, number)
                os.close(nothing)
            setattr(sys, name, open(number, mode, encoding="utf-8", closefd=False))  # noqa: SIM115  # for as long as the process lives


def _end(error: BaseException) -> NoReturn:
    # The process is ending anyway; another Ctrl-C must not cut the sentence short.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        from catseye.app.cli.failure import write_failure

        code = write_failure(error)
    except Exception as fault:  # noqa: BLE001  # what reports it may be what cannot be imported
        code = ExitCode.FAULT
        with suppress(OSError):
            sys.stderr.write(f"catseye: internal error: {error!r}; it cannot be reported: {fault!r}\n")
    sys.exit(int(code))
