"""What a calibration is worth, in sentences: how well it predicts, what the rows say of it, what was left out."""

from dataclasses import replace
from typing import Final

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import counted
from catseye.app.results.serial_arm.result import SerialArmResult

_NOTHING: Final = 1e-12
"""Reduced χ² of residuals that are exact."""

_FAR_TOO_LARGE: Final = 10.0
"""Uncertainties of so many times the residuals are a mistake, not caution."""

_ERRORS: Final = ("table-accuracy", "figure-errors", "figure-places")
_PARAMETERS: Final = ("table-parameters",)
_MODELS: Final = ("table-models",)
_DEVIATIONS: Final = ("table-parameters", "figure-deviations-mm", "figure-deviations-deg")
_REJECTED: Final = ("table-rejected",)


def verdict(result: SerialArmResult) -> list[Statement]:
    """Return the sentences, what matters most first."""
    return [
        replace(_accuracy(result), see=_ERRORS),
        *_seen(_of_stated_uncertainties(result), _PARAMETERS),
        *_seen(_left_over(result), _ERRORS),
        *_seen(_of_the_arm(result), _PARAMETERS),
        *_seen(_not_compared(result), _MODELS),
        *_seen(_implausible(result), _DEVIATIONS),
        *(Statement(Sign.ATTENTION, f"{text}.") for text in result.remarks),
        *_seen(_rejected(result), _REJECTED),
    ]


def _seen(said: list[Statement], see: tuple[str, ...]) -> list[Statement]:
    """Return statements with the tables and figures of the report that show them."""
    return [replace(one, see=see) for one in said]


def _accuracy(result: SerialArmResult) -> Statement:
    held, frames = result.cross_validation, result.frames
    before = "" if frames is None else f"; with the links as drawn {frames.mean_mm:.3f} mm"
    return Statement(
        Sign.GOOD,
        f"Model {result.model}: poses left out are missed by {held.mean_mm:.3f} mm on average, "
        f"{held.max_mm:.3f} mm at most{before}.",
    )


def _of_stated_uncertainties(result: SerialArmResult) -> list[Statement]:
    """Return whether the rows contradict what is stated of them."""
    said: list[Statement] = []
    if result.fit.lack_of_fit:
        said.append(
            Statement(
                Sign.ATTENTION,
                "The stated uncertainties do not explain the residuals: the arm does what the model lacks, or they "
                "are too small. The uncertainties of the parameters are widened by that.",
            )
        )
    chi2 = result.fit.chi2_reduced
    if chi2 is not None and chi2 < _FAR_TOO_LARGE**-2:
        times = f"{chi2**-0.5:.0f} times" if chi2 > _NOTHING else "more than a million times"
        said.append(
            Statement(
                Sign.ATTENTION,
                f"The stated uncertainties are {times} what the residuals show, and those of the "
                "parameters are too large by as much: check whether u_mm is in mm, not in µm.",
            )
        )
    return said


def _left_over(result: SerialArmResult) -> list[Statement]:
    """Return by how much single poses are missed."""
    if result.left_mm is None:
        return []
    return [
        Statement(
            Sign.NEUTRAL,
            f"Poses that were left out show that the model misses a single pose by {result.left_mm:.3f} mm in each "
            "coordinate (standard deviation), beyond what is known of parameters and rows. Predicted "
            "uncertainties include it.",
        )
    ]


def _of_the_arm(result: SerialArmResult) -> list[Statement]:
    """Return what arm and base did while they were measured."""
    said: list[Statement] = []
    if result.joints == "read back":
        said.append(
            Statement(
                Sign.ATTENTION,
                "The joints that the controller read back explain the measurements better than the commanded ones: "
                "the arm did not reach its commands.",
            )
        )
    if result.base_drift_mm is not None:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"The base moved against the instrument: it went about {result.base_drift_mm:.2g} mm in each "
                "coordinate (root mean square of the three) from where it stood at the first pose. The uncertainties "
                "of the parameters know it. Measure the reference nests again through the day.",
            )
        )
    if result.pose_scatter_mm is not None:
        said.append(
            Statement(
                Sign.NEUTRAL,
                f"The targets of a pose are off together, by {result.pose_scatter_mm:.2g} mm in each coordinate from "
                "pose to pose: the arm's repeatability, and what the model lacks. The uncertainties know it.",
            )
        )
    return said


def _not_compared(result: SerialArmResult) -> list[Statement]:
    return [
        Statement(Sign.NEUTRAL, f"The model {one.model} was not compared: {one.reason}.")
        for one in result.candidates
        if one.mean_mm is None and one.reason
    ]


def _implausible(result: SerialArmResult) -> list[Statement]:
    """Return what was kept although it is implausible."""
    kept = result.implausible
    if kept is None:
        return []
    text = f"Implausible, and kept because of: {kept.accepted}. {' '.join(kept.findings)}"
    return [Statement(Sign.BAD, text)]


def _rejected(result: SerialArmResult) -> list[Statement]:
    """Return which poses were left out."""
    if not result.rejected:
        return []
    names = ", ".join(one.pose for one in result.rejected[:8])
    text = f"{counted(len(result.rejected), 'pose')} left out, which contradict all others: {names}."
    return [Statement(Sign.ATTENTION, text)]
