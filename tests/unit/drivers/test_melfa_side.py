"""A status connection that is lost in mid-run: the stop connection answers for it until it is back."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

import pytest

from catseye.drivers.melfa.motion import LOOK_S, VARIABLES
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.melfa.side import HEAL_PERIOD_S, PATIENCE_S
from catseye.drivers.roles.errors import LinkError
from tests.patience import until
from tests.unit.drivers.melfa_bench import QUICK, START, TARGET, Controller
from tests.unit.drivers.peers import Peer
from tests.unit.drivers.virtual_time import VirtualClock, run


@dataclass
class Moving:
    """A robot whose motion waits for its answer, on three connections."""

    robot: MelfaR3
    motion: asyncio.Task[None]
    main: Peer
    stop: Peer
    status: Peer
    hushed: asyncio.Event
    """Once set, the status connection keeps silent."""

    def said(self, peer: Peer, command: str) -> int:
        """Return how often a command came over a connection."""
        return sum(data.endswith(f";{command}\r".encode()) for data in peer.requests)


async def _refuse() -> None:
    raise LinkError("memory://status: refused")


async def _never() -> None:
    await asyncio.Event().wait()


@asynccontextmanager
async def moving() -> AsyncIterator[Moving]:
    controller = Controller()
    controller.replies["EXEC2"] = list
    controller.flags = "E0060"
    hushed = asyncio.Event()
    async with (
        Peer(controller.answer_in_order, endpoint="memory://robot") as main,
        Peer(controller.answer, endpoint="memory://stop") as stop,
        Peer(
            lambda data: [] if hushed.is_set() else controller.answer(data), endpoint="memory://status"
        ) as status,
    ):
        robot = MelfaR3(
            main.near,
            stop.near,
            VirtualClock(),
            MelfaSettings(**QUICK),
            status_transport=status.near,
            variable=VARIABLES[0],
        )
        await robot.connect()
        motion = asyncio.create_task(robot.move_joints(TARGET))
        await until(lambda: any(b"EXEC2" in data for data in main.requests))
        controller.replies["STOP"] = controller.halt
        try:
            yield Moving(robot, motion, main, stop, status, hushed)
        finally:
            motion.cancel()
            await asyncio.gather(motion, return_exceptions=True)
            await robot.close()


def test_a_lost_status_connection_is_replaced_by_the_stop_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    async def lost() -> None:
        async with moving() as m:
            monkeypatch.setattr(m.status.near, "open", _refuse)
            await m.status.near.close()
            assert await m.robot.joints() == START
            assert m.said(m.stop, "JPOSF") == 1
            assert "the stop connection serves them meanwhile" in m.robot.notes[0]

    run(lost())


def test_a_silent_status_connection_is_replaced_within_its_patience(monkeypatch: pytest.MonkeyPatch) -> None:
    async def lost() -> None:
        async with moving() as m:
            monkeypatch.setattr(m.status.near, "open", _never)
            await m.status.near.close()
            loop = asyncio.get_running_loop()
            began_s = loop.time()
            assert await m.robot.joints() == START
            assert loop.time() - began_s < PATIENCE_S + 0.1

    run(lost())


def test_a_status_connection_that_is_back_serves_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async def back() -> None:
        async with moving() as m:
            with monkeypatch.context() as patch:
                patch.setattr(m.status.near, "open", _refuse)
                await m.status.near.close()
                await m.robot.joints()
            await asyncio.sleep(2 * HEAL_PERIOD_S)
            assert m.robot.notes == ()
            before = m.said(m.stop, "JPOSF")
            await m.robot.joints()
            assert m.said(m.stop, "JPOSF") == before

    run(back())


def test_healing_a_status_connection_delays_no_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    async def stopped() -> None:
        async with moving() as m:
            monkeypatch.setattr(m.status.near, "open", _never)
            await m.status.near.close()
            await m.robot.joints()
            await asyncio.sleep(2 * HEAL_PERIOD_S)
            loop = asyncio.get_running_loop()
            began_s = loop.time()
            stopping = asyncio.create_task(m.robot.stop())
            await until(lambda: m.said(m.stop, "STOP") > 0)
            assert loop.time() == began_s
            await stopping
            assert loop.time() - began_s < 0.5

    run(stopped())


def test_a_stalled_look_delays_no_stop_of_a_cancelled_motion() -> None:
    async def cancelled() -> None:
        async with moving() as m:
            looks = m.said(m.status, "STATE")
            m.hushed.set()
            await asyncio.sleep(2 * LOOK_S)
            assert m.said(m.status, "STATE") == looks + 1
            loop = asyncio.get_running_loop()
            began_s = loop.time()
            m.motion.cancel()
            await until(lambda: all(m.said(peer, "STOP") > 0 for peer in (m.main, m.stop, m.status)))
            assert loop.time() == began_s

    run(cancelled())


def test_a_question_in_flight_at_closing_begins_no_healing() -> None:
    async def closed() -> None:
        async with moving() as m:
            before = asyncio.all_tasks()
            m.hushed.set()
            asking = asyncio.create_task(m.robot.joints())
            await until(lambda: m.said(m.status, "JPOSF") > 0)
            await m.robot.close()
            with pytest.raises(LinkError):
                await asking
            m.motion.cancel()
            await asyncio.gather(m.motion, return_exceptions=True)
            assert asyncio.all_tasks() <= before
            assert m.robot.notes == ()

    run(closed())
