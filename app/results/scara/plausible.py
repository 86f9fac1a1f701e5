"""The gate before a result: an arm that cannot be the one that was measured is not handed over."""

from collections.abc import Iterator
from contextlib import contextmanager

from catseye.app.errors import CatseyeError
from catseye.app.results.scara.implausible_text import finding_texts, implausible_text
from catseye.app.results.scara.result import Implausible
from catseye.calibration.core.errors import CalibrationError, ConvergenceError, InsufficientPointsError
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.findings import Verdict
from catseye.calibration.scara.plausibility.judgement import judge


class ImplausibleError(CatseyeError):
    """The identified arm cannot be the one that was measured.

    Args:
        verdict: what speaks against it.
    """

    reason = "implausible"

    def __init__(self, verdict: Verdict) -> None:
        super().__init__(
            f"the result is implausible and not kept: {implausible_text(verdict)}. Correct that and identify again; "
            "identify --accept-implausible TEXT keeps it with a reason"
        )
        self.findings = finding_texts(verdict)


def require_plausible(
    problem: Problem, found: Identification, bounds: Bounds, accepted: str | None = None
) -> Implausible | None:
    """Refuse an arm that cannot be the one that was measured.

    Args:
        problem: that it solves.
        accepted: why it is kept all the same; None refuses it.

    Returns:
        What speaks against an arm that is kept all the same; None where nothing does.

    Raises:
        ImplausibleError: it breaks a bound, a mistake explains the distances, or another arm fits as well.
    """
    verdict = judge(problem, found, bounds)
    if not verdict.implausible:
        return None
    if accepted is None:
        raise ImplausibleError(verdict)
    return Implausible(accepted=accepted, findings=finding_texts(verdict))


@contextmanager
def failures_explained(problem: Problem, bounds: Bounds) -> Iterator[None]:
    """Let a failing identification say which mistake in the distances explains it, or what they leave open.

    Raises:
        ImplausibleError: a mistake does, or it does not settle as links are hardly determined.
        CalibrationError: none does, for what it failed.
    """
    try:
        yield
    except InsufficientPointsError:
        # So few distances fit many an arm; whatever explained them would be a guess.
        raise
    except CalibrationError as error:
        verdict = judge(problem, None, bounds)
        if verdict.mistakes or (verdict.vague and isinstance(error, ConvergenceError)):
            raise ImplausibleError(verdict) from None
        raise
