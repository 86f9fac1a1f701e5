"""Identification with a robust loss, or without the distances that cannot belong to the others."""

from calibration.diagnostics.problem import Problem
from calibration.diagnostics.rejection import reject
from calibration.diagnostics.robust import Loss, robust_fit
from calibration.identification import Identification

LOSSES: dict[str, Loss] = {"huber": "huber", "soft-l1": "soft-l1"}
"""Losses by the words of the command line; least squares is none of them."""


def identify_robustly(problem: Problem, loss: str, limit: float | None) -> Identification:
    """Identify; first leave out what lies beyond a limit, then weigh what is far off less.

    Args:
        problem: distances and model.
        loss: "squares", "huber" or "soft-l1".
        limit: robust standard deviations beyond which a distance is left out; None for none.

    Raises:
        CalibrationError: the points cannot determine the model, or too many would have to be left out.
    """
    identified = problem.solve() if limit is None else reject(problem, limit).identified
    return robust_fit(identified, LOSSES[loss]).identified if loss in LOSSES else identified
