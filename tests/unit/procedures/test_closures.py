"""Closure visits: planned trips that keep the beam, and the drift that they show."""

import math
from functools import cache
from itertools import pairwise
from typing import Any

import pytest

from catseye.calibration.scara.live_map import LiveMap
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.open_loop.open_loop import OpenLoop, OpenLoopParams
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, plan_open_loop
from tests.unit.procedures.benches import PLACES, arm_xy, bench, clearance_mm, miss_along
from tests.unit.procedures.troubles import TroubledContext

NODES = (-40.0, -20.0), (20.0, 40.0, 60.0)
COUNT = 24


@cache
def papers_plan() -> OpenLoopPlan:
    return plan_open_loop(bench(), closures=4)


def small_plan(closures: int = 2) -> OpenLoopPlan:
    return plan_open_loop(bench(*NODES), reflectors=("P2",), closures=closures)


async def ran(context: TroubledContext, plan: OpenLoopPlan | None = None) -> TroubledContext:
    await OpenLoop().run(context, plan or small_plan())
    return context


def rows(context: TroubledContext, table: str) -> list[Row]:
    return [row for name, row in context.rows if name == table]


def events(context: TroubledContext, kind: str) -> list[dict[str, Any]]:
    return [data for name, data in context.events if name == kind]


def test_the_points_are_those_of_a_plan_without_closures() -> None:
    with_trips, without = papers_plan(), plan_open_loop(bench())
    for a, b in zip(with_trips.reflectors, without.reflectors, strict=True):
        assert repr(a.visits) == repr(b.visits)
        assert len(a.closures) == 4
        assert b.closures == ()


def test_closures_are_spread_over_points_and_included_in_time() -> None:
    plan, without = papers_plan(), plan_open_loop(bench())
    for part in plan.reflectors:
        after = [closure.after for closure in part.closures]
        assert after == sorted(after)
        assert len(set(after)) == 4
        assert all(closure.reference < closure.after for closure in part.closures)
        assert [closure.number for closure in part.closures] == [1, 2, 3, 4]
    trips = sum(closure.duration_s for part in plan.reflectors for closure in part.closures)
    assert plan.duration_s == pytest.approx(without.duration_s + trips)
    assert trips > 4 * 3 * 0.75


def test_the_beam_is_kept_on_every_trip() -> None:
    for part in papers_plan().reflectors:
        place = PLACES[part.reflector.name]
        for closure in part.closures:
            start = part.visits[closure.after].node
            way = [start, *(target for leg in (*closure.out, *closure.back) for target in leg)]
            worst = max(float(miss_along(a, b, place).max()) for a, b in pairwise(way))
            assert worst <= 0.2005
            assert closure.miss_mm == pytest.approx(worst, rel=0.03, abs=1e-6)
            assert all(-360.0 <= target[3] <= 360.0 for target in way)
            for a, b in pairwise(way):
                for share in (0.0, 0.25, 0.5, 0.75, 1.0):
                    here = arm_xy(a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]))
                    assert clearance_mm(here, place) > 114.0


def test_a_trip_approaches_both_ends_from_their_own_sides() -> None:
    for part in papers_plan().reflectors:
        for closure in part.closures:
            here, there = part.visits[closure.after], part.visits[closure.reference]
            for legs, visit, before in ((closure.out, there, here), (closure.back, here, there)):
                if not legs:
                    continue
                way = [before.node, *(target for leg in legs for target in leg)]
                assert way[-1] == pytest.approx(visit.node)
                for joint, direction in ((0, visit.command.direction1), (1, visit.command.direction2)):
                    changes = [
                        b[joint] - a[joint] for a, b in pairwise(way) if abs(b[joint] - a[joint]) > 1e-9
                    ]
                    # A joint that does not move keeps the side that both ends share.
                    side = before.command.direction1 if joint == 0 else before.command.direction2
                    assert (math.copysign(1.0, changes[-1]) if changes else side) == direction


