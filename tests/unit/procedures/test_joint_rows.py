"""A path of given joint commands: driven as they stand, each from its side."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.scara.path.validation_path import PathParams, ValidationPath
from tests.unit.procedures.benches import IdealContext, bench, with_axes

ROWS = [
    # x, y, J1, J2 and where they come from; J1 reverses by little, then goes on, J2 stands still.
    [300.0, 100.0, -20.0, 60.0, 1.0, -1.0],
    [301.0, 101.0, -15.0, 50.0, 1.0, -1.0],
    [302.0, 102.0, -15.3, 50.0, -1.0, -1.0],
    [303.0, 103.0, -18.0, 50.0, -1.0, -1.0],
    [304.0, 104.0, -12.0, 50.0, 1.0, -1.0],
]


def params(**further: object) -> PathParams:
    return PathParams.model_validate({"joints": ROWS, **further})


async def test_each_row_is_driven_to_from_its_side() -> None:
    context, plan = IdealContext(), ValidationPath().plan(bench(), params())
    await ValidationPath().run(context, plan)
    assert np.array([move[:2] for move in context.moves]) == pytest.approx(
        np.array(
            [
                (-21.0, 61.0),
                (-20.0, 60.0),
                (-15.0, 50.0),
                # Less than the take-up of 1° back: J1 overshoots and comes from above.
                (-14.3, 50.0),
                (-15.3, 50.0),
                (-18.0, 50.0),
                # Far enough: the way itself takes the play up.
                (-12.0, 50.0),
            ]
        )
    )
    assert {move[2:] for move in context.moves} == {(12.5, 0.0)}
    rows = [row for table, row in context.rows if table == "path"]
    named = ("x_mm", "y_mm", "theta1_deg", "theta2_deg", "direction1", "direction2")
    assert [[row[name] for name in named] for row in rows] == ROWS


async def test_every_pass_begins_with_a_take_up() -> None:
    context, plan = IdealContext(), ValidationPath().plan(bench(), params(passes=2))
    await ValidationPath().run(context, plan)
    assert [move[:2] for move in context.moves].count((-21.0, 61.0)) == 2
    assert [row["pass_number"] for table, row in context.rows if table == "path"] == [0] * 5 + [1] * 5


def test_the_beam_cannot_follow_it() -> None:
    with pytest.raises(PlanError, match="instrument=file"):
        ValidationPath().plan(bench(), params(instrument="interferometer"))
    with pytest.raises(PlanError, match="instrument=file"):
        ValidationPath().plan(replace(bench(), tracker=False), params())


def test_the_limits_hold_for_take_ups_too() -> None:
    tight = with_axes(bench(), j1_deg=(-170.0, -14.5))
    with pytest.raises(PlanLimitError, match=r"the path needs J1 = -14\.30°, outside its limits"):
        ValidationPath().plan(tight, PathParams.model_validate({"joints": ROWS[:4]}))


def test_a_row_of_another_length_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 6 items"):
        PathParams.model_validate({"joints": [[1.0, 2.0, 3.0]]})
