"""The warm-up: its exercise, its end, and what breaks it, on an ideal arm whose distance drifts."""

import asyncio
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import pytest

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Measurement
from catseye.procedures.kit.errors import BeamLostError, NotWarmError, PlanError
from catseye.procedures.kit.tasks import PlaceReflector
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.warming.warmup import Warmup, WarmupParams
from catseye.procedures.scara.warming.warmup_plan import WarmupPlan
from tests.unit.procedures.benches import PLACES, IdealContext, bench, miss_along, with_optics

TAU_S = 1500.0


@dataclass
class WarmingContext(IdealContext):
    """An arm that grows while time passes from measurement to measurement."""

    step_s: float = 60.0
    now_s: float = 1000.0
    grown_mm: Callable[[float], float] = lambda _now_s: 0.0
    ends_after: int = 10**6

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the distance with the growth."""
        self.now_s += self.step_s
        if self.measurements >= self.ends_after:
            raise KeyboardInterrupt
        ideal = await super().measure(settle_time_s, dwell_time_s, readings)
        grown = ideal.displacement_mm + self.grown_mm(self.now_s)
        return replace(ideal, displacement_mm=grown, clock_s=self.now_s)


@dataclass
class FaultyContext(WarmingContext):
    """The second measurement has a fault."""

    fault: dict[str, Any] = field(default_factory=dict)

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the distance, once with a fault."""
        measured = await super().measure(settle_time_s, dwell_time_s, readings)
        return (
            replace(measured, beam=replace(measured.beam, **self.fault))
            if self.measurements == 2
            else measured
        )


def growth(now_s: float) -> float:
    """Return 60 µm of growth with a time constant of 25 min."""
    return -0.060 * math.exp(-(now_s - 1000.0) / TAU_S)


def planned(base: ScaraBench | None = None, **params: object) -> WarmupPlan:
    return Warmup().plan(base or bench(), WarmupParams.model_validate({"amplitude_share": 0.3, **params}))


def run(plan: WarmupPlan, ctx: WarmingContext) -> WarmingContext:
    asyncio.run(Warmup().run(ctx, plan))
    return ctx


def verdict(ctx: IdealContext) -> dict[str, object]:
    return dict(ctx.stored["analyse"])


def moves(plan: WarmupPlan) -> list[Pose]:
    return [plan.trip.start, *(target for leg in plan.trip.legs for target in leg)]


@pytest.mark.parametrize("share", [0.2, 0.6])
def test_the_beam_lasts_over_the_whole_exercise(share: float) -> None:
    plan = planned(amplitude_share=share)
    way, place = moves(plan), PLACES[plan.trip.reflector.name]
    worst = max(miss_along(a, b, place).max() for a, b in pairwise(way))
    assert worst <= 0.2 + 1e-6
    assert way[-1] == way[0]
    assert not plan.warnings
    # Nodes span ±100° and ±70°.
    assert max(m[0] for m in way) - min(m[0] for m in way) == pytest.approx(2 * share * 100.0)
    assert max(m[1] for m in way) - min(m[1] for m in way) == pytest.approx(2 * share * 70.0)
    assert all(-170 <= m[0] <= 170 and -145 <= m[1] <= 145 and -360 <= m[3] <= 360 for m in way)


def test_the_reference_pose_is_always_approached_upwards() -> None:
    way = moves(planned())
    before, reference = [m for m in way if m[:2] != way[-1][:2]][-1], way[-1]
    assert 0.0 < reference[0] - before[0] <= 1.0
    assert 0.0 < reference[1] - before[1] <= 1.0
    run_in = (reference[0] - 1.0, reference[1] - 1.0)
    assert any(m[:2] == pytest.approx(run_in) for m in way)


def test_an_exercise_too_large_for_the_beam_is_reduced() -> None:
    plan = planned(amplitude_share=1.0, reference_deg=[60.0, 60.0])
    assert "of the amplitude asked for" in plan.warnings[0]
    assert "J1 goes" in plan.warnings[0]
    assert plan.trip.stops[0] == (60.0, 60.0)


def test_what_cannot_be_planned_is_refused_with_the_remedy() -> None:
    with pytest.raises(PlanError, match="P9 is not in the cell file; known: P1, P2, P3"):
        planned(reflector="P9")
    with pytest.raises(PlanError, match="raise duration_limit_min or lower window_min"):
        planned(duration_limit_min=31.0)
    with pytest.raises(PlanError, match="holds fewer than 6 visits"):
        planned(window_min=3.0)
    with pytest.raises(PlanError, match="not even a small one: choose another reference pose"):
        planned(reference_deg=[169.5, 60.0])
    with pytest.raises(PlanError, match="cannot be kept"):
        planned(with_optics(bench(), beam_max_mm=60.0))


