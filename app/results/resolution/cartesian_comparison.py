"""Measured Cartesian tests beside what was predicted of the same poses and directions."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.results.resolution.cartesian_prediction import PredictedDirection
from catseye.app.results.resolution.result import LeastStep, read_resolution


@dataclass(frozen=True)
class Compared:
    """A measured least step and the prediction of it."""

    predicted: PredictedDirection
    measured: LeastStep

    @property
    def inside(self) -> bool | None:
        """Whether the measured step lies in the predicted interval; None where nothing is predicted.

        An end that is not known is open.
        """
        least = self.predicted.least
        if least.lis is None:
            return None
        return (least.low or 0.0) <= self.measured.value and (
            least.high is None or self.measured.value <= least.high
        )


def compare_with_measured(rows: Sequence[PredictedDirection], path: Path) -> list[Compared]:
    """Return the Cartesian tests of a result that have a least step, each with its prediction.

    Raises:
        UsageError: the file is no result, or none of its Cartesian tests is of a predicted pose.
    """
    predicted = {(row.place.name, row.direction): row for row in rows}
    tests = [test for test in read_resolution(path).tests if test.test == "cartesian"]
    found = [
        Compared(row, test.lis)
        for test in tests
        if test.lis is not None
        and (row := predicted.get((test.pose or "", f"{'-' if test.direction == -1 else '+'}{test.joint}")))
    ]
    if not found:
        poses = ", ".join(dict.fromkeys(row.place.name for row in rows))
        measured = ", ".join(dict.fromkeys(test.pose or "without a name" for test in tests)) or "none"
        raise UsageError(
            f"{path}: no Cartesian test with a least step is of a predicted pose: predicted are {poses}, measured "
            f"{measured}; give poses the same names in both files"
        )
    return found
