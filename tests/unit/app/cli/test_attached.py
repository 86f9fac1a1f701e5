"""An attached terminal: what is typed there, Ctrl-C, and how it ends."""

import asyncio
import json
import os
import signal
import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from catseye.app.cli.attached import People, Programs
from catseye.app.engine.operator import Answer
from catseye.app.errors import ReaderGoneError
from catseye.app.exitcode import ExitCode
from catseye.app.service.errors import ServiceError
from catseye.procedures.kit.context import Prompt
from tests.patience import HANG_S
from tests.unit.app.service.benches import ServiceBench, settled

GO = Prompt("go", "confirm", "The arm moves now.", motion=True)


@pytest.fixture
def keyboard(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], None]]:
    """Return what types into this process's stdin."""
    reading, writing = os.pipe()
    with os.fdopen(reading) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield lambda text: void(os.write(writing, text.encode()))
        os.close(writing)


def void(_written: int) -> None:
    """Drop a count."""


async def comes(bench: ServiceBench, state: str) -> None:
    async with asyncio.timeout(HANG_S):
        while bench.state() != state:  # noqa: ASYNC110  # the state has no event to wait for
            await asyncio.sleep(0.001)


async def test_a_person_leaves_without_disturbing_the_run_they_steered(
    keyboard: Callable[[str], None], capsys: pytest.CaptureFixture[str]
) -> None:
    async with ServiceBench().running() as bench, bench.client("Ada") as client:
        await client.take_control()
        task = asyncio.create_task(People(client, control=True).follow())
        keyboard("h\n")
        await comes(bench, "HOLDING")
        keyboard("g\n")
        await comes(bench, "EXECUTE")
        bench.publish("prompt", id="go", kind="confirm", text="The arm moves now.", motion=True)
        answer = asyncio.create_task(bench.registry.broker(GO))
        await settled()
        keyboard("yes\nh\nmove\n")
        assert await answer == Answer("yes", f"Ada ({client.name})")
        bench.publish("answer", id="go", answer="yes", who="Ada")
        await settled()
        keyboard("nonsense\nq\n")
        assert await task == ExitCode.DONE
        assert bench.registry.lease.holder is None
        assert bench.state() == "EXECUTE"
        assert bench.noted("client-lost") == []
    said = capsys.readouterr().err
    assert "type move, or no (/h holds, /s stops)" in said
    assert "answer yes or no (/h holds, /s stops)" in said
    assert "type h hold · g go on · s stop · a abort · q leave" in said


async def test_a_program_whose_reader_has_gone_ends_quietly(
    keyboard: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    del keyboard
    async with ServiceBench().running() as bench, bench.client("Ada") as client:
        task = asyncio.create_task(Programs(client, control=False).follow())
        await settled()

        def gone(_name: str, _fields: object) -> None:
            raise ReaderGoneError("stdout is closed")

        monkeypatch.setattr("catseye.app.cli.attached.write_document", gone)
        bench.publish("warning", text="anything")
        assert await task == ExitCode.READER_GONE


async def test_ctrl_c_with_control_holds_then_stops(keyboard: Callable[[str], None]) -> None:
    del keyboard
    async with ServiceBench().running() as bench, bench.client("Ada") as client:
        await client.take_control()
        task = asyncio.create_task(People(client, control=True).follow())
        await settled()
        os.kill(os.getpid(), signal.SIGINT)
        await comes(bench, "HOLDING")
        os.kill(os.getpid(), signal.SIGINT)
        await comes(bench, "STOPPED")
        bench.publish("run-ended", status="stopped", exit_code=130, text="", path="run-1", drives_on=False)
        assert await task == ExitCode.INTERRUPTED


async def test_ctrl_c_without_control_just_leaves(keyboard: Callable[[str], None]) -> None:
    del keyboard
    async with ServiceBench().running() as bench, bench.client("Ada") as client:
        task = asyncio.create_task(People(client, control=False).follow())
        await settled()
        os.kill(os.getpid(), signal.SIGINT)
        assert await task == ExitCode.INTERRUPTED
        assert bench.state() == "EXECUTE"


async def test_a_terminal_that_lost_control_does_not_ask_any_more(
    keyboard: Callable[[str], None], capsys: pytest.CaptureFixture[str]
) -> None:
    async with ServiceBench().running() as bench, bench.clients("Ada", "Ben") as (ada, ben):
        await ada.take_control()
        task = asyncio.create_task(People(ada, control=True).follow())
        await settled()
        await ben.take_control(force=True)
        await settled()
        keyboard("g\nq\n")
        assert await task == ExitCode.DONE
        assert bench.registry.lease.holder is not None
        assert bench.state() == "EXECUTE"
    assert f"control taken by force: Ben ({ben.name}) has it" in capsys.readouterr().err


async def test_a_program_gets_events_and_answers_under_its_own_numbers(
    keyboard: Callable[[str], None], capsys: pytest.CaptureFixture[str]
) -> None:
    async with ServiceBench().running() as bench, bench.client("Ada") as client:
        task = asyncio.create_task(Programs(client, control=False).follow())
        keyboard('{"id": "a", "op": "hold"}\nrubbish\n{"v": 1, "id": 7, "op": "clear"}\n{"op": "nothing"}\n')
        await comes(bench, "HOLDING")
        await settled()
        bench.publish("run-ended", status="stopped", exit_code=1, text="", path="run-1", drives_on=False)
        assert await task == 1
    lines: list[dict[str, Any]] = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert lines[0]["snapshot"]["run"] == "run-1"
    answers = {line["re"]: line["ok"] for line in lines if "re" in line}
    assert answers == {"a": True, 7: False, None: False}
    assert [line["state"] for line in lines if line.get("event") == "state"] == ["HOLDING"]
    assert lines[-1]["event"] == "run-ended"


async def test_an_engine_gone_before_the_run_ends_is_an_error(
    keyboard: Callable[[str], None],
) -> None:
    del keyboard
    async with ServiceBench().running() as bench, bench.client("Ada") as client:
        task = asyncio.create_task(People(client, control=False).follow())
        await settled()
        await bench.server.end()
        with pytest.raises(ServiceError, match="if it died: catseye resume run-1"):
            await task