def test_the_time_between_visits_is_what_was_asked_for() -> None:
    plan = planned(cycle_min=2.0)
    assert plan.visit_s == pytest.approx(120.0, abs=0.5 * plan.trip.driving_s + 0.01)
    assert plan.rounds > 1


@dataclass
class SlowContext(WarmingContext):
    """A bench on which a leg takes its time, as on an emulator that runs fast."""

    leg_s: float = 0.0
    driven_s: float = 0.0
    visits_s: list[float] = field(default_factory=list)

    @property
    def clock_s(self) -> float:
        """Time goes on as legs are driven."""
        return self.driven_s

    async def follow(self, way: Sequence[Pose]) -> None:
        """Take the time of a leg."""
        await super().follow(way)
        self.driven_s += self.leg_s

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Keep when it was measured."""
        self.visits_s.append(self.driven_s)
        return await super().measure(settle_time_s, dwell_time_s, readings)


@pytest.mark.parametrize("times_slower", [1.0, 2.0, 5.0, 13.0])
def test_the_cycle_is_kept_however_slow_the_bench(times_slower: float) -> None:
    plan = planned(cycle_min=4.0)
    round_s = times_slower * plan.trip.driving_s
    ctx = SlowContext(grown_mm=growth, leg_s=round_s / len(plan.trip.legs))
    run(plan, ctx)
    exercises = [after - before for before, after in pairwise(ctx.visits_s)]
    planned_s = plan.rounds * plan.trip.driving_s
    assert len(exercises) > 5
    # A round is not broken off: what can be kept is half of one.
    assert exercises == pytest.approx([planned_s] * len(exercises), abs=0.5 * round_s + 0.01)


def test_warmup_ends_once_drift_is_below_the_limit() -> None:
    plan = planned()
    ctx = run(plan, WarmingContext(grown_mm=growth))
    end_s = ctx.now_s - 1000.0
    # 60 µm / 1500 s exp(−t / 1500 s) are 5 µm / 600 s at t = 2352 s; a window of 30 min sees its middle, or a little
    # more where the curve is bent.
    below_s = TAU_S * math.log(60.0 / TAU_S * 600.0 / 5.0)
    assert below_s + 900.0 <= end_s <= below_s + 900.0 + 500.0
    found = verdict(ctx)
    assert found["warm"] is True
    assert isinstance(found["drift_um_per_10min"], float)
    assert 0.0 < found["drift_um_per_10min"] <= 5.0
    assert found["elapsed_min"] == pytest.approx((end_s - 60.0 + plan.visit_s) / 60.0)


def test_the_drift_is_shown_with_its_limit_and_kept() -> None:
    ctx = run(planned(checks=2), WarmingContext(grown_mm=growth))
    drifts = [live for live in ctx.shown if live.name == "drift"]
    assert {(live.unit, live.low, live.high) for live in drifts} == {("µm/10 min", None, 5.0)}
    assert [live.accepted for live in drifts][-2:] == [True, True]
    assert not any(live.accepted for live in drifts[:-2])
    rows = [row for table, row in ctx.rows if table == "records"]
    assert {row["kind"] for row in rows} == {"drift"}
    assert [row["visit"] for row in rows] == list(range(1, len(rows) + 1))
    assert ctx.zeros == 1


def test_the_time_left_is_honest() -> None:
    ctx = run(planned(), WarmingContext(grown_mm=growth))
    end_s = ctx.now_s - 1000.0
    # While nothing is known it is the longest time; then an exponential approach is seen.
    assert ctx.progressed[0][1] == pytest.approx(7200.0, abs=1.0)
    assert ctx.progressed[30][1] == pytest.approx(end_s, rel=0.25)
    assert ctx.progressed[-1][0] == ctx.progressed[-1][1]
    assert "drift not known yet" in ctx.progressed[3][2]


def test_an_arm_not_settling_is_rejected_with_the_remedy() -> None:
    ctx = WarmingContext(grown_mm=lambda now_s: 2e-5 * now_s)
    message = (
        r"not warm after 61 min: the drift is \+12\.0 ± 0\.0 µm in 10 min \(k = 2\).*raise duration_limit_min"
    )
    with pytest.raises(NotWarmError, match=message):
        run(planned(duration_limit_min=60.0), ctx)
    assert verdict(ctx)["warm"] is False


def test_checks_that_are_missing_are_counted() -> None:
    # It settles so late that the last two windows alone are below the limit.
    ctx = WarmingContext(grown_mm=lambda now_s: 2e-5 * min(now_s, 3500.0))
    with pytest.raises(NotWarmError, match="below the limit in 2 of 3 checks in a row: run it again"):
        run(planned(duration_limit_min=60.0, checks=3), ctx)


def test_scatter_that_hides_the_drift_is_named_as_such() -> None:
    ctx = WarmingContext(grown_mm=lambda now_s: 0.1 * math.sin(40.0 * now_s))
    with pytest.raises(NotWarmError, match="not known well enough: take a longer window_min"):
        run(planned(duration_limit_min=50.0), ctx)


def test_a_lost_beam_begins_the_watch_anew_and_says_so() -> None:
    ctx = run(planned(checks=1), WarmingContext(breaks_at={20}))
    lost = [data for kind, data in ctx.events if kind == "beam-lost"]
    assert [(data["reflector"], data["segment"]) for data in lost] == [(planned().trip.reflector.name, 0)]
    assert lost[0]["cause"] == "interrupted"
    assert [text for text in ctx.warnings if "watched again" in text]
    rows = [row for _, row in ctx.rows]
    assert [row["segment"] for row in rows[:19]] == [0] * 19
    assert {row["segment"] for row in rows[19:]} == {1}
    # A full window has to pass again after the loss.
    assert len(rows) >= 19 + 30
    assert ctx.zeros == 2


def test_a_beam_that_breaks_all_the_time_is_a_question() -> None:
    plan = planned()
    ctx = WarmingContext(breaks_at=set(range(1, 100)), answers={f"beam/{plan.trip.reflector.name}/1": "stop"})
    with pytest.raises(BeamLostError, match="lost 3 times in a row: check that nothing is in it"):
        run(plan, ctx)
    assert ctx.measurements == 3
    assert ctx.prompts[0].safe_answer == "stop"
    assert ctx.prompts[0].motion


def test_a_missing_beam_is_a_question_and_retry_continues() -> None:
    plan, dark = planned(checks=1), [True]
    ctx = WarmingContext(blocked=lambda _pose: dark[0])

    def cleared(_prompt: object) -> str:
        dark[0] = False
        return "retry"

    ctx.answers[f"beam/{plan.trip.reflector.name}/1"] = cleared
    run(plan, ctx)
    assert len(ctx.prompts) == 1
    assert verdict(ctx)["warm"] is True
    assert sum("see what is in the beam" in text for text in ctx.warnings) == 3
    # Between two looks there is time to walk out of the beam; before a question there is no need to wait.
    assert [seconds for _, seconds in ctx.pauses] == [15.0, 15.0]


def test_a_wrong_zero_direction_is_found_and_kept() -> None:
    plan = planned(checks=1)
    ctx = run(plan, WarmingContext(theta40_deg=0.3))
    assert ctx.zeros == 1
    assert not ctx.warnings
    # Thirty visits, one a minute, fill the window.
    assert len(ctx.stored) == 30 + 1
    assert ctx.moves[-1][3] == pytest.approx(plan.trip.start[3] - 0.3, abs=0.01)


def test_an_offset_that_a_limit_forbids_is_not_kept() -> None:
    wide = planned(checks=1)
    low, high = wide.trip.j4_range_deg
    plan = planned(
        bench(j4_limits_deg=(low - 0.4, high + 0.1)), checks=1, reference_deg=list(wide.trip.stops[0])
    )
    name = plan.trip.reflector.name
    ctx = WarmingContext(
        theta40_deg=-0.15, j4_limits_deg=(low - 0.4, high + 0.1), answers={f"beam/{name}/1": "stop"}
    )
    # The beam is found at the reference pose, but the whole way cannot be driven so.
    with pytest.raises(BeamLostError):
        run(plan, ctx)


@dataclass
class HeldContext(WarmingContext):
    """A hold of an hour before one of the visits; the arm has shrunk by 20 µm meanwhile."""

    held_before: int = 32

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the distance, shorter after the hold."""
        if self.measurements + 1 == self.held_before:
            self.now_s += 3600.0
            self.waited_s += 3600.0
        measured = await super().measure(settle_time_s, dwell_time_s, readings)
        cooled_mm = 0.020 if self.measurements >= self.held_before else 0.0
        return replace(measured, displacement_mm=measured.displacement_mm - cooled_mm)


