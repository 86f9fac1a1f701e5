"""A path measured by distances: which reflector, the beam kept on the way, and what a lost beam costs."""

import math
from functools import partial

import pytest

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import BeamLostError, PlanError, PlanLimitError
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.tasks import PlaceReflector
from catseye.procedures.scara.path.path_plan import PathPlan, plan_path
from catseye.procedures.scara.path.validation_path import ValidationPath
from tests.unit.procedures.benches import (
    PLACES,
    IdealContext,
    arm_xy,
    bench,
    clearance_mm,
    miss_along,
    with_axes,
    with_optics,
)
from tests.unit.procedures.troubles import TroubledContext


def planned(step_mm: float = 50.0, passes: int = 1, reflector: str = "") -> PathPlan:
    return plan_path(
        bench(),
        step_mm=step_mm,
        passes=passes,
        instrument="interferometer",
        reflector=reflector,
    )


def length_mm(row: Row) -> float:
    place = PLACES[str(row["reflector"])]
    return math.dist(arm_xy(_real(row["theta1_deg"]), _real(row["theta2_deg"])), place)


def _real(value: object) -> float:
    assert isinstance(value, (int, float))
    return float(value)


def paths(context: IdealContext) -> list[Row]:
    return [row for table, row in context.rows if table == "path"]


def require_true(rows: list[Row]) -> None:
    """Within a segment displacements differ as the lengths of the beam do."""
    for segment in {row["segment"] for row in rows}:
        own = [row for row in rows if row["segment"] == segment]
        zeros = [length_mm(row) - _real(row["displacement_mm"]) for row in own]
        assert zeros == pytest.approx([zeros[0]] * len(zeros), abs=1e-6)


def test_the_beam_is_kept_between_the_points_too() -> None:
    plan = planned()
    assert plan.tracked is not None
    place = (plan.tracked.reflector.x_mm, plan.tracked.reflector.y_mm)
    here = plan.tracked.visits[0].node
    for visit in plan.tracked.visits[1:]:
        assert visit.tracked
        for target in visit.moves:
            assert float(miss_along(here, target, place).max()) <= 0.2 + 1e-9
            here = target


def test_each_visit_ends_at_its_point_with_its_directions() -> None:
    plan = planned(passes=2)
    assert plan.tracked is not None
    assert len(plan.tracked.visits) == 2 * len(plan.points)
    for number, visit in enumerate(plan.tracked.visits):
        point = plan.points[number % len(plan.points)]
        assert visit.node[:2] == pytest.approx((point.theta1_deg, point.theta2_deg))
        assert (visit.command.direction1, visit.command.direction2) == (point.direction1, point.direction2)
    # The second pass is run in like the first, along a tracked way.
    again = plan.tracked.visits[len(plan.points)]
    assert again.tracked
    assert again.legs[0][-1][:2] == pytest.approx(plan.run_in[:2])


def seen_from(place: tuple[float, float], plan: PathPlan) -> int:
    """Count the points that see a place past the column of 115 mm with its margin, within 80° of the J1 axis."""
    count = 0
    for point in plan.points:
        back = math.atan2(point.y_mm - place[1], point.x_mm - place[0]) - math.atan2(-place[1], -place[0])
        field_deg = abs(math.degrees(math.atan2(math.sin(back), math.cos(back))))
        count += clearance_mm((point.x_mm, point.y_mm), place) > 115.0 and field_deg <= 80.0
    return count


def test_the_reflector_seeing_most_is_chosen_and_blind_points_reported() -> None:
    base = bench(places={"A": (-700.0, 300.0), "B": (-400.0, -600.0)})
    plan = plan_path(base, step_mm=25.0, instrument="interferometer")
    seen = {r.name: seen_from((r.x_mm, r.y_mm), plan) for r in base.reflectors}
    assert plan.tracked is not None
    assert plan.tracked.reflector.name == max(seen, key=lambda name: seen[name])
    assert len(plan.tracked.visits) == max(seen.values())
    assert len(plan.tracked.blind) == len(plan.points) - max(seen.values()) > 0
    texts = plan.tracked.warnings()
    assert f"{len(plan.tracked.blind)} points of the path are blind and left out" in texts[0]
    assert plan.tracked.planned_breaks == sum(not visit.tracked for visit in plan.tracked.visits) - 1 > 0
    assert f"cannot be kept {plan.tracked.planned_breaks} time(s)" in texts[1]


def test_a_reflector_that_is_unknown_or_hidden_is_refused() -> None:
    with pytest.raises(PlanError, match="reflector P9 is not in the cell file; known: P1, P2, P3"):
        planned(reflector="P9")
    hidden = bench(places={"A": (-700.0, 0.0)})
    with pytest.raises(PlanError, match=r"only \d+ of 42 points of the path.*param reflector"):
        plan_path(with_optics(hidden, column_radius_mm=300.0), step_mm=50.0, instrument="interferometer")


