"""Search by hand: the technician turns J4, the program keeps the limits and centres the beam."""

import math
from dataclasses import dataclass, field, replace
from typing import Any

import pytest

from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import ReflectorNotFoundError
from catseye.procedures.kit.live import Live
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.search.reflector_search import ReflectorSearch, SearchParams
from tests.unit.procedures.benches import IdealContext, arm_xy, bench, with_optics

TRUE_PLACES = {"P1": (657.0, -409.0), "P2": (669.0, 12.0), "P3": (646.0, 391.0)}
THETA40 = 1.4


@dataclass
class Technician(IdealContext):
    """Somebody who sees where the beam goes and turns J4 towards the reflector that is asked for.

    Attributes:
        script: answers given first, whatever the prompt; then the technician answers.
        finds: names of the reflectors that the technician can find.
    """

    script: list[str] = field(default_factory=list)
    finds: tuple[str, ...] = ("P1", "P2", "P3")

    async def ask(self, prompt: Prompt, watch: Any = None) -> str:
        """Turn towards the reflector by at most 2°, `here` when it is hit."""
        self.prompts.append(prompt)
        shown: Live = await watch()
        self.show(shown)
        if self.script:
            return self.script.pop(0)
        name = prompt.id.split("/")[1]
        if name not in self.finds:
            return "skip"
        one, two, _, four = self.pose
        x, y = arm_xy(one, two)
        px, py = TRUE_PLACES[name]
        off = math.degrees(math.atan2(py - y, px - x)) - one - two - four - THETA40
        off = (off + 180.0) % 360.0 - 180.0
        return "here" if abs(off) < 0.001 else f"{max(-2.0, min(2.0, off)):.4f}".replace("-", "−")


def technician(**values: Any) -> Technician:
    return Technician(places=dict(TRUE_PLACES), theta40_deg=THETA40, **values)


async def searched(context: Technician, base: ScaraBench | None = None, **params: object) -> Technician:
    procedure = ReflectorSearch()
    chosen = SearchParams.model_validate({"mode": "manual", "poses": 4, **params})
    await procedure.run(context, procedure.plan(base or bench(), chosen))
    return context


@pytest.mark.parametrize("auto_centre", [True, False])
async def test_a_technician_finds_the_reflectors(auto_centre: bool) -> None:
    context = await searched(technician(), auto_centre=auto_centre)
    places = context.stored["solve"]["reflectors"]
    assert isinstance(places, list)
    for place in places:
        assert isinstance(place, dict)
        found = (float(str(place["x_mm"])), float(str(place["y_mm"])))
        assert math.dist(found, TRUE_PLACES[str(place["name"])]) < 0.3
    answered_here = {prompt.id.rpartition("/")[0] for prompt in context.prompts}
    assert len(answered_here) <= 12


async def test_the_question_says_what_to_type_and_shows_the_signal() -> None:
    base = with_optics(bench(), signal_min=0.1)
    context = await searched(technician(), base)
    first = context.prompts[0]
    assert first.id == "jog/P1/0/1"
    assert first.kind == "text"
    assert first.safe_answer == "skip"
    assert first.text.startswith("Type by how many degrees J4 should turn towards P1, −2 to 2 (now at ")
    assert first.text.endswith("until the signal returns; skip leaves this pose out.")
    # What is typed turns J4.
    assert first.motion
    assert {(live.name, live.low, live.high) for live in context.shown if live.name == "signal"} == {
        ("signal", 0.1, 1.0)
    }


@pytest.mark.parametrize(
    ("answer", "complaint"),
    [
        ("2.5", "2.5° is more than 2° at a time; nothing was moved. "),
        ("-7", "-7° is more than 2° at a time; nothing was moved. "),
        ("left", "'left' is neither a number of degrees nor here or skip. "),
        ("nan", "'nan' is neither a number of degrees nor here or skip. "),
        ("", "'' is neither a number of degrees nor here or skip. "),
        ("here", "The beam does not return here (signal 0.00, 0.1 is needed). "),
    ],
)
async def test_a_wrong_answer_moves_nothing_and_is_complained_about(answer: str, complaint: str) -> None:
    base = with_optics(bench(), signal_min=0.1)
    context = technician(script=[answer, "0.5", "skip"])
    await searched(context, base)
    assert context.prompts[1].id == "jog/P1/0/2"
    assert context.prompts[1].text.startswith(complaint)
    assert not context.prompts[2].text.startswith(complaint)
    # The way to the first pose ends at the rough aim; then comes the half degree that was a proper answer.
    way = [move[3] for move in context.moves if move[:2] == context.moves[1][:2]]
    assert list(dict.fromkeys(way))[:2] == pytest.approx([way[0], way[0] + 0.5])


async def test_a_turn_beyond_the_limits_of_j4_is_refused() -> None:
    plan = ReflectorSearch().plan(bench(), SearchParams(mode="manual", poses=4))
    limit = max(pose.j4_deg for pose in plan.poses) + 0.3
    narrow = bench(j4_limits_deg=(-360.0, limit))
    context = technician(j4_limits_deg=(-360.0, limit))
    steps = iter(range(10_000))

    async def eager(prompt: Prompt, watch: Any = None) -> str:
        del watch
        context.prompts.append(prompt)
        return "1.5" if next(steps) % 2 == 0 else "skip"

    context.ask = eager  # type: ignore[method-assign]  # somebody who only ever turns one way
    with pytest.raises(ReflectorNotFoundError):
        await searched(context, narrow)
    assert any("° is outside -360…" in prompt.text for prompt in context.prompts)
    assert max(move[3] for move in context.moves) <= limit


async def test_a_pose_that_is_skipped_is_left_out() -> None:
    context = await searched(technician(script=["skip"]))
    assert "left out by the operator" in context.warnings[0]
    assert context.stored["sight/P1/00"] == {"found": False}
    blind = technician(finds=("P1", "P3"))
    del blind.places["P2"]
    with pytest.raises(ReflectorNotFoundError, match=r"P2 was found from 0 pose"):
        await searched(blind)


async def test_a_weak_signal_is_not_here() -> None:
    base = with_optics(bench(), signal_min=0.9)
    context = technician(script=["0.0001"] * 3)
    with pytest.raises(ReflectorNotFoundError):
        # The ideal beam returns with 0.75.
        await searched(replace(context, finds=()), base, auto_centre=False)
    stubborn = technician()

    async def here(prompt: Prompt, watch: Any = None) -> str:
        del watch
        stubborn.prompts.append(prompt)
        return "here" if prompt.id.endswith("/1") else "skip"

    stubborn.ask = here  # type: ignore[method-assign]  # takes whatever there is
    stubborn.theta40_deg, stubborn.places = 0.0, {r.name: (r.x_mm, r.y_mm) for r in base.reflectors}
    with pytest.raises(ReflectorNotFoundError):
        await searched(stubborn, base, auto_centre=False)
    assert "(signal 0.75, 0.9 is needed)" in stubborn.prompts[1].text
