"""Identification with a robust loss, or without the distances that cannot belong to the others."""

from catseye.app.results.scara.result import RobustPart
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.core.robust import Loss
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.diagnostics.rejection import reject
from catseye.calibration.scara.diagnostics.robust import robust_fit
from catseye.calibration.scara.identification import Identification

LOSSES: dict[str, Loss] = {"huber": "huber", "soft-l1": "soft-l1"}
"""Losses by the words of the command line; least squares is none of them."""


def identify_robustly(
    problem: Problem, loss: str, limit: float | None
) -> tuple[Identification, Contributions | None]:
    """Identify; first leave out what lies beyond a limit, then weigh what is far off less.

    Args:
        loss: "squares", "huber" or "soft-l1".
        limit: robust standard deviations beyond which a distance is left out; None for none.

    Returns:
        The identification, and where the uncertainty of a robust loss comes from; None for least squares.

    Raises:
        CalibrationError: the points cannot determine the model, or too many would have to be left out.
    """
    identified = problem.solve() if limit is None else reject(problem, limit).identified
    if loss not in LOSSES:
        return identified, None
    robust = robust_fit(identified, LOSSES[loss])
    return robust.identified, robust.contributions


def robust_text(part: RobustPart, n_points: int) -> str:
    """Return what a robust loss made of the distances, and what that means for the uncertainties."""
    return (
        f"{part.loss} loss: {part.counted_little} of {n_points} distances count less than half (beyond "
        f"{part.half:.1f} robust standard deviations of {part.sigma_um:.1f} µm); the scatter that the distances show "
        "stands for the stated white contributors"
    )
