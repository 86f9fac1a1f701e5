"""An instrument's file against the path that was driven: order, unit, places."""

import math
import re
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pytest

from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.errors import TableFileError
from catseye.procedures.scara.path.measured_path import matched_positions
from catseye.procedures.scara.path.path_plan import plan_path
from catseye.procedures.scara.path.tracked_path import PathPoint
from tests.unit.procedures.benches import bench

POINTS = plan_path(bench(), y_from_mm=-300.0, y_to_mm=300.0, step_mm=50.0).points
TURN = math.radians(30.0)


def seen(point: PathPoint) -> tuple[float, float]:
    """Return a point as an instrument sees it that stands elsewhere; the arm is 0.3 mm off."""
    x, y = point.x_mm + 0.3, point.y_mm - 0.1
    return (
        1000.0 + x * math.cos(TURN) - y * math.sin(TURN),
        -2000.0 + x * math.sin(TURN) + y * math.cos(TURN),
    )


def columns(rows: Sequence[Mapping[str, float]]) -> Columns:
    """Return rows as a file holds them below its header."""
    values = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return Columns(values, np.arange(2, len(rows) + 2))


def places(scale: float = 1.0) -> list[dict[str, float]]:
    return [
        {
            "x_mm": p.x_mm,
            "y_mm": p.y_mm,
            "x_meas_mm": scale * seen(p)[0],
            "y_meas_mm": scale * seen(p)[1],
            "u_mm": 0.01,
        }
        for p in POINTS
    ]


def joints() -> list[dict[str, float]]:
    return [
        {
            "theta1_deg": p.theta1_deg + 0.004,
            "theta2_deg": p.theta2_deg,
            "direction1": p.direction1,
            "direction2": p.direction2,
            "x_meas_mm": seen(p)[0],
            "y_meas_mm": seen(p)[1],
        }
        for p in POINTS
    ]


def refused(rows: Sequence[Mapping[str, float]], passes: int = 1) -> str:
    with pytest.raises(TableFileError) as caught:
        matched_positions("t.csv", POINTS, passes, columns(rows))
    return str(caught.value)


@pytest.mark.parametrize("form", [places, joints])
def test_rows_combine_path_commands_with_measured_positions(
    form: Callable[[], list[dict[str, float]]],
) -> None:
    rows = matched_positions("t.csv", POINTS, 1, columns(form()))
    assert len(rows) == 26
    for row, point in zip(rows, POINTS, strict=True):
        assert (row.x_mm, row.y_mm, row.theta1_deg) == (point.x_mm, point.y_mm, point.theta1_deg)
        assert (row.direction1, row.direction2) == (point.direction1, point.direction2)
        assert (row.x_meas_mm, row.y_meas_mm) == seen(point)
        assert row.u_mm == (0.01 if form is places else None)
    twice = matched_positions("t.csv", POINTS, 2, columns(form() + form()))
    assert [row.extra["pass_number"] for row in twice] == [0] * 26 + [1] * 26


def test_another_number_of_points_is_reported() -> None:
    assert "t.csv: holds 25 points and the path has 26 (1 pass(es) of 26" in refused(places()[1:])
    assert "the path has 52 (2 pass(es)" in refused(places(), passes=2)


def test_points_of_another_path_or_order_name_their_line() -> None:
    swapped = places()
    swapped[3], swapped[4] = swapped[4], swapped[3]
    assert "t.csv:5: the command is (200, -100) mm and point 4 of this path is (200, -150) mm" in refused(
        swapped
    )
    turned = joints()
    turned[7]["direction1"] *= -1
    assert "t.csv:9: the command is θ1" in refused(turned)
    assert "directions (" in refused(turned)


@pytest.mark.parametrize(
    ("scale", "unit"),
    [(1e3, "µm"), (1e-3, "in m:"), (1 / 25.4, "inches"), (25.4, "taken for inches"), (0.1, "cm")],
)
def test_another_unit_of_the_measured_positions_is_named(scale: float, unit: str) -> None:
    text = refused(places(scale))
    assert "t.csv: the measured positions are spread" in text
    assert unit in text


def test_another_unit_of_the_commands_is_named() -> None:
    metres = [{**row, "x_mm": row["x_mm"] / 1e3, "y_mm": row["y_mm"] / 1e3} for row in places()]
    assert "the commands in x_mm, y_mm seem to be in m" in refused(metres)
    radians = [
        {**row, **{name: math.radians(row[name]) for name in ("theta1_deg", "theta2_deg")}}
        for row in joints()
    ]
    assert "theta1_deg, theta2_deg seem to be in rad" in refused(radians)


def test_positions_that_are_not_those_of_the_path_are_reported() -> None:
    wide = refused(places(1.3))
    assert "spread 1.3 times as far" in wide
    assert "they are not those of this path" in wide
    shifted = places()
    rolled = [*shifted[1:], shifted[0]]
    shifted = [
        {**row, **{name: other[name] for name in ("x_meas_mm", "y_meas_mm")}}
        for row, other in zip(shifted, rolled, strict=True)
    ]
    # The way there is a step ahead and the way back a step behind: no shift makes up for that.
    assert re.search(r"t\.csv:\d+: the measured position lies \d\d\.\d mm from its command", refused(shifted))
