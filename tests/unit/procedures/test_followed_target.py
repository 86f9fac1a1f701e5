"""The validation path with a tracker that follows the arm, or does not."""

import math
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field, replace

import pytest

from catseye.drivers.roles.errors import HiddenTargetError
from catseye.drivers.roles.tracker import Position
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import HiddenTargetsError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.tasks import LeadTracker
from catseye.procedures.scara.path.path_plan import PathPlan, plan_path
from catseye.procedures.scara.path.validation_path import ValidationPath
from tests.unit.procedures.benches import IdealContext, arm_xy, bench

SMALL = replace(plan_path(bench(), y_from_mm=-20.0, y_to_mm=20.0, step_mm=20.0), passes=1)
"""Six points, there and back."""


@dataclass
class Beside(IdealContext):
    """A bench whose tracker sees the arm in its own turned frame, but for some of its looks.

    Attributes:
        hidden: numbers of the looks that see nothing.
        elsewhere: numbers of the looks at a target that does not move.
        answers: of the operator, by turns; the last one for ever.
    """

    hidden: frozenset[int] = frozenset()
    elsewhere: frozenset[int] = frozenset()
    given: list[str] = field(default_factory=lambda: ["again"])
    questions: list[Prompt] = field(default_factory=list)
    looks: int = 0

    async def locate(self, settle_time_s: float, commanded_mm: tuple[float, float]) -> Position:
        assert settle_time_s >= 0.0
        assert commanded_mm == pytest.approx(arm_xy(self.pose[0], self.pose[1]))
        self.looks += 1
        if self.looks in self.hidden:
            raise HiddenTargetError("the target is not seen: look for what stands in between")
        if self.looks in self.elsewhere:
            return Position(140.0, 0.0, 0.01)
        x, y = arm_xy(self.pose[0], self.pose[1])
        c, s = math.cos(2.0), math.sin(2.0)
        return Position(c * x - s * y + 1500.0, s * x + c * y - 300.0, 0.01)

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        assert watch is None
        self.questions.append(prompt)
        return self.given.pop(0) if len(self.given) > 1 else self.given[0]


async def driven(context: Beside, plan: PathPlan = SMALL) -> Beside:
    await ValidationPath().run(context, plan)
    return context


async def test_a_hidden_target_is_asked_for_and_measured_again() -> None:
    context = await driven(Beside(hidden=frozenset({1, 4, 5})))
    assert len(context.rows) == 6
    assert [one.task for one in context.questions] == [LeadTracker(target="arm")] * 3
    assert [one.id for one in context.questions] == [
        "target/point/0/0000",
        "target/point/0/0002",
        "target/point/0/0002/2",
    ]
    assert "look for what stands in between" in context.questions[0].text


async def test_the_operator_may_end_a_run_without_target() -> None:
    context = Beside(hidden=frozenset({2}), given=["stop"])
    with pytest.raises(HiddenTargetsError, match="catseye resume"):
        await driven(context)
    assert len(context.rows) == 1


async def test_a_target_that_never_comes_back_ends_the_run() -> None:
    with pytest.raises(HiddenTargetsError, match="is not seen"):
        await driven(Beside(hidden=frozenset(range(1, 100))))


async def test_a_tracker_that_follows_something_else_is_found_out() -> None:
    context = await driven(Beside(elsewhere=frozenset({3})))
    assert len(context.rows) == 6
    (question,) = context.questions
    assert "follows another target" in question.text


async def test_the_first_point_of_a_resumed_run_is_checked() -> None:
    ended = Beside(hidden=frozenset({4}), given=["stop"])
    with pytest.raises(HiddenTargetsError, match="catseye resume"):
        await driven(ended)
    resumed = await driven(Beside(stored=ended.stored, elsewhere=frozenset({1})))
    (question,) = resumed.questions
    assert (question.id, len(resumed.rows)) == ("target/point/0/0003", 3)
    assert "follows another target" in question.text


async def test_a_wrong_target_after_a_hidden_one_is_asked_for() -> None:
    context = await driven(Beside(hidden=frozenset({3}), elsewhere=frozenset({4})))
    assert len(context.rows) == 6
    hidden, wrong = context.questions
    assert ("is not seen" in hidden.text, "follows another target" in wrong.text) == (True, True)


async def test_points_measured_to_another_target_end_the_run() -> None:
    with pytest.raises(HiddenTargetsError, match="the points before were measured to another target"):
        await driven(Beside(elsewhere=frozenset({1})))
