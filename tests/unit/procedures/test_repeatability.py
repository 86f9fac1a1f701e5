"""The repeatability test: its way, its statistics, what breaks it, on an arm that scatters by a known amount."""

import asyncio
import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Measurement, Prompt
from catseye.procedures.kit.errors import BeamLostError, NotPlacedError, PlanError
from catseye.procedures.kit.tasks import PlaceReflector
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.repeats.repeatability import Repeatability, RepeatabilityParams
from catseye.procedures.scara.repeats.repeatability_plan import RepeatabilityPlan
from tests.unit.procedures.benches import PLACES, IdealContext, arm_xy, bench, miss_along, with_optics

POSES = [[-40.0, 60.0], [20.0, 100.0]]


@dataclass
class ScatteringContext(IdealContext):
    """An arm whose arrivals scatter by 10 µm in x and in y."""

    sigma_mm: float = 0.010
    drift_mm: float = 0.0
    ends_after: int = 10**6
    unsettled_at: set[int] = field(default_factory=set)
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(7))

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the distance with the scatter of this arrival."""
        if self.measurements >= self.ends_after:
            raise KeyboardInterrupt
        ideal = await super().measure(settle_time_s, dwell_time_s, readings)
        scatter = float(self.rng.normal(0.0, self.sigma_mm)) + self.drift_mm * self.measurements
        spread = 1.0 if self.measurements in self.unsettled_at else ideal.spread_mm
        return replace(ideal, displacement_mm=ideal.displacement_mm + scatter, spread_mm=spread)


def planned(base: ScaraBench | None = None, **params: object) -> RepeatabilityPlan:
    given = {"poses": POSES, "cycles": 10, "reflectors": ["P2"], **params}
    return Repeatability().plan(base or bench(), RepeatabilityParams.model_validate(given))


def run(plan: RepeatabilityPlan, ctx: ScatteringContext) -> ScatteringContext:
    asyncio.run(Repeatability().run(ctx, plan))
    return ctx


def beams(ctx: IdealContext) -> list[dict[str, Any]]:
    found: Any = ctx.stored["analyse"]["beams"]
    return list(found)


def positions(ctx: IdealContext) -> list[dict[str, Any]]:
    found: Any = ctx.stored["analyse"]["positions"]
    return list(found)


def way(plan: RepeatabilityPlan, number: int = 0) -> list[Pose]:
    trip = plan.reflectors[number].trip
    return [trip.start, *(target for leg in trip.legs for target in leg)]


def test_the_beam_is_kept_throughout_and_between_cycles() -> None:
    plan = planned(reflectors=[])
    for number, name in enumerate(PLACES):
        targets = way(plan, number)
        assert max(miss_along(a, b, PLACES[name]).max() for a, b in pairwise(targets)) <= 0.2 + 1e-6
        assert targets[0] == targets[-1]


def test_every_pose_is_approached_upwards_from_its_run_in() -> None:
    plan = planned(poses=4)
    targets = [target[:2] for target in way(plan)]
    for one, two in plan.poses:
        place = targets.index((one, two))
        run_in = (one - 1.0, two - 1.0)
        assert any(target == pytest.approx(run_in) for target in targets[:place])
        before = targets[place - 1]
        assert 0.0 < one - before[0] <= 1.0
        assert 0.0 < two - before[1] <= 1.0


def test_poses_are_spread_over_the_nodes_where_beams_cross() -> None:
    plan = planned(poses=5, reflectors=[])
    assert len(set(plan.poses)) == 5
    places = [arm_xy(*pose) for pose in plan.poses]
    nearest = min(math.dist(a, b) for i, a in enumerate(places) for b in places[:i])
    assert nearest > 100.0
    for x, y in places:
        angles = sorted(math.atan2(py - y, px - x) for px, py in PLACES.values())
        assert angles[-1] - angles[0] > math.radians(40.0)


def test_what_cannot_be_planned_is_refused_with_the_remedy() -> None:
    with pytest.raises(PlanError, match="P9 is not in the cell file; known: P1, P2, P3"):
        planned(reflectors=["P9"])
    with pytest.raises(PlanError, match="named twice"):
        planned(reflectors=["P1", "P1"])
    with pytest.raises(PlanError, match="given twice"):
        planned(poses=[[0.0, 20.0], [0.0, 20.0]])
    with pytest.raises(PlanError, match="outside its limits"):
        planned(poses=[[-170.0, 60.0]])
    hidden = with_optics(bench(), column_radius_mm=250.0)
    with pytest.raises(
        PlanError, match=r"P2 cannot be kept on the way over the poses \(-140°, 0°\), \(60°, 0°\)"
    ):
        planned(hidden, poses=[[-140.0, 0.0], [60.0, 0.0]])
    with pytest.raises(PlanError, match=r"only 0 of 5 poses .* ask for fewer"):
        planned(with_optics(bench(), beam_max_mm=60.0), poses=5)


def test_the_spread_along_the_beam_is_that_of_the_arm() -> None:
    ctx = run(planned(cycles=60), ScatteringContext())
    found = beams(ctx)
    assert [(row["pose"], row["reflector"], row["arrivals"], row["dof"]) for row in found] == [
        (1, "P2", 60, 59),
        (2, "P2", 60, 59),
    ]
    for row in found:
        # S of 59 degrees of freedom scatters by 9 %.
        assert row["s_um"] == pytest.approx(10.0, rel=0.28)
        assert row["s_low_um"] < row["s_um"] < row["s_high_um"]
        assert row["rp_um"] == pytest.approx(3.0 * row["s_um"])
    assert ctx.zeros == 1
    assert positions(ctx) == []
    rows = [row for table, row in ctx.rows if table == "records"]
    assert {row["kind"] for row in rows} == {"repeat"}
    assert [(row["cycle"], row["pose"]) for row in rows] == [(c, p) for c in range(1, 61) for p in (1, 2)]
    of_first = np.array([row["displacement_mm"] for row in rows if row["pose"] == 1], dtype=np.float64)
    assert found[0]["s_um"] == pytest.approx(1e3 * of_first.std(ddof=1))
    assert found[0]["range_um"] == pytest.approx(1e3 * np.ptp(of_first))


def test_three_reflectors_give_the_repeatability_of_the_position() -> None:
    ctx = run(planned(cycles=150, reflectors=[], poses=[[20.0, 100.0]]), ScatteringContext())
    (row,) = positions(ctx)
    # A round spread of 10 µm: RP = 10 (1.2533 + 3 · 0.6551) µm.
    assert row["rp_um"] == pytest.approx(32.19, abs=3.0 * row["u_rp_um"])
    assert row["assumption"] == ""
    assert "one after another" in row["basis"]


def test_two_reflectors_give_it_with_an_assumption() -> None:
    ctx = run(planned(cycles=40, reflectors=["P1", "P3"]), ScatteringContext())
    for row in positions(ctx):
        assert row["rp_um"] == pytest.approx(32.19, rel=0.3)
        assert "roundest" in row["assumption"]


def test_a_position_that_has_no_spread_is_refused_by_name() -> None:
    narrow = {"P1": (1950.0, -60.0), "P2": (2000.0, 0.0)}
    plan = planned(bench(places=narrow), reflectors=[], poses=[[20.0, 100.0]])
    ctx = run(plan, ScatteringContext(places=narrow))
    assert "too nearly parallel" in positions(ctx)[0]["refused"]
    assert any("pose 1: the beams are too nearly parallel" in text for text in ctx.warnings)
    assert beams(ctx)[0]["s_um"] > 0.0


def test_a_drift_is_warned_about() -> None:
    ctx = run(planned(cycles=30), ScatteringContext(drift_mm=0.001))
    assert beams(ctx)[0]["drift_um"] == pytest.approx(58.0, abs=15.0)
    assert any("warm the arm up first" in text for text in ctx.warnings)


def test_a_cycle_losing_the_beam_repeats_in_a_new_segment() -> None:
    ctx = run(planned(), ScatteringContext(breaks_at={8}))
    rows = [row for _, row in ctx.rows]
    # Measurement 8 is the second pose of the fourth cycle: the whole cycle is repeated, nothing of it counts twice.
    assert [row["segment"] for row in rows] == [0] * 6 + [1] * 14
    assert [(row["cycle"], row["pose"]) for row in rows] == [(c, p) for c in range(1, 11) for p in (1, 2)]
    assert ctx.measurements == 22
    assert [row["dof"] for row in beams(ctx)] == [8, 8]
    assert [data["where"] for kind, data in ctx.events if kind == "beam-lost"] == ["P2 pose 2 cycle 4"]


def test_a_measurement_with_the_arm_moved_aside_is_repeated() -> None:
    @dataclass
    class PushedContext(ScatteringContext):
        """The arm stands a little beside its pose once; the beam follows it within its window."""

        async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
            measured = await super().measure(settle_time_s, dwell_time_s, readings)
            if self.measurements != 6:
                return measured
            one, *others = measured.reported
            beside = (one + 0.15, others[0], others[1], others[2])
            return replace(measured, displacement_mm=measured.displacement_mm + 0.8, reported=beside)

    ctx = run(planned(), PushedContext())
    assert [data["cause"] for kind, data in ctx.events if kind == "beam-lost"] == ["moved-by-hand"]
    assert len([row for _, row in ctx.rows]) == 20
    assert all(beam["s_um"] < 20.0 for beam in beams(ctx))
    assert ctx.zeros == 2


def test_a_beam_that_breaks_all_the_time_is_a_question() -> None:
    ctx = ScatteringContext(breaks_at=set(range(5, 100)), answers={"beam/P2/1": "retry", "beam/P2/2": "stop"})
    with pytest.raises(BeamLostError, match="P2 was lost 3 times in a row"):
        run(planned(), ctx)
    assert [prompt.id for prompt in ctx.prompts] == ["beam/P2/1", "beam/P2/2"]
    assert len(ctx.stored) == 2


def test_a_beam_that_breaks_in_every_cycle_leaves_no_spread() -> None:
    with pytest.raises(InsufficientPointsError, match="no pose was attained twice with one dead path"):
        run(planned(cycles=3), ScatteringContext(breaks_at={3, 6}))


def test_a_point_that_does_not_settle_may_be_left_out() -> None:
    base = replace(bench(), timing=replace(bench().timing, spread_limit_mm=0.005))
    ctx = ScatteringContext(unsettled_at={3, 4, 5}, answers={"unsettled/P2 pose 1 cycle 2/1": "skip"})
    run(planned(base), ctx)
    assert [row["arrivals"] for row in beams(ctx)] == [9, 10]
    assert ctx.zeros == 1


def test_an_interrupted_run_goes_on_in_a_new_segment() -> None:
    plan = planned()
    first = ScatteringContext(ends_after=9)
    with pytest.raises(KeyboardInterrupt):
        run(plan, first)
    assert list(first.stored) == [f"P2/cycle/{cycle:04d}" for cycle in range(4)]
    second = run(plan, ScatteringContext(stored=dict(first.stored), resumed=True))
    assert second.ran[0] == "P2/cycle/0004"
    assert {row["segment"] for _, row in second.rows} == {1}
    assert [row["dof"] for row in beams(second)] == [8, 8]


def test_a_reflector_that_is_done_is_not_asked_for_again() -> None:
    base = with_optics(bench(), one_reflector=True)
    plan = planned(base, cycles=3, reflectors=["P1", "P3"])
    answers: Any = {"place/P1": "yes", "place/P3": "yes"}
    first = ScatteringContext(answers=answers)
    run(plan, first)
    assert [prompt.id for prompt in first.prompts] == ["place/P1", "place/P3"]
    left = {key: row for key, row in first.stored.items() if key.startswith("P1") or key == "P3/cycle/0000"}
    second = run(plan, ScatteringContext(stored=left, resumed=True, answers=answers))
    assert [prompt.id for prompt in second.prompts] == ["place/P3"]
    assert second.ran == ["P3/cycle/0001", "P3/cycle/0002", "analyse"]


def test_a_reflector_that_is_not_placed_ends_it() -> None:
    def refused(prompt: Prompt) -> str:
        assert prompt.task == PlaceReflector(reflector="P2")
        assert prompt.motion
        return "no"

    with pytest.raises(NotPlacedError, match="not put into nest P2"):
        run(
            planned(with_optics(bench(), one_reflector=True)),
            ScatteringContext(answers={"place/P2": refused}),
        )


def test_the_time_left_counts_in_bench_seconds() -> None:
    plan = planned(cycles=4, reflectors=["P1", "P2"])
    ctx = run(plan, ScatteringContext())
    assert ctx.progressed[-1][:2] == pytest.approx((plan.duration_s, plan.duration_s))
    assert ctx.progressed[0][0] == pytest.approx(plan.cycle_s[0])
    assert {live.name for live in ctx.shown} >= {"largest S", "S of pose 1 along the beam to P1"}
