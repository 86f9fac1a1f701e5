"""Shown while measuring: innovations, how well the maps are known, when that is enough, how far the run is."""

import math
from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from catseye.calibration.scara.live_map import MapKnowledge
from catseye.procedures.kit.errors import BeamLostError
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.tasks import PlaceReflector
from catseye.procedures.scara.open_loop.open_loop import OpenLoop
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, plan_open_loop
from tests.unit.procedures.benches import bench, with_optics
from tests.unit.procedures.troubles import TroubledContext

NODES = (-80.0, -40.0, 0.0), (20.0, 60.0, 100.0)
COUNT = 6 * 6


@cache
def plan_of(*reflectors: str) -> OpenLoopPlan:
    return plan_open_loop(bench(*NODES), reflectors=reflectors, closures=2)


async def ran(plan: OpenLoopPlan, context: TroubledContext | None = None) -> TroubledContext:
    context = context or TroubledContext()
    await OpenLoop().run(context, plan)
    return context


def known(context: TroubledContext) -> list[dict[str, Any]]:
    return [data for kind, data in context.events if kind == "map-known"]


def stopping_at(plan: OpenLoopPlan, limit_mdeg: float) -> OpenLoopPlan:
    return replace(plan, rules=replace(plan.rules, stop_at_mdeg=limit_mdeg))


def points(context: TroubledContext) -> list[Row]:
    return [row for table, row in context.rows if table == "points"]


async def test_nothing_is_known_of_the_map_before_it_is_determined() -> None:
    published = known(await ran(plan_of("P1", "P2")))
    assert len(published) == 2 * 6
    assert published[0]["u_theta1_mdeg"] is None
    assert published[0]["text"].startswith("the map is not determined yet: ")
    last = published[-1]
    assert last["text"] == (
        f"Δθ1 known to ±{2.0 * last['u_theta1_mdeg']:.1f} mdeg, "
        f"Δθ2 ±{2.0 * last['u_theta2_mdeg']:.1f} mdeg (k = 2)"
    )
    numbers = [data["u_theta2_mdeg"] for data in published if data["u_theta2_mdeg"] is not None]
    assert all(math.isfinite(number) for number in numbers)
    assert numbers[-1] < 0.95 * numbers[0]


async def test_a_map_that_is_only_formally_determined_has_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    # Rounding of real distances may separate on paper what the points leave free by tens of degrees.
    on_paper = MapKnowledge(math.radians(24.8), math.radians(0.9), "")
    monkeypatch.setattr(
        "catseye.procedures.scara.open_loop.live_knowledge.LiveMap.known", lambda _self: on_paper
    )
    context = await ran(stopping_at(plan_of("P1"), 100.0))
    assert {data["u_theta1_mdeg"] for data in known(context)} == {None}
    assert {data["text"] for data in known(context)} == {
        "the map is not determined yet: the points so far leave it uncertain by whole degrees"
    }
    assert not [live for live in context.shown if live.name == "largest U(Δθ1)"]
    assert len(points(context)) == COUNT


async def test_innovations_of_an_ideal_arm_vanish() -> None:
    context = await ran(plan_of("P1", "P2"))
    shown = [live for live in context.shown if live.name == "innovation"]
    assert 10 < len(shown) < 2 * COUNT
    assert all(live.unit == "µm" and live.accepted for live in shown)
    assert max(abs(live.value) for live in shown) < 1.0


async def test_a_reflector_moved_along_the_beam_shows_as_innovation() -> None:
    context = TroubledContext()

    def grows(number: int) -> None:
        context.grown_mm = 0.3 if number > 60 else 0.0

    context.before_measuring = grows
    await ran(plan_of("P1", "P2"), context)
    worst = max(
        (live for live in context.shown if live.name == "innovation"), key=lambda live: abs(live.value)
    )
    assert not worst.accepted
    assert worst.value == pytest.approx(300.0, rel=0.3)


