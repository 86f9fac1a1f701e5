"""Requests to an engine that does not answer."""

from pathlib import Path
from typing import Any, cast

import pytest

from catseye.app.protocol.requests import (
    AnyRequest,
    JogHold,
    JogMode,
    JogStep,
    Plain,
    Raw,
    Reply,
    Resume,
    Send,
    Start,
    WalkFeed,
)
from catseye.app.service.client import EngineClient
from catseye.app.service.errors import ServiceError
from catseye.app.tui.link import EngineLink
from tests.unit.app.engine.fakes import ManualClock


class Asked:
    """A client that notes what it is asked."""

    def __init__(self) -> None:
        self.ops: list[str] = []

    async def request(self, request: AnyRequest) -> dict[str, Any]:
        self.ops.append(request.op)
        return {}


@pytest.fixture
def asked() -> Asked:
    return Asked()


@pytest.fixture
def link(asked: Asked, tmp_path: Path) -> EngineLink:
    link = EngineLink(tmp_path, None, ManualClock())
    link._client = cast(EngineClient, asked)  # noqa: SLF001  # as if it were connected
    link.engine.silent_since_s = 1.0
    return link


@pytest.mark.parametrize(
    "request_",
    [
        Reply(prompt="stage/1", text="yes"),
        Plain(op="unhold"),
        Start(procedure="open-loop"),
        Resume(run="x"),
        JogMode(on=True),
        JogStep(joint="j1", by=1.0),
        JogHold(joint="j1", direction=-1),
        WalkFeed(),
        Raw(device="robot"),
        Send(device="robot", hex="0d"),
    ],
    ids=lambda request: request.op,
)
async def test_motion_requests_are_refused_while_the_engine_is_silent(
    link: EngineLink, asked: Asked, request_: AnyRequest
) -> None:
    with pytest.raises(ServiceError, match=r"nothing was sent.*F12 tries every way to stop the arm"):
        await link.request(request_)
    assert asked.ops == []


@pytest.mark.parametrize(
    "request_",
    [
        Plain(op="hold"),
        Plain(op="ladder"),
        JogMode(on=False),
        Raw(device="robot", on=False),
        JogHold(joint="j1", direction=0),
        WalkFeed(on=False),
    ],
    ids=lambda request: request.op,
)
async def test_what_ends_motion_is_sent_all_the_same(
    link: EngineLink, asked: Asked, request_: AnyRequest
) -> None:
    await link.request(request_)
    assert asked.ops == [request_.op]


async def test_an_engine_that_answers_again_takes_orders(link: EngineLink, asked: Asked) -> None:
    link.engine.silent_since_s = None
    await link.request(Plain(op="unhold"))
    assert asked.ops == ["unhold"]
