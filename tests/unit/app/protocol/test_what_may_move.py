"""Which requests may move the arm, or let bytes reach it: they wait for no engine that is silent."""

from typing import get_args

import pytest

from catseye.app.protocol.requests import (
    AnyRequest,
    Control,
    Emulate,
    HandOver,
    Hello,
    JogHold,
    JogMode,
    JogStep,
    Override,
    Plain,
    Raw,
    Reply,
    ResetAlarm,
    RestoreOverride,
    Resume,
    Send,
    Start,
    WalkFeed,
    Watch,
    may_move,
)

MAY_MOVE: list[AnyRequest] = [
    Plain(op="unhold"),
    Reply(prompt="p", text="yes"),
    Reply(prompt="p", text="no"),
    Start(procedure="warmup"),
    Start(procedure="warmup", walk=True),
    Resume(run="abc123"),
    JogMode(on=True),
    JogStep(joint="j1", by=0.1),
    JogHold(joint="j1", direction=1),
    JogHold(joint="j1", direction=-1),
    WalkFeed(on=True),
    Raw(device="robot", on=True),
    Send(device="robot", hex="00"),
]
MOVE_NOTHING: list[AnyRequest] = [
    Hello(client="c", who="w"),
    Control(),
    Control(take=False),
    HandOver(to="c"),
    Emulate(speed=1.0),
    RestoreOverride(percent=20.0),
    ResetAlarm(number=2600, text="position data outside of the range"),
    Plain(op="release"),
    Plain(op="ladder"),
    Plain(op="hold"),
    Plain(op="stop"),
    Plain(op="abort"),
    Plain(op="clear"),
    Plain(op="ping"),
    Plain(op="shutdown"),
    Override(percent=5.0),
    Watch(op="watch"),
    Watch(op="traffic", on=False),
    JogMode(on=False),
    JogHold(joint="j1", direction=0),
    WalkFeed(on=False),
    Raw(device="robot", on=False),
]


@pytest.mark.parametrize("request_", MAY_MOVE, ids=repr)
def test_may_move(request_: AnyRequest) -> None:
    assert may_move(request_)


@pytest.mark.parametrize("request_", MOVE_NOTHING, ids=repr)
def test_moves_nothing(request_: AnyRequest) -> None:
    assert not may_move(request_)


def test_the_tables_judge_every_request() -> None:
    judged = {type(request) for request in (*MAY_MOVE, *MOVE_NOTHING)}
    assert judged == set(get_args(AnyRequest))


def test_the_tables_judge_every_plain_request() -> None:
    judged = {request.op for request in (*MAY_MOVE, *MOVE_NOTHING) if isinstance(request, Plain)}
    assert judged == set(get_args(Plain.model_fields["op"].annotation))
