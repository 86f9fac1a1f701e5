"""Questions that lie open until somebody who may answers them."""

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.engine.host import run_procedure
from catseye.app.engine.operator import Answer
from catseye.app.engine.request import RunOutcome
from catseye.app.protocol.events import encode_event, event_of
from catseye.app.protocol.prompts import MotionAfter
from catseye.app.protocol.run_events import PromptAsked, RunEvent
from catseye.app.service.console import Console, command_of
from catseye.app.service.errors import RefusedError
from catseye.app.service.prompt_broker import PromptBroker
from catseye.app.service.questions import answer_of, hint
from catseye.app.service.run_service import RunService
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.tasks import TurnScrew
from tests.unit.app.engine.fakes import FakeBench, Script
from tests.unit.app.service.benches import ServiceBench, settled

GO = Prompt("go", "confirm", "The arm moves now.", motion=True)
HEIGHT = Prompt("height", "number", "Type the height.", unit="mm")


async def test_nobody_there_is_said_at_once() -> None:
    assert await PromptBroker(lambda: False)(GO) is None


async def test_only_the_open_question_takes_a_valid_answer() -> None:
    broker = PromptBroker(lambda: True)
    waiting = asyncio.create_task(broker(HEIGHT))
    await settled(3)
    for prompt, text, reason in [("depth", "1", "open is 'height'"), ("height", "tall", "a number in mm")]:
        with pytest.raises(RefusedError, match=reason):
            broker.answer(prompt, text, "Ada")
        assert broker.open == HEIGHT
    broker.answer("height", "12.5", "Ada")
    with pytest.raises(RefusedError, match="no question is open"):
        broker.answer("height", "13", "Ben")
    assert await waiting == Answer("12.5", "Ada")
    with pytest.raises(RefusedError, match="no question is open"):
        broker.answer("height", "13", "Ben")


def test_a_typed_path_is_no_command() -> None:
    path = Prompt("lengths", "text", "Type the path.")
    assert command_of("/bench/bar.csv", path) == ""
    assert command_of("/s", path) == "s"
    assert command_of("/bench/bar.csv", HEIGHT) == "?"
    assert command_of("/bench/bar.csv", None) == "?"


async def test_a_question_whose_time_is_over_is_no_longer_open() -> None:
    broker = PromptBroker(lambda: True)
    waiting = asyncio.create_task(broker(HEIGHT))
    await settled(3)
    waiting.cancel()
    await asyncio.gather(waiting, return_exceptions=True)
    with pytest.raises(RefusedError, match="no question is open"):
        broker.answer("height", "1", "Ada")


async def test_an_answer_may_come_before_the_engine_asks_for_it() -> None:
    broker = PromptBroker(lambda: True)
    broker.announce(HEIGHT)
    broker.answer("height", "3", "Ada")
    assert await broker(HEIGHT) == Answer("3", "Ada")


async def test_a_client_with_control_answers_and_the_run_goes_on() -> None:
    async with ServiceBench().running() as bench, bench.clients("Ada", "Ben") as (ada, ben):
        assert await bench.registry.broker(GO) is None
        await ada.take_control()
        waiting = asyncio.create_task(bench.registry.broker(GO))
        await settled(3)
        with pytest.raises(RefusedError, match="needs control"):
            await ben.answer("go", "yes")
        with pytest.raises(RefusedError, match="answer yes or no"):
            await ada.answer("go", "move")
        await ada.answer("go", "yes")
        assert await waiting == Answer("yes", f"Ada ({ada.name})")


async def test_a_question_outlives_the_client_that_was_asked() -> None:
    async with ServiceBench().running() as bench, bench.client("Ben") as ben:
        async with bench.client("Ada") as ada:
            await ada.take_control()
            waiting = asyncio.create_task(bench.registry.broker(HEIGHT))
            await settled(3)
        await settled()
        assert not waiting.done()
        await ben.take_control()
        await ben.answer("height", "7")
        assert (await waiting) == Answer("7", f"Ben ({ben.name})")


@pytest.mark.parametrize(
    ("prompt", "typed", "answer", "fault"),
    [
        (GO, "move", "yes", ""),
        (GO, " Move ", "yes", ""),
        (GO, "no", "no", ""),
        (GO, "yes", "", "type move"),
        (GO, "y", "", "type move"),
        (GO, "", "", "type"),
        (Prompt("c", "confirm", "Clear?"), "y", "yes", ""),
        (Prompt("c", "confirm", "Clear?"), "move", "", "yes or no"),
        (HEIGHT, "1.5", "1.5", ""),
        (HEIGHT, "1,5", "", "a number in mm"),
        (Prompt("c", "choice", "Which?", choices=("P1", "P2")), "P2", "P2", ""),
        (Prompt("c", "choice", "Which?", choices=("P1", "P2")), "P3", "", "P1, P2"),
        (Prompt("t", "text", "Note?"), "as found", "as found", ""),
    ],
)
def test_what_is_typed_at_a_terminal(prompt: Prompt, typed: str, answer: str, fault: str) -> None:
    found, why = answer_of(prompt, typed)
    assert found == answer
    assert (fault in why) if fault else not why
    assert hint(prompt)


