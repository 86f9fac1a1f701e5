"""Search: poses added until the aim holds, sightings that contradict the others, one cat's eye for all nests."""

import math
from collections import Counter
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
import pytest

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import PlanError, ReflectorNotFoundError
from catseye.procedures.kit.tasks import PlaceReflector
from catseye.procedures.scara.search.reflector_search import ReflectorSearch, SearchParams
from catseye.procedures.scara.search.search_plan import SearchPlan, plan_search
from tests.unit.procedures.benches import IdealContext, arm_xy, bench, with_optics

JOLT_DEG = 0.05
"""So wrong an aim at each pose that four of them are not enough."""

TRUE_PLACES = {"P1": (657.0, -409.0), "P2": (669.0, 12.0), "P3": (646.0, 391.0)}


@dataclass
class JoltedContext(IdealContext):
    """An arm whose J4 is wrong by a random angle at each pose.

    Attributes:
        jolt_deg: standard deviation of that angle.
        seed: of the angles.
    """

    jolt_deg: float = 0.0
    seed: int = 0
    angles: dict[tuple[float, float], float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Draw an angle for each new pose."""
        rng = np.random.default_rng(self.seed)

        def error(one: float, two: float) -> float:
            if (one, two) not in self.angles:
                self.angles[one, two] = float(rng.normal(0.0, self.jolt_deg))
            return self.angles[one, two]

        self.j4_error_deg = error


Bench = TypeVar("Bench", bound=IdealContext)


async def searched(context: Bench, plan: SearchPlan | None = None, **params: object) -> Bench:
    procedure = ReflectorSearch()
    await procedure.run(context, plan or procedure.plan(bench(), SearchParams.model_validate(params)))
    return context


def sights(context: IdealContext) -> list[str]:
    return [name for name in context.stored if name.startswith("sight/")]


def aims(context: IdealContext) -> list[dict[str, object]]:
    return [dict(data) for kind, data in context.events if kind == "aim"]


def test_further_poses_can_be_reached_from_all_others() -> None:
    plan = plan_search(bench(), poses=4, most_poses=12)
    assert len(plan.poses) == 12
    assert 12 <= len(plan.further) <= 24
    everywhere = [(p.theta1_deg, p.theta2_deg) for p in (*plan.poses, *plan.further)]
    assert len({(p.reflector.name, p.theta1_deg, p.theta2_deg) for p in (*plan.poses, *plan.further)}) == len(
        everywhere
    )
    for one in everywhere:
        for two in everywhere:
            for share in np.linspace(0.0, 1.0, 9):
                at = arm_xy(one[0] + share * (two[0] - one[0]), one[1] + share * (two[1] - one[1]))
                assert min(math.dist(at, (r.x_mm, r.y_mm)) for r in bench().reflectors) >= 50.0
    assert plan_search(bench(), poses=4, most_poses=4).further == ()
    with pytest.raises(PlanError, match="most_poses = 5 is below poses = 8"):
        plan_search(bench(), poses=8, most_poses=5)


async def test_poses_are_added_until_the_aim_holds() -> None:
    context = await searched(JoltedContext(TRUE_PLACES, 1.4, jolt_deg=JOLT_DEG, seed=3), poses=4)
    found = aims(context)
    added = [aim for aim in found if not aim["holds"]]
    assert added
    assert len(sights(context)) == 12 + len(added)
    for aim in added:
        u = aim["worst_uncertainty_mm"]
        assert isinstance(u, float)
        # The acceptance of 1 mm less the plan's own miss of 0.2 mm is left for twice the uncertainty.
        assert 2.0 * u > 0.8
        assert aim["room_mm"] == pytest.approx(0.8)
    assert found[-1]["holds"]
    last = found[-1]["worst_uncertainty_mm"]
    assert isinstance(last, float)
    assert 2.0 * last <= 0.8
    shown = [live for live in context.shown if live.name.startswith("aim at P")]
    assert len(shown) == len(added)
    assert not any(live.accepted for live in shown)


async def test_an_aim_that_holds_needs_no_more_poses() -> None:
    context = await searched(JoltedContext(TRUE_PLACES, 1.4, jolt_deg=0.001), poses=4)
    assert len(sights(context)) == 12
    assert [aim["holds"] for aim in aims(context)] == [True]


async def test_the_next_pose_is_the_one_that_helps_most() -> None:
    """Against brute force: the worst aim after each possible pose, with derivatives by differences."""
    plan = plan_search(bench(), poses=4)
    context = await searched(JoltedContext(TRUE_PLACES, 1.4, jolt_deg=JOLT_DEG, seed=3), plan)
    first = sights(context)[12]
    name = first.split("/")[1]
    order = [row for table, row in context.rows if table == "search"]
    added = (order[12]["theta1_deg"], order[12]["theta2_deg"])
    names = list(TRUE_PLACES)
    unknowns = np.array([*np.ravel(list(TRUE_PLACES.values())), math.radians(1.4)])

    def angle(at: tuple[float, float], which: int, x: np.ndarray) -> float:
        px, py = arm_xy(*at)
        return math.atan2(x[2 * which + 1] - py, x[2 * which] - px) - float(x[-1])

    def gradient(at: tuple[float, float], which: int) -> np.ndarray:
        steps = np.eye(unknowns.size) * 1e-5
        plus = np.array([angle(at, which, unknowns + step) for step in steps])
        minus = np.array([angle(at, which, unknowns - step) for step in steps])
        return np.asarray((plus - minus) / 2e-5)

    known = sum(
        np.outer(g, g)
        for pose in plan.poses
        for g in [gradient((pose.theta1_deg, pose.theta2_deg), names.index(pose.reflector.name))]
    )
    which = names.index(name)

    def worst(at: tuple[float, float]) -> float:
        extra = gradient(at, which)
        covariance = np.linalg.inv(known + np.outer(extra, extra))
        lengths = []
        for position in plan.command_positions_mm[which]:
            place = np.array(TRUE_PLACES[name])
            beam = place - position
            length = float(np.hypot(*beam))
            g = np.zeros(unknowns.size)
            g[2 * which : 2 * which + 2] = -beam[1] / length, beam[0] / length
            g[-1] = -length
            lengths.append(float(g @ covariance @ g))
        return max(lengths)

    options = [(p.theta1_deg, p.theta2_deg) for p in plan.further if p.reflector.name == name]
    assert worst(added) <= 1.02 * min(worst(option) for option in options)  # type: ignore[arg-type]  # plain numbers


async def test_running_out_of_poses_is_an_error_with_remedy() -> None:
    with pytest.raises(ReflectorNotFoundError, match=r"param poses or most_poses"):
        await searched(JoltedContext(TRUE_PLACES, 1.4, jolt_deg=0.2), poses=4, most_poses=5)


async def test_a_search_that_was_interrupted_goes_the_same_way() -> None:
    first = await searched(JoltedContext(TRUE_PLACES, 1.4, jolt_deg=JOLT_DEG, seed=3), poses=4)
    names = sights(first)
    assert len(names) > 13
    for kept in (5, 12, 13, len(names)):
        stored = {name: first.stored[name] for name in names[:kept]}
        again = JoltedContext(TRUE_PLACES, 1.4, jolt_deg=JOLT_DEG, seed=3, stored=stored, resumed=True)
        again.angles.update(first.angles)
        await searched(again, poses=4)
        ran = [name for name in again.ran if not name.startswith("counter/")]
        assert ran == [*names[kept:], "solve"]
        assert again.stored["solve"] == first.stored["solve"]


async def test_a_rarely_returning_reflector_is_given_up() -> None:
    plan = plan_search(bench())
    mine = [(p.theta1_deg, p.theta2_deg) for p in plan.poses if p.reflector.name == "P2"]

    def high(pose: Pose) -> bool:
        return pose[:2] in mine[:6]

    context = IdealContext(TRUE_PLACES, 1.4, blocked=high)
    with pytest.raises(
        ReflectorNotFoundError, match=r"found from 2 pose\(s\), 3 .* from 2 of 8 poses only: level the beam"
    ):
        await searched(context, plan)
    assert len(sights(context)) == 24


@pytest.mark.parametrize("shift_deg", [2.5, -1.0, 0.4])
async def test_a_wrong_return_is_found_out_and_left_out(shift_deg: float) -> None:
    plan = plan_search(bench())
    times = Counter((p.theta1_deg, p.theta2_deg) for p in plan.poses)
    wrong = next(p for p in plan.poses[8:] if times[p.theta1_deg, p.theta2_deg] == 1)

    def mirror(one: float, two: float) -> float:
        return shift_deg if (one, two) == (wrong.theta1_deg, wrong.theta2_deg) else 0.0

    context = await searched(IdealContext(TRUE_PLACES, 1.4, j4_error_deg=mirror), plan)
    (text,) = context.warnings
    assert text.startswith(f"reflector {wrong.reflector.name} as seen from θ1 = {wrong.theta1_deg:g}°")
    # A beam that is turned too far is hit at a J4 that is as much smaller.
    assert f"is {-shift_deg:+.2f}° (" in text
    places = context.stored["solve"]["reflectors"]
    assert isinstance(places, list)
    for place in places:
        assert isinstance(place, dict)
        x, y = float(str(place["x_mm"])), float(str(place["y_mm"]))
        assert math.dist((x, y), TRUE_PLACES[str(place["name"])]) < 0.15
        assert place["sightings"] == (7 if place["name"] == wrong.reflector.name else 8)
    assert context.stored["solve"]["left_out"] == [text]


async def test_scatter_alone_is_no_wrong_return() -> None:
    for seed in range(8):
        context = await searched(JoltedContext(TRUE_PLACES, 1.4, jolt_deg=0.015, seed=seed))
        assert context.warnings == []


async def test_one_cats_eye_is_carried_from_nest_to_nest() -> None:
    base = with_optics(bench(), one_reflector=True)
    context = IdealContext(dict(TRUE_PLACES), 1.4)

    def put(name: str) -> str:
        context.places = {name: TRUE_PLACES[name]}
        return "yes"

    context.places = {}
    context.answers = {f"place/{name}": lambda _prompt, name=name: put(name) for name in TRUE_PLACES}  # type: ignore[misc]  # bound by default
    await searched(context, plan_search(base))
    assert [prompt.id for prompt in context.prompts] == ["place/P1", "place/P2", "place/P3"]
    assert context.prompts[0].task == PlaceReflector(reflector="P1")
    # An interrupted search asks again: nobody knows where the cat's eye is now.
    stored = {name: row for name, row in context.stored.items() if name not in {"solve", "sight/P2/15"}}
    again = IdealContext({}, 1.4, stored=stored, resumed=True)
    again.places = {}

    def put_back(_prompt: Prompt) -> str:
        again.places = {"P2": TRUE_PLACES["P2"]}
        return "yes"

    again.answers = {"place/P2": put_back}
    await searched(again, plan_search(base))
    assert again.ran == ["sight/P2/15", "solve"]


async def test_an_added_pose_has_the_cats_eye_carried_back() -> None:
    base = with_optics(bench(), one_reflector=True)
    context = JoltedContext({}, 1.4, jolt_deg=JOLT_DEG, seed=3)

    class Hands(dict[str, object]):
        def get(self, key: object, _default: object = None) -> object:
            name = str(key).split("/")[1]
            context.places = {name: TRUE_PLACES[name]}
            return "yes"

    context.answers = Hands()  # type: ignore[assignment]  # answers whatever is asked
    await searched(context, plan_search(base, poses=4))
    ids = [prompt.id for prompt in context.prompts]
    assert ids[:3] == ["place/P1", "place/P2", "place/P3"]
    assert len(set(ids)) == len(ids)
    assert ids[3].endswith("/2")
