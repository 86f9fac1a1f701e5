"""The application's errors: one small tree, each class with the exit code it leads to.

Every text says what happened, where, and what to do.
"""

import asyncio
import os
import traceback
from typing import ClassVar, Final

from catseye.app.exitcode import ExitCode
from catseye.calibration.core.errors import ArgumentError, BudgetError, CalibrationError
from catseye.calibration.scara.errors import MapRangeError, OutOfReachError
from catseye.drivers.roles.errors import AlarmError, DeviceError, NotArrivedError, NotReadyError, ProfileError
from catseye.procedures.kit.errors import ManualStepError, PlanError, PlanLimitError, ProcedureError
from catseye.simulators.errors import EmulatorError

DEBUG: Final = "CATSEYE_DEBUG"
"""Variable of the environment that asks for tracebacks."""


class CatseyeError(Exception):
    """Root of the application's errors.

    Args:
        text: what happened, where, and what to do.
    """

    exit_code: ClassVar[ExitCode] = ExitCode.REJECTED


class MeasurementRejectedError(CatseyeError):
    """The measurement does not meet a criterion."""


class UsageError(CatseyeError):
    """The command asks for something that cannot be done."""

    exit_code = ExitCode.USAGE


class ConfigError(CatseyeError):
    """A cell file, a profile or an answers file is wrong."""

    exit_code = ExitCode.USAGE


class LinkFailedError(CatseyeError):
    """One or more devices cannot be used; the text lists every one of them."""

    exit_code = ExitCode.DEVICE


class ArmInUseError(CatseyeError):
    """Another program moves this arm, or whether one does cannot be known."""

    exit_code = ExitCode.DEVICE


class PromptUnansweredError(CatseyeError):
    """Nobody answered a question that has no safe answer."""

    exit_code = ExitCode.TIMEOUT


class HeldTooLongError(CatseyeError):
    """Nobody was there to let a run go on that waited; it can be resumed."""

    exit_code = ExitCode.TIMEOUT


class SafetyError(CatseyeError):
    """A safety condition forbids motion."""

    exit_code = ExitCode.SAFETY


class LimitError(SafetyError):
    """A target lies outside the limits of the cell; the robot was not moved."""


class UnwalkedError(LimitError):
    """A real arm would drive where nobody has walked it; it was not moved."""


class ConditionLostError(SafetyError):
    """The surroundings do not permit motion now; a run is suspended until they do."""


class InterruptionError(SafetyError):
    """Motion has to stop, and begins again only when somebody has acknowledged that."""


class NotAcknowledgedError(SafetyError):
    """The arm was stopped, and nobody has acknowledged that; the run can be resumed."""


class StorageError(CatseyeError):
    """The data cannot be stored or read; a run stops at once."""

    exit_code = ExitCode.STORAGE


class InterruptedRunError(CatseyeError):
    """The operator stopped or aborted the run."""

    exit_code = ExitCode.INTERRUPTED


class TerminatedRunError(CatseyeError):
    """The run was ended from outside: SIGTERM, SIGHUP or a cancelled task."""

    exit_code = ExitCode.TERMINATED


class OutputError(OSError):
    """Nothing more can be written to stdout.

    An OSError still: who publishes events takes that for a front end that is gone.
    """


class ReaderGoneError(OutputError):
    """Whoever read stdout has gone, which is no failure: nobody is left to read a message."""


class ReaderStuckError(OutputError):
    """Whoever reads stdout or stderr is there, and has not read for long; it may go on later."""


# The first class that fits decides, so special cases stand before their roots. A configuration that cannot
# be carried out is the user's input (2); a calculation that gives no number has rejected the data (1). A link
# that stays silent is a device failure (3): 4 is kept for waits of the program itself.
_FOREIGN: tuple[tuple[type[BaseException], ExitCode], ...] = (
    (OutOfReachError, ExitCode.USAGE),
    (MapRangeError, ExitCode.USAGE),
    (BudgetError, ExitCode.USAGE),
    (ArgumentError, ExitCode.USAGE),
    (CalibrationError, ExitCode.REJECTED),
    (PlanLimitError, ExitCode.SAFETY),
    (PlanError, ExitCode.USAGE),
    (ManualStepError, ExitCode.USAGE),
    (ProcedureError, ExitCode.REJECTED),
    (AlarmError, ExitCode.SAFETY),
    (NotReadyError, ExitCode.SAFETY),
    (NotArrivedError, ExitCode.SAFETY),
    (EmulatorError, ExitCode.USAGE),
    (ProfileError, ExitCode.USAGE),
    (DeviceError, ExitCode.DEVICE),
    (ReaderGoneError, ExitCode.READER_GONE),
    (OutputError, ExitCode.STORAGE),
    (TimeoutError, ExitCode.TIMEOUT),
    (KeyboardInterrupt, ExitCode.INTERRUPTED),
    (asyncio.CancelledError, ExitCode.TERMINATED),
)


def exit_code_of(error: BaseException) -> ExitCode:
    """Return the exit code an error leads to; an unknown error is a fault of the program.

    A group of errors has the code of its first member, unless one of them is a fault of the program: that hides
    behind nothing else.
    """
    if isinstance(error, CatseyeError):
        return error.exit_code
    if isinstance(error, BaseExceptionGroup):
        codes = [exit_code_of(member) for member in error.exceptions]
        return ExitCode.FAULT if ExitCode.FAULT in codes else codes[0]
    return next((code for kind, code in _FOREIGN if isinstance(error, kind)), ExitCode.FAULT)


def text_of(error: BaseException, where: str = "") -> str:
    """Return the text of an error for people; a fault of the program is called one.

    Args:
        where: says where to find more about a fault of the program; empty where there is nothing.
    """
    if exit_code_of(error) != ExitCode.FAULT:
        return str(error) or type(error).__name__
    named = f"{type(error).__name__}: {error}".removesuffix(": ")
    return ", ".join(filter(None, [f"internal error: {named}; this is a fault of the program", where]))


def trace_of(error: BaseException) -> str:
    """Return the traceback of an error if the environment asks for it, else nothing."""
    return "".join(traceback.format_exception(error)) if os.environ.get(DEBUG) else ""
