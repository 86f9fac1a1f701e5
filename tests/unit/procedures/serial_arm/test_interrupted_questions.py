"""Runs that are stopped while they ask: the arm stands, and the question is asked anew when they go on."""

import asyncio
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from catseye.app.engine.operator import Answer
from catseye.app.exitcode import ExitCode
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.serial_arm.ballbar import BallbarTest
from catseye.procedures.serial_arm.instrument_check import CheckParams, InstrumentCheck
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.unit.procedures.serial_arm.benches import SIX, Room, carried_out
from tests.unit.procedures.serial_arm.test_ballbar import plan_of

POSES = ValidationParams(count=3, frames=True, settle_s=0.2)
PLANS: dict[str, tuple[Procedure, Callable[[], object]]] = {
    "turn/": (TrackerValidation(), lambda: TrackerValidation().plan(SIX, POSES)),
    "mount/": (BallbarTest(), plan_of),
    "reading/": (BallbarTest(), plan_of),
    "off/": (BallbarTest(), plan_of),
    "bar/": (
        InstrumentCheck(),
        lambda: InstrumentCheck().plan(SIX, CheckParams(bar_mm=1000.0, bar_places=1)),
    ),
}


class Interrupted(Room):
    """Somebody presses Ctrl-C twice at the first question of a kind, in place of an answer."""

    at = ""

    async def answer(self, prompt: Prompt) -> Answer:
        if prompt.id.startswith(self.at):
            self.asked.append(prompt)
            self.signal(signal.SIGINT)
            self.signal(signal.SIGINT)
            await asyncio.Event().wait()
        return await super().answer(prompt)


@pytest.mark.parametrize("question", PLANS)
async def test_a_run_stopped_at_a_question_asks_anew(tmp_path: Path, question: str) -> None:
    procedure, planned = PLANS[question]
    plan, room = planned(), Interrupted(tmp_path)
    room.at = question
    room.answers = {"bar/1": "skip", **{f"reading/N1/{number:04d}": "0.1" for number in range(1, 50)}}
    first = await carried_out(room, procedure, plan)
    assert (first.status, first.exit_code) == ("stopped", ExitCode.INTERRUPTED)
    assert "stop" in room.robot.calls
    assert not room.robot.state.running
    again = Room(tmp_path)
    again.robot.pose, again.answers = room.robot.pose, room.answers
    done = await carried_out(again, procedure, plan, resume=first.path)
    assert (done.status, done.text) == ("complete", "")
    assert any(prompt.id.startswith(question) for prompt in again.asked)
    assert RunReader(done.path).status == "complete"
