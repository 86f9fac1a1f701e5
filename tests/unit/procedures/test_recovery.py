"""A lost beam: why, what is done about it, and that no point comes from a count that was broken."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import BeamLostError
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.tasks import ClearBeam
from catseye.procedures.scara.beam.beam_scan import look_around_deg
from catseye.procedures.scara.beam.diagnosis import hidden
from catseye.procedures.scara.open_loop.open_loop import OpenLoop
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, plan_open_loop
from tests.unit.procedures.benches import PLACES, arm_xy, bench, clearance_mm, with_optics
from tests.unit.procedures.troubles import TroubledContext

NODES = (-40.0, -20.0), (20.0, 40.0, 60.0)
COUNT = 4 * 6


def small_plan(**optics: Any) -> OpenLoopPlan:
    return plan_open_loop(with_optics(bench(*NODES), **optics), reflectors=("P2",))


async def ran(context: TroubledContext, plan: OpenLoopPlan | None = None) -> TroubledContext:
    await OpenLoop().run(context, plan or small_plan())
    return context


def points(context: TroubledContext) -> list[Row]:
    return [row for table, row in context.rows if table == "points"]


def overlaps(context: TroubledContext) -> list[Row]:
    return [row for table, row in context.rows if table == "records" and row["kind"] == "overlap"]


def events(context: TroubledContext, kind: str) -> list[dict[str, Any]]:
    return [data for name, data in context.events if name == kind]


def causes(context: TroubledContext) -> list[str]:
    return [str(data["cause"]) for data in events(context, "beam-lost")]


def real(value: object) -> float:
    assert isinstance(value, (int, float))
    return float(value)


def length_mm(row: Row, place: tuple[float, float] = PLACES["P2"]) -> float:
    return math.dist(arm_xy(real(row["theta1_deg"]), real(row["theta2_deg"])), place)


def require_right(context: TroubledContext, count: int = COUNT) -> None:
    """Every point is there once, and within a segment displacements differ as the lengths do."""
    rows = points(context)
    assert len(rows) == count
    assert (
        len({tuple(row[k] for k in ("theta1_deg", "theta2_deg", "direction1", "direction2")) for row in rows})
        == count
    )
    for a, b in pairwise(rows):
        if a["segment"] == b["segment"]:
            change = real(b["displacement_mm"]) - real(a["displacement_mm"])
            assert change == pytest.approx(length_mm(b) - length_mm(a), abs=1e-6)


def first_two_legged(plan: OpenLoopPlan) -> tuple[int, int]:
    """Return the place of the first kept way with two legs, and the number of the move that ends its first leg."""
    visits = plan.reflectors[0].visits
    place = next(i for i, visit in enumerate(visits) if visit.tracked and len(visit.legs) == 2)
    before = sum(len(visit.moves) for visit in visits[:place])
    return place, before + len(visits[place].legs[0])


async def test_a_beam_lost_at_a_point_recovers_with_an_overlap() -> None:
    context = await ran(TroubledContext(breaks_at={6}))
    require_right(context)
    rows = points(context)
    assert [row["segment"] for row in rows] == [0] * 5 + [1] * (COUNT - 5)
    (overlap,) = overlaps(context)
    assert (overlap["point"], overlap["segment"], overlap["previous_segment"]) == (4, 1, 0)
    assert overlap["displacement_mm"] == pytest.approx(0.0, abs=1e-9)
    assert overlap["previous_displacement_mm"] == rows[4]["displacement_mm"]
    # The difference ties the zeros: what the new segment counts from there on, the old one would have counted too.
    tied = real(rows[5]["displacement_mm"]) - real(overlap["difference_mm"])
    assert tied == pytest.approx(length_mm(rows[5]) - length_mm(rows[0]), abs=1e-6)
    assert causes(context) == ["interrupted"]
    assert context.prompts == []


async def test_the_last_good_pose_is_approached_as_it_was_before() -> None:
    plan = small_plan()
    context = await ran(TroubledContext(breaks_at={6}), plan)
    node = plan.reflectors[0].visits[4].node
    command = plan.reflectors[0].visits[4].command
    # Upwards, downwards, and once more after the loss.
    again = [i for i, pose in enumerate(context.moves) if pose == node][2]
    before = context.moves[again - 1]
    assert (node[0] - before[0], node[1] - before[1]) == pytest.approx(
        (command.direction1, command.direction2)
    )


async def test_losing_the_beam_on_a_leg_abandons_the_visit() -> None:
    plan = small_plan()
    place, move = first_two_legged(plan)
    context = await ran(TroubledContext(breaks_on_move={move}), plan)
    require_right(context)
    visit = plan.reflectors[0].visits[place]
    # After the leg on which it was lost comes the way back, not the second leg.
    assert context.moves[move - 1] == visit.legs[0][-1]
    back = plan.reflectors[0].visits[place - 1]
    assert context.moves[move + 1] == back.node
    assert causes(context) == ["interrupted"]
    assert events(context, "beam-lost")[0]["point"] == visit.command.index


async def test_every_beam_loss_begins_a_segment_with_a_warning() -> None:
    context = await ran(TroubledContext(breaks_at={6, 12}))
    require_right(context)
    assert len({row["segment"] for row in points(context)}) == 3
    assert len(overlaps(context)) == 2
    assert [text.startswith("beam lost, P2: θ1 ") for text in context.warnings] == [True, True]
    assert all("keep out of its way" in text for text in context.warnings)


async def test_an_overrun_counter_is_reported_with_the_override() -> None:
    plan = small_plan()
    _, move = first_two_legged(plan)
    context = await ran(TroubledContext(fast_on_move={move}), plan)
    require_right(context)
    assert causes(context) == ["overspeed"]
    assert "lower override_cap_percent (now 20 %)" in context.warnings[0]


async def test_a_laser_losing_lock_suspends_and_begins_a_segment() -> None:
    context = await ran(TroubledContext(laser_off_at={6}))
    require_right(context)
    assert len(context.suspensions) == 1
    assert causes(context) == ["laser"]
    assert [row["segment"] for row in points(context)] == [0] * 5 + [1] * (COUNT - 5)


def moves_the_reflector(context: TroubledContext, number: int, dy_mm: float) -> Callable[[int], None]:
    def shift(measurement: int) -> None:
        if measurement == number:
            x, y = PLACES["P2"]
            context.places["P2"] = (x, y + dy_mm)

    return shift


def across_mm(plan: OpenLoopPlan, point: object, dy_mm: float) -> float:
    """Return how far a push along y moves a reflector across the beam from a point; J4 turns by as much."""
    one, two = next(v.node[:2] for v in plan.reflectors[0].visits if v.command.index == point)
    x, y = arm_xy(one, two)
    return dy_mm * math.cos(math.atan2(PLACES["P2"][1] - y, PLACES["P2"][0] - x))


async def test_a_displaced_reflector_is_measured_and_warned_about() -> None:
    plan = small_plan()
    context = TroubledContext(places={"P2": PLACES["P2"]})
    context.before_measuring = moves_the_reflector(context, 6, 2.4)
    await ran(context, plan)
    assert len(points(context)) == COUNT
    first, overlap = events(context, "beam-lost")[0], overlaps(context)[0]
    assert first["cause"] == "aim"
    assert first["off_mm"] == pytest.approx(across_mm(plan, first["point"], 2.4), abs=0.05)
    assert overlap["across_mm"] == pytest.approx(across_mm(plan, overlap["point"], 2.4), abs=0.05)
    (moved,) = (text for text in context.warnings if "has been moved:" in text)
    assert "search again (reflector-search) and start a new run" in moved
    # J4 keeps what it was corrected by while the beam is kept, so not every point loses it again.
    assert len(causes(context)) < 8


async def test_a_weak_signal_is_aimed_anew_without_losing_the_count() -> None:
    plan = small_plan(signal_min=0.5)
    context = TroubledContext(places={"P2": (680.0, 0.8)}, gaussian=True)
    context.blocked = lambda _pose: False
    await ran(context, plan)
    rows = points(context)
    assert len(rows) == COUNT
    assert all(real(row["signal"]) >= 0.5 for row in rows)
    assert {row["segment"] for row in rows} == {0}
    assert context.zeros == 1


async def test_a_signal_that_stays_weak_is_never_measured_with() -> None:
    plan = small_plan(signal_min=0.9)
    context = TroubledContext(answers={"beam/P2/0000": "stop"})
    with pytest.raises(BeamLostError, match=r"the signal is 0\.75, signal_min is 0\.9: clean the reflector"):
        await ran(context, plan)
    assert points(context) == []
    assert set(causes(context)) == {"weak-signal"}


async def test_a_missing_beam_is_asked_about_after_three_attempts() -> None:
    context = TroubledContext()
    gone: list[int] = []
    context.blocked = lambda _pose: bool(gone)
    context.before_measuring = lambda number: gone.append(number) if number == 6 else None

    def clears(prompt: Prompt) -> str:
        assert "reflector P2" in prompt.text
        assert "θ1 -40°" in prompt.text
        assert "nothing returns within ±0.5°" in prompt.text
        assert (prompt.choices, prompt.safe_answer) == (("retry", "skip", "stop"), "stop")
        assert prompt.task == ClearBeam()
        gone.clear()
        return "retry"

    context.answers = {"beam/P2/0005": clears}
    await ran(context)
    require_right(context)
    assert causes(context) == ["no-return"] * 4
    assert len(overlaps(context)) == 1


async def test_attempts_are_a_matter_of_choice() -> None:
    context = TroubledContext(answers={"beam/P2/0000": "stop"}, blocked=lambda _pose: True)
    plan = small_plan()
    with pytest.raises(BeamLostError):
        await ran(context, replace(plan, rules=replace(plan.rules, recovery_attempts=1)))
    assert len(causes(context)) == 1


async def test_skipped_points_are_listed_at_the_end() -> None:
    def stands_in_the_way(pose: Pose) -> bool:
        return abs(pose[0] + 20.0) < 0.5 and abs(pose[1] - 40.0) < 0.5

    context = TroubledContext(blocked=stands_in_the_way)
    steps = ("P2/0007", "P2/0010", "P2/0013", "P2/0016")
    context.answers = {f"beam/{step}": "skip" for step in steps}
    await ran(context)
    require_right(context, COUNT - 4)
    assert set(causes(context)) == {"no-return"}
    assert [name for name, result in context.stored.items() if not result["measured"]] == list(steps)
    assert context.stored["P2/0007"]["reason"] == "no-return"
    assert context.warnings[-1].startswith(
        "4 points were left out: P2: θ1 -20° (+), θ2 40° (+) (no-return); "
    )
    assert [data["point"] for data in events(context, "point-left-out")] == [7, 10, 13, 16]


async def test_a_stopped_run_goes_on_later() -> None:
    gone = [True]
    context = TroubledContext(answers={"beam/P2/0005": "stop"})
    context.blocked = lambda _pose: bool(gone) and context.measurements >= 6
    with pytest.raises(BeamLostError, match="catseye resume"):
        await ran(context)
    assert len(points(context)) == 5
    later = TroubledContext(stored=dict(context.stored), pose=context.pose, resumed=True)
    await ran(later)
    assert len(points(later)) == COUNT - 5
    assert {row["segment"] for row in points(later)} == {1}


async def test_the_same_answer_for_ever_ends_the_run() -> None:
    context = TroubledContext(blocked=lambda _pose: True)
    names = ["beam/P2/0000", *(f"beam/P2/0000/{number}" for number in range(2, 40))]
    context.answers = dict.fromkeys(names, "retry")
    with pytest.raises(BeamLostError):
        await ran(context)
    assert len(context.prompts) == 10
    assert len({prompt.id for prompt in context.prompts}) == 10


@pytest.mark.parametrize("breaks", [{6, 7}, {6, 8}, {1}, {1, 2}, {6, 7, 8}, {24, 26}])
async def test_breaks_while_recovering_never_reach_a_point(breaks: set[int]) -> None:
    context = await ran(TroubledContext(breaks_at=breaks))
    require_right(context)
    assert len(causes(context)) == len(breaks)


@pytest.mark.parametrize("refused", [{1}, {2}, {2, 3}])
async def test_a_zero_refused_without_a_beam_is_retried(refused: set[int]) -> None:
    context = await ran(TroubledContext(breaks_at={6}, refused_zeros=refused))
    require_right(context)
    assert context.prompts == []


@pytest.mark.parametrize("moment", range(3, 12))
async def test_a_jogged_arm_returns_to_the_last_good_pose(moment: int) -> None:
    context = TroubledContext()

    def jog(look: int) -> None:
        if look == moment:
            context.pose = (-30.0, 33.0, 12.5, 10.0)
            context.lost = True

    context.before_joints = jog
    await ran(context)
    require_right(context)
    assert causes(context) == ["moved-by-hand"]
    assert len(overlaps(context)) == 1
    assert "leave it alone" in context.warnings[0]


async def test_an_arm_moved_during_a_leg_goes_back() -> None:
    plan = small_plan()
    place = next(i for i, v in enumerate(plan.reflectors[0].visits) if v.tracked and len(v.legs[0]) > 1)
    move = 1 + sum(len(visit.moves) for visit in plan.reflectors[0].visits[:place])
    context = await ran(TroubledContext(moved_on_way={move}), plan)
    require_right(context)
    assert causes(context) == ["moved-by-hand"]
    # The way back begins with a take-up at the last good pose.
    assert context.moves[move + 1] == plan.reflectors[0].visits[place - 1].node


@pytest.mark.parametrize("after", range(1, 9))
@pytest.mark.parametrize("off_deg", [0.0, 0.3])
async def test_an_arm_that_is_moved_during_a_recovery_enters_anew(after: int, off_deg: float) -> None:
    context = TroubledContext(breaks_at={6})

    def drift(number: int) -> None:
        if number == 6:
            # From here on the aim is off: the way back has to look for the beam.
            context.theta40_deg += off_deg
            context.moved_on_way = {len(context.moves) + after}

    context.before_measuring = drift
    await ran(context)
    require_right(context)
    assert context.prompts == []
    assert any("somebody has moved it" in text for text in context.warnings)


async def test_unsubdivided_legs_warn_once_and_zero_in_place() -> None:
    plan = plan_open_loop(bench(*NODES), reflectors=("P2",), subdivide=False)
    visits = plan.reflectors[0].visits
    place = next(i for i, visit in enumerate(visits) if visit.miss_mm > 1.0)
    number = place + 1
    context = await ran(TroubledContext(breaks_at={number}), plan)
    require_right(context)
    assert causes(context) == ["not-subdivided"]
    assert overlaps(context) == []
    assert sum("param subdivide" in text for text in context.warnings) == 1


def test_geometry_lets_suspect_column_and_field() -> None:
    paper = bench()
    reflector = paper.reflectors[1]
    # Straight behind the column, seen from the reflector, the beam would pass the J1 axis itself.
    behind: Pose = (180.0, 0.0, 12.5, 0.0)
    near = hidden(behind, paper, reflector)
    assert near is not None
    assert near.name == "column"
    assert near.facts["clearance_mm"] == pytest.approx(
        clearance_mm(arm_xy(180.0, 0.0), PLACES["P2"]), abs=1e-6
    )
    assert "column_radius_mm 110" in near.text
    aside = replace(reflector, facing_deg=reflector.facing_deg + 120.0)
    turned = hidden((-40.0, 60.0, 12.5, 0.0), paper, aside)
    assert turned is not None
    assert turned.name == "field"
    assert hidden((-40.0, 60.0, 12.5, 0.0), paper, reflector) is None


def test_j4_never_looks_as_far_as_another_reflector() -> None:
    pose: Pose = (-40.0, 60.0, 12.5, 0.0)
    x, y = arm_xy(-40.0, 60.0)
    ahead = math.atan2(PLACES["P2"][1] - y, PLACES["P2"][0] - x)
    beside = ahead + math.radians(0.6)
    length = math.dist((x, y), PLACES["P2"])
    near = (x + 1.5 * length * math.cos(beside), y + 1.5 * length * math.sin(beside))
    paper = bench(places={"P2": PLACES["P2"], "near": near})
    window = math.degrees(1.0 / length)
    assert look_around_deg(pose, paper, paper.reflectors[0]) == pytest.approx(0.6 - 2.0 * window, abs=1e-3)
    # A single reflector that is carried is never in two places.
    carried = with_optics(paper, one_reflector=True)
    assert look_around_deg(pose, carried, paper.reflectors[0]) == 0.5
    assert look_around_deg(pose, bench(), bench().reflectors[1]) == 0.5
