"""The measurement over an ideal arm: points, segments, lost beams, resumption."""

import math
from dataclasses import replace

import pytest

from catseye.procedures.kit.records import Row
from catseye.procedures.scara.open_loop.open_loop import OpenLoop, OpenLoopParams
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, plan_open_loop
from tests.unit.procedures.benches import PLACES, IdealContext, arm_xy, bench

NODES = (-40.0, -20.0), (20.0, 40.0, 60.0)
COUNT = 4 * 6


def small_plan(*reflectors: str) -> OpenLoopPlan:
    return plan_open_loop(bench(*NODES), reflectors=reflectors or ("P2",))


async def ran(plan: OpenLoopPlan, context: IdealContext) -> IdealContext:
    procedure = OpenLoop()
    await procedure.run(context, plan)
    await procedure.teardown(context)
    return context


def points(context: IdealContext) -> list[Row]:
    return [row for table, row in context.rows if table == "points"]


def number(value: object) -> float:
    assert isinstance(value, (int, float))
    return float(value)


def node(row: Row) -> tuple[float, float, float, float]:
    one, two, first, second = (
        number(row[key]) for key in ("theta1_deg", "theta2_deg", "direction1", "direction2")
    )
    return one, two, first, second


async def test_every_command_is_measured_once_in_one_segment() -> None:
    context = await ran(small_plan(), IdealContext())
    rows = points(context)
    assert len(rows) == COUNT
    assert {row["segment"] for row in rows} == {0}
    assert context.zeros == 1
    assert {kind for kind, _ in context.events} == {"entry", "map-known"}
    assert context.warnings == []
    assert len({node(row) for row in rows}) == COUNT


async def test_displacements_are_relative_to_the_first_point() -> None:
    context = await ran(small_plan(), IdealContext())
    rows = points(context)
    lengths = [math.dist(arm_xy(*node(row)[:2]), PLACES["P2"]) for row in rows]
    for row, length in zip(rows, lengths, strict=True):
        assert row["displacement_mm"] == pytest.approx(length - lengths[0], abs=1e-6)
    assert rows[0]["displacement_mm"] == pytest.approx(0.0, abs=1e-9)


async def test_a_point_keeps_everything_that_was_measured() -> None:
    context = await ran(small_plan(), IdealContext())
    row = points(context)[3]
    assert row["reflector"] == "P2"
    assert (row["j3_mm"], row["reported3_mm"]) == (12.5, 12.5)
    assert (row["reported1_deg"], row["reported2_deg"]) == (row["theta1_deg"], row["theta2_deg"])
    assert row["reported4_deg"] == row["j4_deg"]
    assert (row["spread_mm"], row["readings"], row["signal"]) == (0.0001, 4, 0.75)
    air = (row["temperature_c"], row["pressure_hpa"], row["humidity_percent"])
    assert air == (21.5, 1002.0, 44.0)
    assert (row["time_utc"], row["duration_s"]) == ("2026-01-02T03:04:05+00:00", 0.25)
    assert set(context.waits) == {(0.5, 0.25, 4)}


async def test_each_reflector_counts_its_own_segments() -> None:
    context = await ran(small_plan("P1", "P2"), IdealContext(breaks_at={3}))
    segments = {
        name: {row["segment"] for row in points(context) if row["reflector"] == name} for name in ("P1", "P2")
    }
    assert segments == {"P1": {0, 1}, "P2": {0}}


async def test_stored_steps_are_not_repeated_and_segments_continue() -> None:
    whole = await ran(small_plan(), IdealContext(breaks_at={6}))
    names = list(whole.stored)
    kept = {name: whole.stored[name] for name in names[:10]}
    again = await ran(small_plan(), IdealContext(stored=dict(kept)))
    assert again.ran == names[10:]
    rows = points(again)
    assert len(rows) == COUNT - 10
    # The count of the process that died is gone: what follows is a segment that was never used.
    assert {row["segment"] for row in rows} == {2}
    assert rows[0]["displacement_mm"] == pytest.approx(0.0, abs=1e-9)


async def test_a_complete_run_moves_nothing_when_it_is_repeated() -> None:
    whole = await ran(small_plan(), IdealContext())
    again = await ran(small_plan(), IdealContext(stored=dict(whole.stored)))
    assert again.moves == []
    assert again.rows == []


async def test_progress_ends_at_the_expected_time() -> None:
    plan = small_plan()
    context = await ran(plan, IdealContext())
    done, total = [entry[0] for entry in context.progressed], [entry[1] for entry in context.progressed]
    assert done == sorted(done)
    assert done[0] == 0.0
    assert total[0] == pytest.approx(plan.duration_s)
    # The way in from where the arm happened to stand comes on top of the plan.
    assert done[-1] == pytest.approx(total[-1])
    assert plan.duration_s < total[-1] < plan.duration_s + 3.0
    assert context.progressed[-1][2] == "P2 point 24/24"


async def test_the_operator_is_warned_of_blind_commands_first() -> None:
    base = replace(bench(*NODES), reflectors=bench().reflectors[1:2])
    plan = replace(plan_open_loop(base), warnings=("2 commands are blind",))
    context = await ran(plan, IdealContext())
    assert context.warnings == ["2 commands are blind"]


def test_a_choice_of_parameters_is_strict() -> None:
    with pytest.raises(ValueError, match="subdivide"):
        OpenLoopParams.model_validate({"subdivide": "no"})
    with pytest.raises(ValueError, match="extra_forbidden"):
        OpenLoopParams.model_validate({"takeup": True})