def test_closures_that_cannot_be_driven_are_omitted_with_warning() -> None:
    plan = plan_open_loop(bench(*NODES), reflectors=("P2",), closures=2)
    assert len(plan.reflectors[0].closures) == 2
    # Every way through the first row leads J4 beyond these limits, so there each point begins a segment.
    few = plan_open_loop(bench((-40.0,), (20.0,)), reflectors=("P2",), closures=20)
    part = few.reflectors[0]
    assert len(part.closures) < 20
    assert any(
        f"{20 - len(part.closures)} of 20 closure visits are left out" in text for text in few.warnings
    )


def test_no_closures_without_subdivision_or_take_up() -> None:
    for given in ({"subdivide": False}, {"take_up": False}):
        params = OpenLoopParams(reflectors=["P2"], **given)
        plan = OpenLoop().plan(bench(*NODES), params)
        assert plan.reflectors[0].closures == ()


async def test_closures_are_measured_without_breaking_the_count() -> None:
    context = await ran(TroubledContext())
    assert context.zeros == 1
    assert len(rows(context, "points")) == COUNT
    closures = rows(context, "records")
    assert [row["kind"] for row in closures] == ["closure", "closure"]
    for number, row in enumerate(closures, 1):
        assert (row["reflector"], row["segment"], row["number"], row["overlaps"]) == ("P2", 0, number, 0)
        assert row["drift_um"] == pytest.approx(0.0, abs=1e-6)
        reference = next(
            point
            for point in rows(context, "points")
            if all(point[k] == row[k] for k in ("theta1_deg", "theta2_deg", "direction1", "direction2"))
        )
        assert row["reference_displacement_mm"] == reference["displacement_mm"]
        assert row["time_utc"]
    assert [name for name in context.ran if "closure" in name] == ["P2/closure/01", "P2/closure/02"]
    assert context.warnings == []


async def test_a_drift_beyond_the_limit_is_warned_of() -> None:
    context = TroubledContext()

    def warms_up(number: int) -> None:
        context.grown_mm = 0.0024 * number

    context.before_measuring = warms_up
    await ran(context)
    first, last = (float(str(row["drift_um"])) for row in rows(context, "records"))
    assert 20.0 < first < 30.0
    assert last > 50.0
    (text,) = context.warnings
    assert f"has drifted by {last:+.0f} µm, the limit is 30 µm" in text
    assert "warm the arm up (warmup)" in text
    assert [live.accepted for live in context.shown if live.name.startswith("drift")] == [True, False]


async def test_an_overlap_carries_the_reference_over_a_loss() -> None:
    context = await ran(TroubledContext(breaks_at={6}))
    first = next(row for row in rows(context, "records") if row["kind"] == "closure")
    assert (first["segment"], first["overlaps"]) == (1, 1)
    assert first["drift_um"] == pytest.approx(0.0, abs=1e-6)


def require_first_of_the_count(context: TroubledContext) -> None:
    """Each closure leads to the first point of its segment, from that point's sides, and shows no drift."""
    measured = [row for row in rows(context, "records") if row["kind"] == "closure"]
    assert [row["number"] for row in measured] == [1, 2]
    for row in measured:
        first = next(point for point in rows(context, "points") if point["segment"] == row["segment"])
        keys = ("theta1_deg", "theta2_deg", "direction1", "direction2")
        assert [row[key] for key in keys] == [first[key] for key in keys]
        assert row["reference_displacement_mm"] == first["displacement_mm"]
        assert row["drift_um"] == pytest.approx(0.0, abs=1e-6)


async def test_closures_after_a_gap_return_to_the_present_count() -> None:
    # The overlap itself is broken, so the segment begins at the point.
    context = await ran(TroubledContext(breaks_at={6, 7}))
    require_first_of_the_count(context)
    assert {row["segment"] for row in rows(context, "records")} == {2}
    assert len(rows(context, "points")) == COUNT


