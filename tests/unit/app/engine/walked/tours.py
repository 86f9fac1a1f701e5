"""A procedure that drives from place to place, on scripted devices."""

from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from pydantic import BaseModel

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.operator import Answer
from catseye.app.engine.request import RunOutcome
from catseye.app.engine.walked.register import own_legs
from catseye.app.service.planned_walk import as_walk
from catseye.app.service.running import PlannedRun, carry_out
from catseye.app.service.walk.feed import Feed
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.records import Record, Row
from tests.unit.app.engine.fakes import FakeBench, ManualClock

FIRST: Pose = (0.0, 60.0, 50.0, 0.0)
SECOND: Pose = (30.0, 60.0, 50.0, 20.0)
ELSEWHERE: Pose = (-30.0, 60.0, 50.0, 0.0)


class NoParams(BaseModel):
    """Nothing to choose."""


@dataclass
class Tour:
    """Goes through places; where something is measured that a rehearsal does not see, to one more."""

    places: tuple[Pose, ...] = (FIRST, SECOND)
    surprise: Pose | None = None

    name = "tour"
    title = "A tour"
    needs = Needs()
    sets_up_anew: ClassVar[bool] = False
    records: ClassVar[tuple[type[Record], ...]] = ()
    params_type = NoParams

    def equipped(self, bench: Bench, params: Any) -> Bench:
        del params
        return bench

    def plan(self, bench: Bench, params: Any) -> Any:
        del bench, params
        return list(self.places)

    async def run(self, ctx: Context, plan: Any) -> None:
        for number, place in enumerate(plan):
            await ctx.step(f"p{number}", f"place {number}", partial(self._go, ctx, place))
        if self.surprise is not None and (await ctx.measure(0.0, 0.0, 1)).displacement_mm != 0.0:
            await ctx.move(self.surprise)

    async def teardown(self, ctx: Context) -> None:
        """Nothing is left to do."""

    async def _go(self, ctx: Context, place: Pose) -> Row:
        await ctx.move(place)
        return {}


class StillClock(ManualClock):
    """Time does not pass, however long anybody sleeps."""

    def advance(self, duration_s: float) -> None:
        """Stay."""


@dataclass
class TourBench:
    """A cell, its runs, and devices that are scripted."""

    folder: Path
    tour: Tour = field(default_factory=Tour)
    cell_text: str = TEMPLATE
    asked: list[Prompt] = field(default_factory=list)
    answer: str | None = None

    def __post_init__(self) -> None:
        self.fakes = FakeBench(self.folder / "runs")
        self.fakes.robot.pose = FIRST
        self.feed = Feed(StillClock())

    @property
    def root(self) -> Path:
        return self.fakes.root

    @property
    def moves(self) -> int:
        return self.fakes.robot.calls.count("move")

    def planned(self) -> PlannedRun:
        file = self.folder / "cell.toml"
        file.write_text(self.cell_text, encoding="utf-8")
        loaded = load_cell(file)
        bench, params = scara_bench_of(loaded.cell), NoParams()
        return PlannedRun(loaded, self.tour, params, bench, self.tour.plan(bench, params), "cell file", None)

    async def run(self, **options: Any) -> RunOutcome:
        """Run the procedure itself."""
        return await self._carry_out(self.planned(), **options)

    async def walk(
        self, *, resume: Path | None = None, by_itself: bool = False, **options: Any
    ) -> RunOutcome:
        """Walk it, with a key that is held all the time."""
        planned = self.planned()
        if resume is None:
            planned = as_walk(planned, self.root)
        else:
            planned = as_walk(replace(planned, resume=resume), self.root, own_legs(resume))
        assert planned.walk is not None
        # On a clock that stands still a key that was fed once is held for ever.
        planned.walk.feed = Feed(StillClock(), by_itself=by_itself)
        planned.walk.feed.feed()
        self.feed, self.walked = planned.walk.feed, planned.walk
        return await self._carry_out(planned, **options)

    async def _carry_out(self, planned: PlannedRun, **options: Any) -> RunOutcome:
        self.fakes.robot.calls.clear()
        real = not self.fakes.robot.simulated
        chosen: dict[str, Any] = {
            "arm": "lab-1" if real else None,
            "speed": 1.0 if real else 1e6,
            "install_signals": self.fakes.install,
            "answerer": self._answered,
            "observe": lambda _build: self.fakes.build,
        }
        return await carry_out(planned, self.root, self.fakes.publish, **chosen | options)

    async def _answered(self, prompt: Prompt) -> Answer | None:
        self.asked.append(prompt)
        if prompt.id == "resume/reflectors":
            return Answer("untouched", "Ada")
        return None if self.answer is None else Answer(self.answer, "Ada")
