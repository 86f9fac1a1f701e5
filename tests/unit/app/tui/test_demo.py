"""The demonstration in the interface: an emulated bench does its day by itself, and the screens follow."""

import json
from pathlib import Path
from typing import Any

from catseye.app.protocol.requests import AnyRequest, Start
from catseye.app.service.command_process import Done
from catseye.app.tui.demo import Demo
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from tests.unit.app.tui.scripted import ScriptedLink, failed, make_app, settled, work_of
from tests.unit.app.tui.scripted_bench import BENCH

CELL = Path("/bench/cell.toml")
MEASURED = ["reflector-search", "open-loop", "validation-path"]


class RunningLink(ScriptedLink):
    """An engine on which every run that is asked for begins, and ends as a test says."""

    def __init__(self, status: str = "complete", *, simulated: bool = True) -> None:
        super().__init__({"cell": str(CELL)})
        self._status = status
        self.publish("bench", **{**BENCH, "simulated": simulated})

    async def request(self, request: AnyRequest) -> None:
        """Have a run begin and end."""
        await super().request(request)
        if isinstance(request, Start):
            run = f"20261121T09000{len(self.asked)}Z_{request.procedure}_abc123"
            self.publish("run-started", procedure=request.procedure, title="", run=run)
            self.publish(
                "run-ended", status=self._status, exit_code=0, text="", path="", drives_on=False, run=run
            )


def stage(name: str, *words: str, **more: Any) -> dict[str, Any]:
    about = {"procedure": False, "state": "next", "text": "", "command": "", "runs": ["a run"]}
    return {**about, "name": name, "words": [name, *words], **more}


def survey(*stages: dict[str, Any]) -> Done:
    return Done((), 0, json.dumps({"cell": "lab-1", "stages": list(stages)}), "")


OPEN = survey(
    stage("validate", "RESULT", state="later"),
    stage("compensate", asks=[{"name": "path", "what": "", "hint": ""}]),
    stage("identify", "abc123"),
    stage("report", "abc123"),
    stage("warmup", procedure=True),
    stage("dossier", state="done"),
)


async def test_runs_are_shown_and_then_evaluated() -> None:
    link = RunningLink()
    app = make_app(link, "bench", cell=CELL)
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        work_of(app).outcomes["procedures"] = OPEN
        await Demo(app).do()
        text = await settled(app, pilot)
        assert [start.procedure for start in link.asked_for(Start)] == MEASURED
        assert all(start.arm is None for start in link.asked_for(Start))
        done = [words[0] for words in work_of(app).done if words[0] not in {"procedures", "show"}]
        # What asks for a file, waits for a result, moves the arm or is done already is left alone.
        assert done == ["identify", "report"]
        assert app.current_mode == "procedures"
        assert "F7 shows its runs" in text


async def test_a_run_that_is_stopped_ends_it() -> None:
    link = RunningLink("stopped")
    app = make_app(link, "bench", cell=CELL)
    async with app.run_test(size=(120, 40), notifications=True) as pilot:
        await Demo(app).do()
        assert "the demo ends here" in await settled(app, pilot)
        assert [start.procedure for start in link.asked_for(Start)] == MEASURED[:1]
        assert app.current_mode == "run"
        assert not any(words[0] == "identify" for words in work_of(app).done)


async def test_a_refused_start_ends_it() -> None:
    link = RunningLink()
    link.refusals["start"] = "the door is open"
    app = make_app(link, "bench", cell=CELL)
    async with app.run_test(size=(120, 40)) as pilot:
        await Demo(app).do()
        assert "the door is open" in await settled(app, pilot)
        assert isinstance(app.screen, ErrorDialog)


async def test_work_that_fails_says_why() -> None:
    app = make_app(RunningLink(), "bench", cell=CELL)
    async with app.run_test(size=(120, 40)) as pilot:
        work_of(app).outcomes["procedures"] = OPEN
        work_of(app).outcomes["identify"] = failed(1, "the distances do not determine L2")
        await Demo(app).do()
        assert "the distances do not determine L2" in await settled(app, pilot)
        assert not any(words[0] == "report" for words in work_of(app).done)


async def test_a_real_bench_is_waited_out() -> None:
    link = RunningLink(simulated=False)
    app = make_app(link, "bench", cell=CELL)
    async with app.run_test(size=(120, 40)) as pilot:
        waiting = app.keep(Demo(app).do())
        await settled(app, pilot)
        assert not waiting.done()
        assert link.asked_for(Start) == []
        # Once the emulated bench is there it begins.
        link.publish("bench", **BENCH)
        await waiting
        assert link.asked_for(Start)
