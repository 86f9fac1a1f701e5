"""A measurement in two halves: the interferometer is turned by half a turn in between."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from catseye.calibration.kinematics.bodies import Box
from catseye.calibration.scara.live_map import Innovation, LiveMap, MapKnowledge
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import AlignmentError, PlanError, PlanLimitError
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.tasks import MountInterferometer
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.open_loop.open_loop import OpenLoop, OpenLoopParams
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan
from tests.unit.procedures.benches import PLACES, miss_along, with_axes
from tests.unit.procedures.mounts import MountContext, mounted_bench

NODES = (-40.0, -20.0), (20.0, 40.0, 60.0)
COUNT = 2 * 2 * 2 * 3
PARAMS = OpenLoopParams(j4_reversal=True, reflectors=["P1", "P2"], closures=0, off_node=0)
ONCE = PARAMS.model_copy(update={"j4_reversal": False})


@dataclass
class RemountContext(MountContext):
    """Hands mount the interferometer as they are asked, a little off each time.

    Attributes:
        off_deg: what a mounting is off by, as a function of its number from 1.
        after_deg: what the mounting does to offset, mm, pitch, mrad, and height, mm.
    """

    off_deg: Callable[[int], float] = lambda _number: -1.25
    after: tuple[float, float, float] = (0.4, 0.9, 0.0)
    mounted: int = 0
    dark_before: list[bool] = field(default_factory=list)
    moved_while_asked: list[int] = field(default_factory=list)

    async def ask(self, prompt: Prompt, watch: Any = None) -> str:
        """Mount first what is to be mounted."""
        if isinstance(prompt.task, MountInterferometer) and self.answers.get(prompt.id) != "no":
            self.mounted += 1
            self.dark_before.append(self.length_mm() is None)
            before = len(self.moves)
            self.theta40_deg = prompt.task.turned_deg + self.off_deg(self.mounted)
            offset_mm, pitch_mrad, height_mm = self.after
            self.offset_mm += offset_mm
            self.pitch_mrad += pitch_mrad
            self.height_mm += height_mm
            self.lost = True
            answer = await super().ask(prompt, watch)
            self.moved_while_asked.append(len(self.moves) - before)
            return answer
        return await super().ask(prompt, watch)


def small_bench(**axes: Any) -> ScaraBench:
    base = mounted_bench()
    base = with_axes(base, **{"j3_mm": (40.0, 60.0), **axes})
    return replace(base, nodes1_deg=NODES[0], nodes2_deg=NODES[1])


def planned(params: OpenLoopParams = PARAMS, base: ScaraBench | None = None) -> OpenLoopPlan:
    procedure = OpenLoop()
    return procedure.plan(procedure.equipped(base or small_bench(), params), params)


async def ran(context: RemountContext, plan: OpenLoopPlan | None = None) -> RemountContext:
    procedure = OpenLoop()
    try:
        await procedure.run(context, plan or planned())
    finally:
        await procedure.teardown(context)
    return context


def points(context: RemountContext) -> list[Row]:
    return [row for table, row in context.rows if table == "points"]


def values(rows: list[Row], key: str) -> list[float]:
    found = [row[key] for row in rows]
    assert all(isinstance(value, (int, float)) for value in found)
    return [float(str(value)) for value in found]


def mounts(context: RemountContext) -> list[str]:
    return [prompt.id for prompt in context.prompts if isinstance(prompt.task, MountInterferometer)]


def test_the_turned_half_has_the_same_commands() -> None:
    plan = planned()
    assert [part.reflector.name for part in plan.turned] == ["P1", "P2"]
    for first, second in zip(plan.reflectors, plan.turned, strict=True):
        assert [visit.command for visit in second.visits] == [visit.command for visit in first.visits]
        for one, other in zip(first.visits, second.visits, strict=True):
            assert other.node[:3] == one.node[:3]
            assert math.cos(math.radians(other.node[3] - one.node[3])) == pytest.approx(-1.0, abs=1e-12)
    assert plan.n_points == 2 * 2 * COUNT


def test_the_turned_beam_keeps_to_its_reflector() -> None:
    for part in planned().turned:
        targets = [target for visit in part.visits for target in visit.moves]
        # By the geometry of the test, whose beam leaves along J1 + J2 + J4.
        turned = [(one, two, three, four + 180.0) for one, two, three, four in targets]
        place = PLACES[part.reflector.name]
        assert max(miss_along(a, b, place).max() for a, b in pairwise(turned)) < 0.2


def test_j4_keeps_room_for_a_mounting_that_is_off() -> None:
    # The straight arm looks at P2 near J4 = 0 in the first half, and near ±180° in the turned one.
    plan = planned(base=small_bench(j4_deg=(-240.0, 240.0)))
    j4 = [target[3] for part in plan.turned for visit in part.visits for target in visit.moves]
    assert min(j4) >= -235.0
    assert max(j4) <= 235.0


def test_a_plan_that_j4_cannot_turn_for_is_refused() -> None:
    narrow = small_bench(j4_deg=(-115.0, 115.0))
    assert planned(ONCE, narrow).turned == ()
    with pytest.raises(PlanLimitError, match="J4"):
        planned(base=narrow)


def test_a_cell_without_heights_for_levelling_is_refused() -> None:
    with pytest.raises(PlanError, match=r"j4_reversal levels .* set j3_range_mm"):
        planned(base=replace(small_bench(), j3_range_mm=None))


def test_the_head_is_kept_clear_both_ways() -> None:
    base = small_bench()
    body = base.workspace.bodies[-1]
    assert (body.start_mm[0], body.end_mm[0]) == (-30.0, 0.0)
    equipped = OpenLoop().equipped(base, PARAMS)
    turned = equipped.workspace.bodies[-1]
    assert (turned.name, turned.frame) == ("interferometer head, turned", 4)
    assert (turned.start_mm, turned.end_mm) == ((30.0, 0.0, -50.0), (0.0, 0.0, -50.0))
    assert OpenLoop().equipped(base, OpenLoopParams()) is base


def test_what_only_the_turned_head_meets_is_refused() -> None:
    # The head reaches 30 mm ahead of the J4 axis, turned 60 mm; the axis comes to x = 532 mm, take-up included.
    wall = Box("wall", (572.0, -400.0, 100.0), (580.0, 400.0, 250.0))
    base = small_bench()
    walled = replace(base, workspace=replace(base.workspace, keep_out=(wall,)))
    assert planned(ONCE, walled).n_points == 2 * COUNT
    with pytest.raises(PlanError, match="interferometer head, turned"):
        planned(base=walled)


def test_the_time_counts_both_halves_and_the_alignment() -> None:
    plan = planned()
    first, second = (sum(part.duration_s for part in half) for half in (plan.reflectors, plan.turned))
    assert second == pytest.approx(first, rel=0.1)
    assert plan.duration_s == pytest.approx(first + second + 7 * 60.0)


async def test_every_command_is_measured_again_in_new_segments() -> None:
    context = await ran(RemountContext())
    rows = points(context)
    first, second = rows[: 2 * COUNT], rows[2 * COUNT :]
    assert len(second) == 2 * COUNT
    for key in ("reflector", "theta1_deg", "theta2_deg", "direction1", "direction2"):
        assert [row[key] for row in second] == [row[key] for row in first]
    assert {(row["reflector"], row["segment"]) for row in first} == {("P1", 0), ("P2", 0)}
    assert {(row["reflector"], row["segment"]) for row in second} == {("P1", 1), ("P2", 1)}
    assert context.warnings == [context.warnings[-1]]
    assert re.search(r"stays turned by 178\.[78]°", context.warnings[-1])
    done, total, _ = context.progressed[-1]
    assert done == pytest.approx(total)


async def test_each_point_says_how_the_interferometer_was_mounted() -> None:
    context = await ran(RemountContext())
    rows = points(context)
    assert set(values(rows[: 2 * COUNT], "mount_deg")) == {0.0}
    (mount_deg,) = set(values(rows[2 * COUNT :], "mount_deg"))
    # Edges found to 2 mdeg, the offset known to a hundredth of a millimetre.
    assert mount_deg == pytest.approx(178.75, abs=0.005)
    assert context.mountings[-1] == mount_deg
    j4 = np.array(values(rows[2 * COUNT :], "j4_deg")) - np.array(values(rows[: 2 * COUNT], "j4_deg"))
    # The beam points where it did: J4 is turned back by as much as the mount is turned on.
    assert np.degrees(np.angle(np.exp(1j * np.radians(j4 + 178.75)))) == pytest.approx(0.0, abs=0.1)


async def test_the_live_map_knows_how_it_was_mounted(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[float] = []

    class Watched(LiveMap):
        def add(self, *args: Any, **kwargs: Any) -> Innovation | None:
            seen.append(math.degrees(args[7]))
            return super().add(*args, **kwargs)

    monkeypatch.setattr("catseye.procedures.scara.open_loop.live_knowledge.LiveMap", Watched)
    context = await ran(RemountContext())
    assert seen == pytest.approx(values(points(context), "mount_deg"))


async def test_only_the_turned_half_ends_early(monkeypatch: pytest.MonkeyPatch) -> None:
    good = MapKnowledge(math.radians(1e-3), math.radians(1e-3), "")
    monkeypatch.setattr("catseye.procedures.scara.open_loop.live_knowledge.LiveMap.known", lambda _self: good)
    plan = planned(PARAMS.model_copy(update={"stop_at_mdeg": 2.0}))
    context = await ran(RemountContext(), plan)
    mount_deg = values(points(context), "mount_deg")
    assert mount_deg[: 2 * COUNT] == [0.0] * (2 * COUNT)
    # The turned half ends with its first row of J2: three nodes, from both sides.
    assert len(mount_deg[2 * COUNT :]) == 6
    assert all(mount_deg[2 * COUNT :])
    assert [kind for kind, _ in context.events].count("early-stop") == 1


async def test_the_beam_is_aligned_before_it_is_measured_with() -> None:
    context = await ran(RemountContext())
    assert abs(context.offset_mm) < 0.1
    assert abs(context.pitch_mrad) < 0.2
    order = [step for step in context.ran if not step.startswith(("P", "turned/P"))]
    assert order[:2] == ["turned/stand", "turned/mount"]
    assert order[2] == "level/1/measure"
    assert order[-1] == "turned/result"
    assert context.ran.index("turned/result") < context.ran.index("turned/P1/0000")
    kinds = {row.get("quantity") for table, row in context.rows if table == "records"}
    assert {"pitch of the beam", "offset of the beam from the J4 axis"} <= kinds


async def test_the_arm_waits_where_the_turned_beam_returns() -> None:
    context = await ran(RemountContext(off_deg=lambda _number: 0.1))
    (prompt,) = (one for one in context.prompts if isinstance(one.task, MountInterferometer))
    assert prompt.motion
    # It looks for the beam then, from more than one pose: no single target says where the arm goes.
    assert prompt.target is None
    assert "looks for the beam" in prompt.text
    assert prompt.task == MountInterferometer(turned_deg=180.0)
    # Beside the question hands see the signal come back when it is turned as it should be.
    assert context.dark_before == [True]
    shown = [live for live in context.shown if live.name == "signal"]
    assert shown[0].value == 0.75
    assert context.moved_while_asked == [0]


async def test_an_interferometer_that_was_not_turned_is_named() -> None:
    context = await ran(RemountContext(off_deg=lambda number: -180.0 if number == 1 else 0.5))
    assert mounts(context) == ["mount/1", "mount/2"]
    assert "is not turned: its beam returns from" in context.warnings[0]
    assert len(points(context)) == 4 * COUNT


async def test_a_mounting_that_is_too_far_off_is_named() -> None:
    context = await ran(RemountContext(off_deg=lambda number: -9.0 if number == 1 else 0.0))
    assert mounts(context) == ["mount/1", "mount/2"]
    # A beam that is not aligned yet, 0.4 mm beside the axis, is found a tenth of a degree off.
    assert re.search(r"turned by 171\.[01]°: turn it by (9\.0|8\.9)° anticlockwise", context.warnings[0])


async def test_the_next_question_says_what_is_wrong_with_the_mounting() -> None:
    context = await ran(RemountContext(off_deg=lambda number: -9.0 if number == 1 else 0.0))
    first, second = (
        prompt.text for prompt in context.prompts if isinstance(prompt.task, MountInterferometer)
    )
    assert re.match(r"Take the interferometer off .* turned by half a turn \(180°\)", first)
    assert re.match(r"The interferometer is turned by 171\.\d°: turn it by [89]\.\d° anticlockwise", second)
    assert "by 180° against the beginning of the run" in second
    assert "half a turn" not in second


async def test_a_mounting_given_up_on_is_stated_as_it_is() -> None:
    context = RemountContext(off_deg=lambda _number: -9.0, answers={"mount/2": "no"})
    with pytest.raises(AlignmentError, match="was not turned"):
        await ran(context)
    assert re.search(r"stays turned by 171\.\d°", context.warnings[-1])
    assert context.mountings[-1] == pytest.approx(171.0, abs=0.5)


async def test_a_resume_asks_for_what_the_mounting_lacks() -> None:
    whole = await ran(RemountContext())
    before = interrupted(whole, "turned/stand")
    later = replace(before, theta40_deg=171.0, answers={"mount/1": "no"})
    with pytest.raises(AlignmentError, match="was not turned"):
        await ran(later)
    (prompt,) = (one for one in later.prompts if isinstance(one.task, MountInterferometer))
    assert re.match(
        r"The interferometer is turned by 171\.\d°: turn it by [89]\.\d° anticlockwise", prompt.text
    )
    assert re.search(r"stays turned by 171\.\d°", later.warnings[-1])


async def test_a_beam_that_returns_nowhere_is_named() -> None:
    context = RemountContext(off_deg=lambda _number: -70.0)
    with pytest.raises(
        AlignmentError, match=r"after 3 tries.*neither at the J4 angle .* nor at the one from before"
    ):
        await ran(context)
    assert mounts(context) == ["mount/1", "mount/2", "mount/3"]
    assert len(points(context)) == 2 * COUNT


async def test_whoever_cannot_turn_it_goes_on_later() -> None:
    context = RemountContext(answers={"mount/1": "no"})
    with pytest.raises(AlignmentError, match="continue with catseye resume"):
        await ran(context)
    assert len(points(context)) == 2 * COUNT
    later = RemountContext(stored=dict(context.stored), resumed=True, pose=context.pose)
    await ran(later)
    assert mounts(later) == ["mount/1"]
    assert len(points(later)) == 2 * COUNT
    assert {row["segment"] for row in points(later)} == {1}


@pytest.mark.parametrize("last", ["turned/mount", "level/1/measure", "turned/result", "turned/P1/0005"])
async def test_a_run_goes_on_wherever_the_turning_stopped(last: str) -> None:
    whole = await ran(RemountContext())
    done = dict(list(whole.stored.items())[: list(whole.stored).index(last) + 1])
    # What was turned before the interruption stays turned.
    at = replace(
        RemountContext(stored=dict(done), resumed=True),
        theta40_deg=178.75,
        offset_mm=0.4 if "result" not in str(done) else 0.0,
        pitch_mrad=0.9 if "level/1/turn" not in done else 0.0,
    )
    later = await ran(at)
    assert mounts(later) == []
    assert not set(done) & set(later.ran)
    rows = points(later)
    assert len(rows) == 2 * COUNT - sum(step.startswith("turned/P") for step in done)
    assert set(values(rows, "mount_deg")) == {later.mountings[-1]}
    assert later.mountings[-1] == pytest.approx(178.75, abs=0.05)


def interrupted(whole: RemountContext, last: str) -> RemountContext:
    """Return the bench of a run that was interrupted after a step, as it is in the end."""
    steps = list(whole.stored.items())
    return RemountContext(
        stored=dict(steps[: list(whole.stored).index(last) + 1]),
        resumed=True,
        theta40_deg=whole.theta40_deg,
        offset_mm=whole.offset_mm,
        pitch_mrad=whole.pitch_mrad,
        height_mm=whole.height_mm,
    )


@pytest.mark.parametrize("after", [(0.0, 3.0, 1.2), (0.0, 5.0, 1.6), (0.0, -2.0, -3.0)])
async def test_a_turned_beam_at_another_height_is_found_again(after: tuple[float, float, float]) -> None:
    whole = await ran(RemountContext(after=after))
    later = await ran(interrupted(whole, "turned/P1/0005"))
    assert mounts(later) == []
    assert len(points(later)) == 2 * COUNT - 6


@pytest.mark.parametrize("height_mm", [-3.0, -1.3, 1.2, 2.1])
async def test_a_beam_that_comes_back_higher_or_lower_is_found(height_mm: float) -> None:
    context = await ran(RemountContext(after=(0.4, 0.9, height_mm)))
    assert mounts(context) == ["mount/1"]
    assert context.warnings == [context.warnings[-1]]
    assert len(points(context)) == 4 * COUNT


async def test_hands_that_were_done_are_not_sent_again() -> None:
    whole = await ran(RemountContext())
    later = await ran(interrupted(whole, "turned/stand"))
    assert mounts(later) == []
    assert len(points(later)) == 2 * COUNT


async def test_hands_that_were_not_done_are_sent_again() -> None:
    whole = await ran(RemountContext())
    before = interrupted(whole, "turned/stand")
    later = await ran(RemountContext(stored=before.stored, resumed=True))
    assert mounts(later) == ["mount/1"]
    assert later.warnings == [later.warnings[-1]]
    assert len(points(later)) == 2 * COUNT


async def test_a_failed_alignment_says_how_the_interferometer_is_mounted() -> None:
    context = RemountContext(answers={"level/1": "no"})
    with pytest.raises(AlignmentError, match="did not turn the level screw"):
        await ran(context)
    assert re.search(r"stays turned by 178\.[5-9]°", context.warnings[-1])


async def test_a_return_of_another_reflector_is_not_taken_for_it() -> None:
    # As seen from where the arm stands P2 is 83.5° anticlockwise of P1: as P1 would with 186.5°.
    context = await ran(RemountContext(off_deg=lambda number: 90.0 if number == 1 else 0.0))
    assert mounts(context) == ["mount/1", "mount/2"]
    assert "another reflector answers" in context.warnings[0]
    assert len(points(context)) == 4 * COUNT


async def test_a_carried_reflector_is_asked_for_in_both_halves() -> None:
    base = small_bench()
    carried = replace(base, optics=replace(base.optics, one_reflector=True))
    context = await ran(RemountContext(), planned(base=carried))
    asked = [prompt.id for prompt in context.prompts if prompt.id.startswith("place/")]
    assert asked[:2] == ["place/P1", "place/P2"]
    assert asked[-2:] == ["place/turned/P1", "place/turned/P2"]
    assert len(points(context)) == 4 * COUNT


async def test_nothing_moves_while_the_interferometer_is_turned() -> None:
    context = await ran(RemountContext())
    assert context.moved_while_asked == [0]


async def test_an_interferometer_put_back_meanwhile_is_named() -> None:
    whole = await ran(RemountContext())
    done = dict(list(whole.stored.items())[: list(whole.stored).index("turned/P1/0005") + 1])
    back = RemountContext(stored=dict(done), resumed=True)
    with pytest.raises(AlignmentError, match=r"is not turned: .* turned before the interruption"):
        await ran(back)
    assert points(back) == []
    # It is not stated as turned any more, neither here nor by later searches.
    assert back.mountings[-1] == 0.0
    assert back.warnings == []


async def test_a_beam_that_lies_higher_is_measured_at_its_height() -> None:
    context = await ran(RemountContext(after=(0.0, 0.0, 0.4)))
    rows = points(context)
    assert set(values(rows[: 2 * COUNT], "j3_mm")) == {50.0}
    (height_mm,) = set(values(rows[2 * COUNT :], "j3_mm"))
    assert height_mm == pytest.approx(50.4, abs=0.03)