def test_a_question_comes_back_whole_from_its_event() -> None:
    prompt = Prompt(
        "s",
        "choice",
        "Turn.",
        ("done", "skip"),
        timeout_s=5.0,
        task=TurnScrew(screw="stage", turns=0.5),
        motion=True,
        rests_after=("skip",),
    )
    asked = PromptAsked.of(prompt, MotionAfter(override_percent=10.0, speed_deg_s=None))
    [line] = encode_event(asked).splitlines()
    event = event_of(json.loads(line))
    assert isinstance(event, PromptAsked)
    assert event.prompt == prompt


@pytest.mark.parametrize("target", [np.array([1.0, 90.0], np.float32), [1, 90]], ids=["array", "list"])
def test_what_a_question_holds_is_converted_for_the_wire(target: Any) -> None:
    resting: Any = ["no"]
    prompt = Prompt("t", "text", "Why?", motion=True, rests_after=resting, target=target)
    asked = PromptAsked.of(prompt, MotionAfter(override_percent=10.0, speed_deg_s=None))
    assert b'"rests_after":["no"],"target":[1.0,90.0]' in encode_event(asked)


async def test_the_console_answers_commands_and_questions() -> None:
    async with ServiceBench().running() as bench:
        said: list[str] = []
        bench.registry.lease.console = "Ada"
        console = Console(bench.registry, "Ada", said.append)
        console.take("hold")
        assert bench.state() == "HOLDING"
        console.take("g")
        assert bench.state() == "EXECUTE"
        console.take("status")
        assert "h hold" in said.pop()
        waiting = asyncio.create_task(bench.registry.broker(GO))
        await settled(3)
        console.take("s")
        assert "yes or no" in said.pop()
        console.take("/h")
        assert bench.state() == "HOLDING"
        console.take("yes")
        assert "type move" in said.pop()
        console.take("move")
        assert await waiting == Answer("yes", "Ada")
        console.end()
        assert await bench.registry.broker(GO) is None
        console.take("s")
        await bench.control.halted()
        assert bench.robot.calls == ["stop"]
        assert said == []


def asking(*prompts: Prompt, answers: list[str]) -> Script:
    async def body(ctx: Context) -> None:
        for prompt in prompts:
            answers.append(await ctx.ask(prompt))

    return Script(body)


async def attended(
    bench: FakeBench, procedure: Script, act: Callable[[RunService], None]
) -> tuple[RunOutcome, RunService]:
    """Run with a service whose console acts when a question is open."""
    service = RunService("hold", "Ada", bench.root)

    def publish(event: RunEvent) -> None:
        if isinstance(event, PromptAsked):
            asyncio.get_running_loop().call_soon(act, service)

    request = bench.request(procedure, answerer=service.registry.broker, on_open=service.serve)
    publisher = service.registry.publisher(publish)
    return await run_procedure(request, bench.build, bench.clock, publisher, bench.install), service


@pytest.mark.usefixtures("runtime")
async def test_who_answered_is_stored_with_the_run(tmp_path: Path) -> None:
    bench, answers = FakeBench(tmp_path / "runs"), list[str]()

    def act(service: RunService) -> None:
        asked = service.registry.broker.open
        assert asked is not None
        service.registry.broker.answer(asked.id, "yes" if asked.kind == "confirm" else "2.5", "Ada")

    outcome, service = await attended(bench, asking(GO, HEIGHT, answers=answers), act)
    assert outcome.status == "complete"
    assert answers == ["yes", "2.5"]
    assert [(row["id"], row["who"]) for row in RunReader(outcome.path).prompts()] == [
        ("go", "Ada"),
        ("height", "Ada"),
    ]
    assert service.registry.run is None


async def test_a_safe_answer_is_taken_when_nobody_is_there(tmp_path: Path) -> None:
    bench, answers = FakeBench(tmp_path / "runs"), list[str]()
    bench.make_real()
    broker = PromptBroker(lambda: False)
    safe = Prompt("more", "choice", "Go on?", choices=("on", "stop"), safe_answer="stop")
    request = bench.request(asking(safe, answers=answers), answerer=broker, arm="lab-1")
    outcome = await run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)
    assert answers == ["stop"]
    [row] = RunReader(outcome.path).prompts()
    assert row["who"] == "safe answer, nobody was there"


async def test_a_machine_without_sockets_runs_on_and_warns(tmp_path: Path, runtime: Path) -> None:
    (runtime / "catseye").mkdir()
    (runtime / "catseye").chmod(0o777)
    bench = FakeBench(tmp_path / "runs")
    outcome, _ = await attended(bench, asking(answers=[]), lambda _service: None)
    assert outcome.status == "complete"
    warnings = [event.data["text"] for event in RunReader(outcome.path).events() if event.kind == "warning"]
    assert any("nobody can attach" in str(text) and "chmod 700" in str(text) for text in warnings)


async def test_the_snapshot_says_how_long_a_question_is_open() -> None:
    bench = ServiceBench()
    async with bench.running():
        assert bench.registry.snapshot().prompt_open_s is None
        bench.publish(
            "prompt",
            id="height",
            kind="number",
            text="Type the height.",
            choices=[],
            unit="mm",
            timeout_s=60.0,
        )
        bench.clock.advance(25.0)
        assert bench.registry.snapshot().prompt_open_s == 25.0
        bench.publish("answer", id="height", answer="3", who="Ada")
        assert bench.registry.snapshot().prompt_open_s is None
