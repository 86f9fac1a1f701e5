"""Measured Cartesian tests beside what was predicted of the same poses and directions (Table 6 of the paper)."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.results.model import Block, Column, Sign, Statement, Table
from catseye.app.results.numbers import NOTHING, SHARE_EXPECTED, counted, number
from catseye.app.results.resolution.naming import STEP, interval_text
from catseye.app.results.resolution.predicted import PredictedLeast
from catseye.app.results.resolution.result import AnyTest, read_resolution


@dataclass(frozen=True)
class Compared:
    """A measured direction at a pose and the prediction of it; None where nothing is predicted."""

    test: AnyTest
    predicted: PredictedLeast | None

    @property
    def inside(self) -> bool | None:
        """Whether the measured step lies in the predicted interval; None where one of them is not known.

        An upper end that is not known is open beside a predicted step; without one, it is all that is predicted.
        """
        least, measured = self.predicted, self.test.lis
        if least is None or measured is None or least.lis is least.high is None:
            return None
        return (least.low or 0.0) <= measured.value and (least.high is None or measured.value <= least.high)


def compared_steps(predicted: Sequence[PredictedLeast], tests: Sequence[AnyTest]) -> list[Compared]:
    """Return the Cartesian tests, each with the prediction of its pose and direction."""
    known = {(one.pose, one.direction): one for one in predicted}
    return [
        Compared(test, known.get((test.pose or "", direction_word(test))))
        for test in tests
        if test.test == "cartesian"
    ]


def compare_with_measured(predicted: Sequence[PredictedLeast], path: Path) -> list[Compared]:
    """Return the Cartesian tests of a result that are of a predicted pose and have a least step.

    Raises:
        UsageError: the file is no result, or none of its Cartesian tests is of a predicted pose.
    """
    every = compared_steps(predicted, read_resolution(path).tests)
    found = [one for one in every if one.predicted is not None and one.test.lis is not None]
    if not found:
        poses = ", ".join(dict.fromkeys(one.pose for one in predicted))
        measured = ", ".join(dict.fromkeys(one.test.pose or "without a name" for one in every)) or "none"
        raise UsageError(
            f"{path}: no Cartesian test with a least step is of a predicted pose: predicted are {poses}, measured "
            f"{measured}; give poses the same names in both files"
        )
    return found


def direction_word(test: AnyTest) -> str:
    """Return the direction of a Cartesian test as predictions call it, +X or -X."""
    return f"{'-' if test.direction == -1 else '+'}{test.joint}"


def comparison_blocks(compared: Sequence[Compared]) -> list[Block]:
    """Return measured steps beside predicted ones, and how many lie in their intervals."""
    judged = [one for one in compared if one.inside is not None]
    inside = sum(bool(one.inside) for one in judged)
    statement = Statement(
        Sign.GOOD if judged and inside >= SHARE_EXPECTED * len(judged) else Sign.ATTENTION,
        f"{inside} of {counted(len(judged), 'measured least step')} within the predicted 95 % interval.",
    )
    columns = (
        Column("pose", "pose"),
        Column("direction", "direction"),
        Column("predicted", "predicted (95 %)", "mm"),
        Column("measured", "measured (95 %)", "mm"),
        Column("inside", "within"),
    )
    rows = tuple(
        (
            one.test.pose or "",
            direction_word(one.test).replace("-", "−"),
            _predicted_text(one.predicted),
            _measured_text(one.test),
            {True: "yes", False: "no", None: NOTHING}[one.inside],
        )
        for one in compared
    )
    caption = (
        "Predicted and measured least increment steps of the tool; ≤: only an upper limit is predicted; a measured "
        "step up to it counts as inside"
    )
    return [statement, Table("comparison", caption, columns, rows)]


def _predicted_text(least: PredictedLeast | None) -> str:
    if least is None:
        return NOTHING
    if least.lis is None and least.high is not None:
        return f"≤ {number(least.high, STEP)}"
    return interval_text(least.lis, least.low, least.high)


def _measured_text(test: AnyTest) -> str:
    return NOTHING if test.lis is None else interval_text(test.lis.value, test.lis.low, test.lis.high)
