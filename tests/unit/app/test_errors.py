"""Which exit code an error leads to."""

import asyncio

import pytest

from catseye.app import errors
from catseye.app.errors import UsageError, exit_code_of, text_of
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.scara.errors import OutOfReachError
from catseye.drivers.roles.errors import AlarmError, LinkTimeoutError, ProfileError
from catseye.procedures.kit.errors import BeamLostError, PlanError, PlanLimitError


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (errors.MeasurementRejectedError("x"), 1),
        (errors.UsageError("x"), 2),
        (errors.ConfigError("x"), 2),
        (errors.LinkFailedError("x"), 3),
        (errors.PromptUnansweredError("x"), 4),
        (errors.SafetyError("x"), 5),
        (errors.LimitError("x"), 5),
        (errors.StorageError("x"), 6),
        (errors.InterruptedRunError("x"), 130),
        (errors.TerminatedRunError("x"), 143),
        (OutOfReachError("x"), 2),
        (ConvergenceError("x"), 1),
        (AlarmError("x", 1), 5),
        (ProfileError("x"), 2),
        (LinkTimeoutError("x"), 3),
        (PlanLimitError("x"), 5),
        (PlanError("x"), 2),
        (BeamLostError("x"), 1),
        (TimeoutError(), 4),
        (KeyboardInterrupt(), 130),
        (asyncio.CancelledError(), 143),
        (ZeroDivisionError(), 70),
        (OSError("x"), 70),
        (ExceptionGroup("two", [AlarmError("x", 1), UsageError("y")]), 5),
        (ExceptionGroup("two", [AlarmError("x", 1), ValueError()]), 70),
    ],
)
def test_each_error_has_its_exit_code(error: BaseException, code: int) -> None:
    assert exit_code_of(error) == code


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (errors.UsageError("no such cell: write one"), "no such cell: write one"),
        (TimeoutError(), "TimeoutError"),
        (KeyError("theta1"), "internal error: KeyError: 'theta1'; this is a fault of the program"),
        (AssertionError(), "internal error: AssertionError; this is a fault of the program"),
    ],
)
def test_only_a_fault_of_the_program_is_called_one(error: BaseException, text: str) -> None:
    assert text_of(error) == text