async def test_a_resumed_run_goes_on_with_closures() -> None:
    whole = await ran(TroubledContext())
    done = {name: result for name, result in whole.stored.items() if name <= "P2/0004"}
    assert len(done) == 5
    again = await ran(TroubledContext(stored=done))
    require_first_of_the_count(again)
    assert [row["point"] for row in rows(again, "records")] == [5, 5]


async def test_a_closure_right_after_a_gap_is_left_out() -> None:
    after = small_plan().reflectors[0].closures[0].after
    context = await ran(TroubledContext(breaks_at={after + 1, after + 2}))
    (left_out,) = events(context, "closure-left-out")
    assert "goes back to no pose" in left_out["reason"]
    assert context.stored["P2/closure/01"]["measured"] is False
    assert len(rows(context, "points")) == COUNT


async def test_a_beam_lost_on_a_trip_spoils_no_point() -> None:
    plan = small_plan()
    closure = plan.reflectors[0].closures[0]
    before = sum(len(visit.moves) for visit in plan.reflectors[0].visits[: closure.after + 1])
    out = sum(len(leg) for leg in closure.out)
    for move in (before + len(closure.out[0]), before + out, before + out + 1):
        context = await ran(TroubledContext(breaks_on_move={move}), plan)
        assert len(rows(context, "points")) == COUNT
        points = rows(context, "points")
        for a, b in pairwise(points):
            if a["segment"] == b["segment"]:
                change = float(str(b["displacement_mm"])) - float(str(a["displacement_mm"]))
                lengths = [
                    math.dist(arm_xy(float(str(r["theta1_deg"])), float(str(r["theta2_deg"]))), PLACES["P2"])
                    for r in (a, b)
                ]
                assert change == pytest.approx(lengths[1] - lengths[0], abs=1e-6)
        assert len(events(context, "beam-lost")) == 1
        # The overlap at the point before ties what follows to what was before.
        assert [row["kind"] for row in rows(context, "records")].count("overlap") == 1


@pytest.fixture
def taken(monkeypatch: pytest.MonkeyPatch) -> list[tuple[object, ...]]:
    """Return what the live map takes in: angles, directions, reflector, segment, displacement, mounting, number."""
    found: list[tuple[object, ...]] = []
    add = LiveMap.add

    def noted(live_map: LiveMap, *values: Any) -> Any:
        found.append(values)
        return add(live_map, *values)

    monkeypatch.setattr(LiveMap, "add", noted)
    return found


async def test_returns_enter_the_live_map(taken: list[tuple[object, ...]]) -> None:
    context = await ran(TroubledContext())
    assert [values[8] for values in taken] == list(range(COUNT + 2))
    assert small_plan().n_distances == COUNT + 2
    measured = [row["displacement_mm"] for row in (*rows(context, "points"), *rows(context, "records"))]
    assert sorted(str(values[6]) for values in taken) == sorted(map(str, measured))


async def test_a_resumed_live_map_takes_the_stored_returns(taken: list[tuple[object, ...]]) -> None:
    whole = await ran(TroubledContext())
    first = taken[:]
    taken.clear()
    await ran(TroubledContext(stored=dict(whole.stored)))
    assert taken == first


async def test_stored_returns_of_early_versions_are_passed_over() -> None:
    whole = await ran(TroubledContext())
    early: dict[str, Row] = {
        name: {key: value for key, value in result.items() if "closure" not in name or key == "segment"}
        for name, result in whole.stored.items()
    }
    again = await ran(TroubledContext(stored=early))
    assert rows(again, "records") == []


async def test_stored_closures_are_not_repeated() -> None:
    whole = await ran(TroubledContext())
    again = await ran(TroubledContext(stored=dict(whole.stored)))
    assert again.moves == []
    assert again.rows == []


async def test_the_limit_is_a_parameter() -> None:
    params = OpenLoopParams(reflectors=["P2"], drift_limit_um=5.0, recovery_attempts=7)
    plan = OpenLoop().plan(bench(*NODES), params)
    assert plan.rules.drift_limit_mm == pytest.approx(0.005)
    assert plan.rules.recovery_attempts == 7
    assert len(plan.reflectors[0].closures) == 2
