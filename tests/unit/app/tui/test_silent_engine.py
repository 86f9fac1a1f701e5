"""RequestHandler to an engine that does not answer."""

from pathlib import Path
from typing import Any, cast

import pytest

from catseye.app.service.client import EngineClient
from catseye.app.service.errors import ServiceError
from catseye.app.tui.link import EngineLink
from tests.unit.app.engine.fakes import ManualClock


class Asked:
    """A client that notes what it is asked."""

    def __init__(self) -> None:
        self.ops: list[str] = []

    async def request(self, op: str, **_fields: Any) -> dict[str, Any]:
        self.ops.append(op)
        return {}


@pytest.fixture
def asked() -> Asked:
    return Asked()


@pytest.fixture
def link(asked: Asked, tmp_path: Path) -> EngineLink:
    link = EngineLink(tmp_path, None, ManualClock())
    link._client = cast(EngineClient, asked)  # noqa: SLF001  # as if it were connected
    link.picture.silent_since_s = 1.0
    return link


@pytest.mark.parametrize(
    ("op", "fields"),
    [
        ("answer", {"prompt": "stage/1", "text": "yes"}),
        ("unhold", {}),
        ("start", {"procedure": "open-loop"}),
        ("resume", {"run": "x"}),
        ("jog", {"on": True, "percent": 5.0}),
        ("jog-step", {"joint": "j1", "by": 1.0}),
        ("jog-hold", {"joint": "j1", "direction": -1}),
        ("send", {"device": "robot", "hex": "0d"}),
    ],
)
async def test_nothing_that_moves_the_arm_waits_there_for_it_to_wake_up(
    link: EngineLink, asked: Asked, op: str, fields: dict[str, Any]
) -> None:
    with pytest.raises(ServiceError, match=r"nothing was sent.*F12 stops"):
        await link.request(op, **fields)
    assert asked.ops == []


@pytest.mark.parametrize(
    ("op", "fields"),
    [
        ("hold", {}),
        ("jog", {"on": False}),
        ("raw", {"on": False}),
        ("jog-hold", {"joint": "j1", "direction": 0}),
    ],
)
async def test_what_ends_motion_is_sent_all_the_same(
    link: EngineLink, asked: Asked, op: str, fields: dict[str, Any]
) -> None:
    await link.request(op, **fields)
    assert asked.ops == [op]


async def test_an_engine_that_answers_again_takes_orders(link: EngineLink, asked: Asked) -> None:
    link.picture.silent_since_s = None
    await link.request("unhold")
    assert asked.ops == ["unhold"]
