"""How a run ended, in the words of the store and of the exit code."""

from dataclasses import dataclass
from typing import Literal

from catseye.app.engine.control import RunControl
from catseye.app.engine.halt import PRESS
from catseye.app.errors import (
    CatseyeError,
    HeldTooLongError,
    LimitError,
    NotAcknowledgedError,
    SafetyError,
    exit_code_of,
    text_of,
    trace_of,
)
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.run_events import ErrorReported
from catseye.app.protocol.state import ControlState
from catseye.drivers.roles.errors import AlarmError, NotArrivedError, NotReadyError
from catseye.procedures.kit.errors import RejectedError

_WHERE = "app.log of the run shows where"

EndStatus = Literal["complete", "stopped", "aborted", "failed"]


class DeviceFaultError(CatseyeError):
    """A device or the program failed during a run; the cause says which."""

    def __init__(self, cause: BaseException) -> None:
        super().__init__(text_of(cause, _WHERE))
        self.__cause__ = cause


@dataclass(frozen=True)
class Ending:
    """How a run ended.

    Attributes:
        status: complete; stopped by the operator, or for want of one, and resumable; aborted for safety or from
            outside; failed.
        exit_code: of the process.
        text: why; empty for a complete run.
        rejected: the data that is stored is no use, and the run never goes on.
    """

    status: EndStatus
    exit_code: ExitCode
    text: str = ""
    rejected: bool = False


COMPLETE = Ending("complete", ExitCode.DONE)


def react(control: RunControl, error: Exception) -> None:
    """Bring the robot to rest after an error: what makes motion unsafe aborts, everything else stops."""
    fault = error if isinstance(error, CatseyeError) else DeviceFaultError(error)
    if isinstance(error, (AlarmError, NotReadyError, NotArrivedError)) or (
        isinstance(error, SafetyError) and not isinstance(error, (LimitError, NotAcknowledgedError))
    ):
        control.abort(fault)
    else:
        control.fault(fault)


def ending_of(control: RunControl, error: BaseException) -> Ending:
    """Return what an error makes of a run, once the robot is at rest."""
    cause = error.__cause__ if isinstance(error, DeviceFaultError) and error.__cause__ else error
    code, text = exit_code_of(cause), text_of(cause, _WHERE)
    troubles = [report.text for report in control.reports if not report.standstill]
    if troubles:
        return Ending("aborted", ExitCode.SAFETY, _unconfirmed(cause, text, troubles))
    if control.state == ControlState.ABORTED:
        return Ending("aborted", code, text)
    stopped = code == ExitCode.INTERRUPTED or isinstance(cause, (NotAcknowledgedError, HeldTooLongError))
    return Ending("stopped" if stopped else "failed", code, text, isinstance(cause, RejectedError))


def report_of(ending: Ending, error: BaseException) -> ErrorReported:
    """Return what clients are shown of an error that ends a run."""
    return ErrorReported(text=ending.text, exit_code=int(ending.exit_code), trace=trace_of(error))


def _unconfirmed(cause: BaseException, text: str, troubles: list[str]) -> str:
    """Return what is said where the standstill was not confirmed: the warning first, then each thing once.

    Args:
        text: of the cause.
        troubles: of the halts.
    """
    # What a driver noted on its error is the trouble with its own stop, which the halt tells anew.
    for note in getattr(cause, "__notes__", ()):
        text = text.replace(f"; {note}", "")
    # Where the link broke, the trouble with the stop quotes what ended the run.
    first = [] if any(text in trouble for trouble in troubles) else [text]
    warned = [trouble for trouble in dict.fromkeys(troubles) if trouble.startswith(PRESS)]
    others = [trouble for trouble in dict.fromkeys(troubles) if trouble not in warned]
    return "; ".join([*(warned[-1:] or [PRESS]), *first, *others])