def test_cooling_during_a_hold_restarts_the_watch() -> None:
    # Two of three checks have passed; 20 µm over an hour would be no drift to speak of.
    ctx = run(planned(checks=3), HeldContext())
    assert ctx.zeros == 1
    assert [text for text in ctx.warnings if "watched again" in text]
    # A full window has to pass after the hold, and three visits below the limit.
    assert ctx.measurements >= 31 + 30
    # The hold is no exercise: one visit a minute.
    assert verdict(ctx)["elapsed_min"] == pytest.approx(ctx.measurements, abs=1.0)


def test_slow_visits_are_no_hold() -> None:
    # A controller at a tenth of its speed: each visit takes ten times as long as planned.
    ctx = run(planned(checks=1, duration_limit_min=240.0), WarmingContext(step_s=600.0))
    assert not ctx.warnings
    assert verdict(ctx)["warm"] is True


@dataclass
class StalledContext(WarmingContext):
    """An emulator at 400 times real speed on a busy computer: one visit comes an hour of its time late."""

    late: int = 5

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the distance, once much later."""
        if self.measurements + 1 == self.late:
            self.now_s += 3600.0
        return await super().measure(settle_time_s, dwell_time_s, readings)


def test_a_visit_that_comes_late_is_no_hold() -> None:
    ctx = run(planned(), StalledContext(step_s=300.0))
    assert not ctx.warnings
    assert verdict(ctx)["warm"] is True


def test_visits_that_take_too_long_are_still_enough() -> None:
    # Four visits fill the longest time of two hours; six and two more below the limit are a verdict.
    ctx = run(planned(checks=3), WarmingContext(step_s=1800.0))
    assert verdict(ctx)["warm"] is True
    assert ctx.measurements == 8
    (warning,) = ctx.warnings
    assert "beyond duration_limit_min = 120 until there are 8 of them" in warning


def test_no_warm_up_takes_more_than_twice_its_time() -> None:
    ctx = WarmingContext(step_s=5400.0)
    with pytest.raises(NotWarmError, match="the drift is not known"):
        run(planned(checks=3), ctx)
    # Four visits of 90 min end beyond twice the two hours.
    assert ctx.measurements == 4


def test_the_time_left_knows_of_visits_that_take_longer() -> None:
    ctx = run(planned(checks=3), WarmingContext(step_s=1800.0))
    left_s = [total - done for done, total, _ in ctx.progressed]
    # While a verdict needs more visits it takes as long as they do.
    assert left_s[4] >= 3 * 1400.0
    assert left_s[-1] == 0.0


def test_an_interrupted_run_continues_with_its_own_series() -> None:
    plan = planned(checks=1)
    first = WarmingContext(ends_after=10)
    with pytest.raises(KeyboardInterrupt):
        run(plan, first)
    assert len(first.stored) == 10
    # The clock of another process has another origin.
    second = run(plan, WarmingContext(stored=dict(first.stored), resumed=True, now_s=5.0))
    assert not set(first.ran[:-1]) & set(second.ran)
    assert {row["segment"] for _, row in second.rows} == {1}
    assert verdict(second)["warm"] is True
    # Ten visits of a minute before, a window of 30 min after.
    assert verdict(second)["elapsed_min"] == pytest.approx(10 + 30, abs=3.0)


def test_an_ended_run_says_the_same_again() -> None:
    plan = planned(duration_limit_min=40.0)
    first = WarmingContext(grown_mm=lambda now_s: 2e-5 * now_s)
    with pytest.raises(NotWarmError) as once:
        run(plan, first)
    second = WarmingContext(stored=dict(first.stored))
    with pytest.raises(NotWarmError) as again:
        run(plan, second)
    assert str(again.value) == str(once.value)
    assert second.ran == []
    assert second.moves == []


def test_time_that_stands_still_does_not_warm_for_ever() -> None:
    plan = planned(window_min=6.0, checks=1, duration_limit_min=8.0)
    with pytest.raises(NotWarmError, match="the drift is not known"):
        run(plan, WarmingContext(step_s=0.0))


def test_one_cats_eye_is_asked_for() -> None:
    plan = planned(with_optics(bench(), one_reflector=True), checks=1)
    name = plan.trip.reflector.name
    ctx = run(plan, WarmingContext(answers={f"place/{name}": "yes"}))
    assert [prompt.task for prompt in ctx.prompts] == [PlaceReflector(reflector=name)]


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        ({"overspeed": True}, "overspeed"),
        ({"laser_ready": False}, "laser"),
        ({"signal": 0.05}, "weak-signal"),
    ],
)
def test_what_the_count_was_lost_by_is_reported(fault: dict[str, Any], cause: str) -> None:
    ctx = FaultyContext(fault=fault)
    run(planned(with_optics(bench(), signal_min=0.1), checks=1), ctx)
    assert [data["cause"] for kind, data in ctx.events if kind == "beam-lost"] == [cause]
    assert ctx.zeros == 2
