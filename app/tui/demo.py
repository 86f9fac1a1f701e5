"""The demonstration: an emulated bench that does its day by itself, on the screens where a person would watch it."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from catseye.app.protocol.banners import SIMULATION
from catseye.app.protocol.state import ControlState
from catseye.app.tui.program import Program

if TYPE_CHECKING:
    # Set-up may be the first screen: it is painted before these are imported.
    from catseye.app.results.readiness.stages import CellStage
    from catseye.procedures.kit.procedure import Procedure

SPEED: Final = 400.0
"""Bench seconds in one real second: the job takes about a minute."""

_TITLE: Final = f"{SIMULATION} demo"
_SHOWN_S: Final = 30.0


class Demo:
    """Does what the procedures of the demonstration measure, then the work on what they have measured.

    Whoever stops one of its runs ends it.

    Args:
        app: shows the bench, which is emulated and about to be there.
    """

    def __init__(self, app: Program) -> None:
        self._app = app
        self._session = app.session
        self._engine = app.session.link.engine

    async def do(self) -> None:
        """Do everything; it ends with the first thing that does not succeed."""
        from catseye.app.protocol.procedures import on_the_way

        await self._until(self._ready)
        for procedure in on_the_way():
            if procedure.demo is not None and not await self._measure(procedure):
                self._app.notify("the demo ends here", title=_TITLE, severity="warning", timeout=_SHOWN_S)
                return
        if await self._evaluate():
            self._app.action_go("procedures")
            self._app.notify(
                "done: F7 shows its runs, F6 its results, and Enter on a stage shows what it wrote",
                title=_TITLE,
                timeout=_SHOWN_S,
            )

    def _ready(self) -> bool:
        engine = self._engine
        cell = "" if engine.snapshot is None else engine.snapshot.cell
        of_the_bench = bool(cell) and str(self._session.cell) == cell
        return of_the_bench and engine.bench_simulated is True and engine.state is ControlState.IDLE

    async def _measure(self, procedure: "Procedure") -> bool:
        """Have the engine run a procedure; return whether it came to its end."""
        from catseye.app.protocol.requests import Start

        engine, begun = self._engine, [False]
        if engine.bench_simulated is not True:
            return False
        before = None if engine.run is None else engine.run.name
        request = Start(
            procedure=procedure.name, params=list(procedure.demo or ()), speed=self._session.speed
        )

        def shown() -> None:
            begun[0] = True
            self._app.action_go("run")

        await self._app.order(request, "The demo has stopped", control=True, then=shown)
        if not begun[0]:
            return False
        # An engine that dies leaves a run that is no longer under way, and never ends.
        await self._until(
            lambda: engine.run is not None and engine.run.name != before and not engine.run.active
        )
        return (
            engine.run is not None and engine.run.ended is not None and engine.run.ended.status == "complete"
        )

    async def _evaluate(self) -> bool:
        """Do the work on stored data that asks nothing; return whether all of it was done."""
        tried: set[str] = set()
        while (stage := await self._open_work(tried)) is not None:
            tried.add(stage.name)
            self._app.notify(f"{stage.name}: {stage.text}", title=_TITLE)
            with self._session.at_work(_TITLE):
                done = await self._session.work.do(*stage.words)
            if done.code:
                self._app.show_error(f"{stage.name} failed", done.fault)
                return False
        return True

    async def _open_work(self, tried: set[str]) -> "CellStage | None":
        """Return the first stage of work on data that can be done now."""
        from catseye.app.results.readiness.stages import NO_RESULT
        from catseye.app.results.readiness.survey_document import SurveyDocument

        cell = self._session.cell
        if cell is None:
            return None
        done = await self._session.work.do(
            "procedures", "--cell", cell, "--runs", self._session.root, "--json"
        )
        stages = SurveyDocument.of_lines(done.out).stages if done.code == 0 else ()
        can_be = (stage for stage in stages if not stage.procedure and stage.state in {"next", "later"})
        return next(
            (
                stage
                for stage in can_be
                if stage.runs and not stage.asks and NO_RESULT not in stage.words and stage.name not in tried
            ),
            None,
        )

    async def _until(self, condition: Callable[[], bool]) -> None:
        while not condition():
            await self._app.changed()
