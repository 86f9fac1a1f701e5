"""Questions about the tracker of a serial arm, the nests on the table, and the ballbar."""

from typing import Final

from catseye.app.cell.tool import shipped_tools
from catseye.app.cell.wizard.question import Question

TRACKER: Final = "Tracker, the arm before it, three nests on the table."
"""Above the questions about the tracker."""

NEST: Final = "tracker.nest."
"""Begins the keys of the nests, which are lines of a table: their number follows."""

FEWEST_NESTS: Final = 3


def tool() -> Question:
    """Return what is asked about the tool."""
    return Question(
        "robot.tool",
        "Tool",
        f"{', '.join(shipped_tools())}, or the path of a description of your own (TOML): targets, mass, centre",
        find_out="positions of the tool's nests in the frame of the flange, to a millimetre: from a drawing, or by "
        "ruler",
    )


def places() -> list[Question]:
    """Return what is asked about where arm, tracker and nests are; a few millimetres do."""
    base = [
        Question(
            "tracker.base_mm",
            "Arm's base, mm",
            "x, y, z of the arm's base in the tracker's frame, roughly: read the tracker at three places on the "
            "arm's foot, or use a ruler; tracker-calibration finds it more exactly",
            "numbers",
            find_out="position of the arm's base in the tracker's frame, to a few centimetres",
        ),
        Question(
            "tracker.base_deg",
            "Arm's base turned, deg",
            "rx, ry, rz with R = Rz·Ry·Rx: 0, 0, rz where both stand upright; rz is the angle from the tracker's x "
            "axis to the arm's, counter-clockwise seen from above",
            "numbers",
            find_out="angle from the tracker's x axis to the arm's, seen from above",
        ),
        Question(
            "tracker.cone_deg",
            "Cone of a nest, deg",
            "largest angle to its normal for a returned beam",
            "number",
        ),
    ]
    return [*base, *map(_nest, range(FEWEST_NESTS))]


def ballbar() -> list[Question]:
    """Return what is asked about the ballbar."""
    return [
        Question("ballbar.length_mm", "Ballbar: length, mm", "in the middle of its range", "number"),
        Question("ballbar.range_mm", "Ballbar: range, ± mm", "how far it can lengthen or shorten", "number"),
        Question(
            "ballbar.centre_mm",
            "Ballbar: cup, mm",
            "x, y, z of the fixed cup in the frame of the arm's base, to a few centimetres: ballbar-cup finds it "
            "more exactly",
            "numbers",
            find_out="position of the ballbar's cup in the arm's base frame",
        ),
    ]


def _nest(number: int) -> Question:
    return Question(
        f"{NEST}{number}",
        f"Nest {number + 1} on the table, mm",
        "x, y, z in the tracker's frame, to a few millimetres, as it reads them; three nests that do not move and "
        "lie far apart, not on a line, make the world frame in which a drift of the tracker shows",
        "numbers",
        find_out="what the tracker reads with a retroreflector in this nest",
        without="with fewer than three there is no world frame, so a drift of the tracker goes unnoticed",
    )
