"""What only a person may let move again no job moves."""

from dataclasses import replace
from typing import Literal

import pytest

from catseye.app.protocol.run_events import RunEnded, RunEvent, StateChanged
from catseye.app.protocol.state import ControlState
from catseye.app.results.readiness.cell_runs import CellRun
from tests.unit.app.campaign.night import Effect, Night, verdicts

Status = Literal["complete", "stopped", "aborted", "failed"]

SEARCH, WARMUP = {"name": "search", "on_failure": "go-on"}, {"name": "warmup"}


def ended(status: Status, code: int, *states: ControlState) -> tuple[RunEvent, ...]:
    changes = tuple(StateChanged(t="", state=state, reason="") for state in states)
    last = RunEnded(t="", status=status, exit_code=code, text="why", path="", drives_on=False)
    return (*changes, last)


def with_warmup(night: Night) -> Night:
    words = ("run", "warmup", "--cell", "cell.toml")
    night.stages["warmup"] = replace(night.stages["search"], name="warmup", words=words)
    return night


HELD = ended(
    "stopped", 4, ControlState.EXECUTE, ControlState.HELD, ControlState.STOPPING, ControlState.STOPPED
)
DOOR = ended("stopped", 5, ControlState.EXECUTE, ControlState.UNSUSPENDING, ControlState.STOPPING)
ALARM = ended("aborted", 5, ControlState.EXECUTE, ControlState.ABORTING, ControlState.ABORTED)
OVERDUE = ended("aborted", 143, ControlState.EXECUTE, ControlState.HELD, ControlState.ABORTING)
KILLED = HELD[:2]


@pytest.mark.parametrize(
    ("said", "exit_code", "code"),
    [
        pytest.param(HELD, 4, "timeout", id="held"),
        pytest.param(DOOR, 5, "safety", id="door"),
        pytest.param(ALARM, 5, "safety", id="alarm"),
        pytest.param(OVERDUE, 143, "timeout", id="held when its time was over"),
        pytest.param(KILLED, -9, "timeout", id="held when it was killed"),
    ],
)
async def test_no_new_run_follows_one_left_to_people(
    said: tuple[RunEvent, ...], exit_code: int, code: str, night: Night
) -> None:
    night.effects["search"] = [Effect(code=exit_code, text="why", said=said)]
    verdict = await with_warmup(night).conduct(night.campaign(SEARCH, WARMUP))
    assert verdicts(verdict)["warmup"] == ("not-done", code)
    assert "only a person lets it move again: why" in verdict.stages[1].text
    assert len(night.calls) == 1


@pytest.mark.parametrize(
    "said",
    [
        ended("stopped", 4, ControlState.EXECUTE, ControlState.SUSPENDED, ControlState.STOPPING),
        ended("failed", 5, ControlState.EXECUTE, ControlState.STOPPING),
    ],
    ids=["beam lost", "nothing moved"],
)
async def test_other_ends_let_the_next_stage_begin(said: tuple[RunEvent, ...], night: Night) -> None:
    night.effects["search"] = [Effect(code=4, said=said)]
    verdict = await with_warmup(night).conduct(night.campaign(SEARCH, WARMUP))
    assert verdicts(verdict)["warmup"] == ("passed", "passed")


async def test_a_held_run_may_go_on_since_it_asks(night: Night) -> None:
    run = CellRun("20260102T030405Z_search_abcdef", "search", "stopped", 1.0, resumable=True, job="n1")

    def interrupted() -> None:
        night.runs = [run]
        night.stages["search"] = replace(night.stages["search"], words=("resume", run.name))

    def done() -> None:
        night.stages["search"] = replace(night.stages["search"], state="done", runs=(run.name,))

    night.effects = {"search": [Effect(code=4, said=HELD, then=interrupted)], "resume": [Effect(then=done)]}
    loaded = night.campaign({**SEARCH, "retries": 1, "retry_after_s": 0}, WARMUP)
    verdict = await with_warmup(night).conduct(loaded)
    assert [call[0] for call in night.calls] == ["run", "resume", "run"]
    assert verdict.verdict == "passed"