def test_every_point_needs_room_for_a_recovery_take_up() -> None:
    short = partial(plan_path, y_from_mm=-410.0, y_to_mm=-400.0, step_mm=1.0)
    highest = max(point.theta2_deg for point in short(bench()).points)
    tight = with_axes(bench(), j2_deg=(-145.0, highest + 0.1))
    # One step behind the turn the arm would come back from beyond it.
    with pytest.raises(PlanLimitError, match="the path needs J2"):
        short(tight, instrument="interferometer")
    assert short(tight, instrument="tracker").tracked is None


async def test_every_point_is_a_distance_to_one_reflector() -> None:
    context, plan = IdealContext(), planned(step_mm=100.0, passes=2)
    await ValidationPath().run(context, plan)
    rows = paths(context)
    assert [row["pass_number"] for row in rows] == [0] * 22 + [1] * 22
    assert [row["y_mm"] for row in rows[:22]] == [point.y_mm for point in plan.points]
    assert {row["segment"] for row in rows} == {0}
    assert all(row["x_meas_mm"] is None for row in rows)
    require_true(rows)
    done_s, total_s, text = context.progressed[-1]
    assert text == "path point 44/44"
    assert done_s == pytest.approx(total_s)
    assert total_s >= plan.duration_s


async def test_a_planned_break_begins_a_segment() -> None:
    base = bench(places={"A": (-700.0, 300.0)})
    plan = plan_path(base, step_mm=50.0, instrument="interferometer")
    assert plan.tracked is not None
    context = IdealContext(places={"A": (-700.0, 300.0)})
    await ValidationPath().run(context, plan)
    rows = paths(context)
    assert len(rows) == len(plan.tracked.visits)
    assert len({row["segment"] for row in rows}) == 1 + plan.tracked.planned_breaks > 1
    assert context.warnings == plan.tracked.warnings()
    PLACES["A"] = (-700.0, 300.0)
    try:
        require_true(rows)
    finally:
        del PLACES["A"]


async def test_a_lost_beam_begins_a_segment_and_loses_no_point() -> None:
    context, plan = TroubledContext(breaks_at={5}), planned(step_mm=100.0)
    await ValidationPath().run(context, plan)
    rows = paths(context)
    assert len(rows) == len(plan.points)
    assert [row["segment"] for row in rows] == [0] * 4 + [1] * (len(rows) - 4)
    require_true(rows)
    assert [kind for kind, _ in context.events].count("beam-lost") == 1


@pytest.mark.parametrize("answer", ["retry", "skip", "stop"])
async def test_after_three_failures_the_operator_is_asked(answer: str) -> None:
    plan = planned(step_mm=100.0)
    stuck = (plan.points[6].theta1_deg, plan.points[6].theta2_deg)
    standing = {"there": True}

    def blocked(pose: Pose) -> bool:
        return standing["there"] and math.dist(pose[:2], stuck) < 1e-6

    context = TroubledContext(blocked=blocked)

    def answered(_prompt: object) -> str:
        standing["there"] = answer != "retry"
        return answer

    context.answers = {"beam/path/0/0006": answered}
    # The way back passes the same place.
    context.answers |= {f"beam/path/0/{number:04d}": "skip" for number in range(7, 22)}
    if answer == "stop":
        with pytest.raises(BeamLostError, match="catseye resume"):
            await ValidationPath().run(context, plan)
        assert len(paths(context)) == 6
        return
    await ValidationPath().run(context, plan)
    rows = paths(context)
    places = [row["y_mm"] for row in rows]
    require_true(rows)
    assert len(rows) == 22 - (0 if answer == "retry" else 2)
    assert places.count(plan.points[6].y_mm) == (2 if answer == "retry" else 0)
    (prompt,) = [p for p in context.prompts if p.id == "beam/path/0/0006"]
    assert (prompt.choices, prompt.safe_answer) == (("retry", "skip", "stop"), "stop")


async def test_an_interrupted_run_reenters_with_the_next_points_directions() -> None:
    plan = planned(step_mm=100.0)
    first = IdealContext()
    await ValidationPath().run(first, plan)
    stored = dict(list(first.stored.items())[:7])
    again = IdealContext(stored=stored, resumed=True, pose=(40.0, 100.0, 12.5, 0.0))
    await ValidationPath().run(again, plan)
    point = plan.points[7]
    reached = next(
        i
        for i, pose in enumerate(again.moves)
        if math.dist(pose[:2], (point.theta1_deg, point.theta2_deg)) < 1e-6
    )
    before = again.moves[reached - 1]
    assert (point.theta1_deg - before[0]) * point.direction1 == pytest.approx(1.0)
    assert (point.theta2_deg - before[1]) * point.direction2 == pytest.approx(1.0)
    rows = paths(again)
    assert len(rows) == 15
    assert {row["segment"] for row in rows} == {1}
    require_true(rows)


async def test_one_cats_eye_for_all_nests_is_asked_for() -> None:
    plan = plan_path(with_optics(bench(), one_reflector=True), step_mm=200.0, instrument="interferometer")
    assert plan.tracked is not None
    name = plan.tracked.reflector.name
    context = IdealContext(answers={f"place/{name}": "yes"})
    await ValidationPath().run(context, plan)
    (prompt,) = context.prompts
    assert prompt.task == PlaceReflector(reflector=name)