async def test_a_run_stops_when_both_maps_are_known_well_enough() -> None:
    plan = plan_of("P1", "P2", "P3")
    whole = known(await ran(plan))
    determined = [
        max(d["u_theta1_mdeg"], d["u_theta2_mdeg"]) for d in whole if d["u_theta1_mdeg"] is not None
    ]
    limit = 0.5 * (determined[0] + determined[-1])
    context = await ran(stopping_at(plan, limit))
    assert 0 < len(points(context)) < 3 * COUNT
    (stop,) = (data for kind, data in context.events if kind == "early-stop")
    assert f"known to u {limit:g} mdeg (stop_at_mdeg) = U {2 * limit:g} mdeg" in str(stop["text"])
    last = known(context)[-1]
    assert max(last["u_theta1_mdeg"], last["u_theta2_mdeg"]) <= limit
    done, total, text = context.progressed[-1]
    assert done == total
    assert text == stop["text"]


async def test_a_stopped_run_that_is_resumed_stops_where_it_did() -> None:
    plan = stopping_at(plan_of("P1", "P2"), 90.0)
    whole = await ran(plan)
    assert len(points(whole)) < 2 * COUNT
    again = await ran(plan, TroubledContext(stored=dict(whole.stored), resumed=True))
    assert again.moves == []
    assert again.ran == []


async def test_stored_points_feed_the_map_without_being_republished() -> None:
    plan = plan_of("P1", "P2")
    whole = await ran(plan)
    kept = dict(list(whole.stored.items())[:-6])
    later = await ran(plan, TroubledContext(stored=dict(kept), resumed=True))
    assert 1 <= len(known(later)) <= 2
    before, now = known(whole)[-1], known(later)[-1]
    # A further segment costs a little of what is known.
    assert now["u_theta2_mdeg"] == pytest.approx(before["u_theta2_mdeg"], rel=0.2)


async def test_the_pace_counts_from_the_first_step_that_runs_now() -> None:
    plan = plan_of("P1", "P2")
    whole = await ran(plan)
    kept = dict(list(whole.stored.items())[:20])
    later = await ran(plan, TroubledContext(stored=dict(kept), resumed=True))
    done, total, _ = later.progressed[0]
    part = plan.reflectors[0]
    expected = {f"P1/{visit.command.index:04d}": visit.duration_s for visit in part.visits}
    expected |= {f"P1/closure/{closure.number:02d}": closure.duration_s for closure in part.closures}
    assert done == pytest.approx(sum(expected[name] for name in kept))
    assert total == pytest.approx(plan.duration_s)
    assert later.progressed[-1][0] == pytest.approx(later.progressed[-1][1])


async def test_a_recovery_moves_the_end_by_what_it_takes() -> None:
    plan = plan_of("P2")
    calm, troubled = await ran(plan), await ran(plan, TroubledContext(breaks_at={6}))
    late = troubled.progressed[-1][1] - calm.progressed[-1][1]
    # Once more to the last good pose, settling and dwell there, and the way on again.
    assert 0.75 < late < 3.0
    assert troubled.progressed[-1][0] == pytest.approx(troubled.progressed[-1][1])


def carried() -> OpenLoopPlan:
    return plan_open_loop(with_optics(bench(*NODES), one_reflector=True), reflectors=("P1", "P2"))


async def test_a_single_reflector_is_asked_for_before_it_is_needed() -> None:
    context = TroubledContext(answers={"place/P1": "yes", "place/P2": "yes"})
    await ran(carried(), context)
    assert [prompt.id for prompt in context.prompts] == ["place/P1", "place/P2"]
    for prompt, name in zip(context.prompts, ("P1", "P2"), strict=True):
        # Hands are at the nest, and the arm goes there next.
        assert prompt.motion
        assert prompt.kind == "confirm"
        assert prompt.text.startswith(f"Put the reflector into nest {name} at x ")
        assert prompt.task == PlaceReflector(reflector=name)
    assert len(points(context)) == 2 * COUNT


async def test_a_resumed_run_asks_only_for_reflectors_with_points_left() -> None:
    whole = await ran(carried(), TroubledContext(answers={"place/P1": "yes", "place/P2": "yes"}))
    kept = dict(list(whole.stored.items())[: COUNT + 3])
    later = TroubledContext(stored=dict(kept), answers={"place/P2": "yes"}, resumed=True)
    await ran(carried(), later)
    assert [prompt.id for prompt in later.prompts] == ["place/P2"]


async def test_an_unplaced_reflector_ends_the_run_before_motion() -> None:
    context = TroubledContext(answers={"place/P1": "no"})
    with pytest.raises(BeamLostError, match="put it there and continue with catseye resume"):
        await ran(carried(), context)
    assert context.moves == []
