"""Logins, sessions, proofs and mastership."""

import asyncio
import contextlib

import pytest

from catseye.drivers.abb.digest import Login
from catseye.drivers.abb.robot import USES, AbbRws
from catseye.drivers.abb.settings import AbbSettings
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import LinkError, RefusedError, WrongDeviceError
from catseye.simulators.abb.failing import Failing
from catseye.simulators.ports.lossy import Lossy
from tests.patience import until
from tests.unit.drivers.abb_rig import AWAY, STRICT, Rig, failed, rig
from tests.unit.simulators.abb.benches import BENT, abb_bench


async def test_connections_that_end_after_requests_are_renewed() -> None:
    async with rig({"requests": 7, **STRICT}) as one:
        await one.robot.move_joints((1.0, *BENT[1:]))
        assert one.j1_deg == pytest.approx(1.0, abs=1e-4)
        motion = await one.away()
        await one.robot.stop()
        await failed(motion)
        assert not one.bench.bench.moving


class LosesOne(Lossy):
    """Loses the next answer only."""

    def __init__(self) -> None:
        super().__init__(0.0, 1)
        self.lost = False

    def passed(self, answer: bytes) -> bytes:
        self.lost, lost_before = True, self.lost
        return answer if lost_before else b""


async def test_connections_that_end_count_as_no_losses() -> None:
    async with rig({"requests": 2}, answer_timeout_s=0.2) as one:
        for _ in range(12):
            await one.robot.joints()
        (port,) = one.bench.reach.ports_of("robot")
        port.lossy = LosesOne()
        assert len(await one.robot.joints()) == 6


async def test_proofs_and_sessions_that_grow_old_are_renewed() -> None:
    async with rig({"life_s": 0.2, **STRICT}, renewal_s=0.1) as one:
        await one.robot.set_override(2)
        await one.robot.move_joints((3.0, *BENT[1:]))
        assert one.j1_deg == pytest.approx(3.0, abs=1e-4)


async def test_a_wrong_password_names_the_variables() -> None:
    async with abb_bench(options={"password": "secret"}) as bench:
        robot = AbbRws.at(bench.endpoints[0].endpoint, SystemClock())
        with pytest.raises(RefusedError, match="CATSEYE_ABB_USER and CATSEYE_ABB_PASSWORD"):
            await robot.connect()


async def test_the_password_is_taken_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CATSEYE_ABB_PASSWORD", "a:\"b'ü")
    async with rig({"password": "a:\"b'ü"}) as one:
        assert len(await one.robot.joints()) == 6
        assert not any("factory" in text for text in (await one.robot.examine()).facts)


async def test_neither_proofs_nor_sessions_are_in_the_transcript() -> None:
    async with rig() as one:
        await one.robot.move_joints((0.5, *BENT[1:]))
        await one.robot.stop()
        wire = b"".join(one.wire)
        assert b"Authorization: ***" in wire
        assert b"Set-Cookie: ***" in wire
        assert not any(word in wire for word in (b"response=", b"cnonce=", b"http.session", b"robotics"))


async def test_no_error_text_holds_a_proof() -> None:
    # Long enough for a busy machine to answer while the driver connects.
    async with rig(answer_timeout_s=0.25, stop_timeout_s=1.5) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.muted = True
        with pytest.raises(LinkError) as asked:
            await one.robot.joints()
        with pytest.raises(LinkError) as stopped:
            await one.robot.stop()
        for text in (str(asked.value), str(stopped.value)):
            assert "HTTP/1.1" in text
            assert "Digest" not in text
            assert "session" not in text


@pytest.mark.parametrize("fault", ["none", "dropped", "refused", "another device"])
async def test_a_session_ends_with_its_driver(fault: str) -> None:
    async with abb_bench(options={"sessions": 1}) as bench:
        endpoint = bench.endpoints[0].endpoint
        expected = "IRB_6700" if fault == "another device" else ""
        robot = AbbRws.at(endpoint, SystemClock(), expected_model=expected)
        with contextlib.suppress(WrongDeviceError):
            await robot.connect()
        if fault == "dropped":
            for port in bench.reach.ports_of("robot"):
                port.drop()
        if fault == "refused":
            bench.controller.failing = Failing("logout", carried_out=False, left=1)
        await robot.close()
        await robot.close()
        other = AbbRws.at(endpoint, SystemClock())
        await other.connect()
        await other.close()


async def test_a_dead_controller_does_not_hold_up_the_close() -> None:
    async with rig(answer_timeout_s=0.2) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.muted = True
        begun_s = asyncio.get_running_loop().time()
        async with asyncio.timeout(1.0):
            await one.robot.close()
        assert asyncio.get_running_loop().time() - begun_s < 1.0


async def test_mastership_whose_grant_was_lost_is_released() -> None:
    async with rig(STRICT) as one:
        one.bench.controller.failing = Failing("mastership.*request", carried_out=True, left=1)
        with pytest.raises(RefusedError, match="503"):
            await one.robot.move_joints(AWAY)
        other = AbbRws.at(one.bench.endpoints[0].endpoint, SystemClock())
        await other.connect()
        await other.move_joints((0.5, *BENT[1:]))
        await other.close()


async def test_all_sessions_in_use_are_named() -> None:
    async with rig({"sessions": 1}) as one:
        other = AbbRws.at(one.bench.endpoints[0].endpoint, SystemClock())
        with pytest.raises(RefusedError, match="all sessions"):
            await other.connect()


async def forgotten(one: Rig, life_s: float) -> None:
    """Wait until the controller has forgotten sessions that were silent."""
    end_s = one.bench.keeper.sync() + 1.1 * life_s
    await until(lambda: one.bench.keeper.sync() > end_s)


async def test_sessions_in_use_after_a_restart_are_named() -> None:
    async with rig({"sessions": 1, "life_s": 0.5}) as one:
        await forgotten(one, 0.5)
        # Somebody else has begun the only session since.
        other = AbbRws.at(one.bench.endpoints[0].endpoint, SystemClock())
        await other.connect()
        with pytest.raises(RefusedError, match=r"503.*all its sessions are in use.*connect again"):
            await one.robot.joints()
        await other.close()


async def test_sessions_begun_at_once_are_all_ended() -> None:
    async with rig({"sessions": 2, "life_s": 0.5}) as one:
        await forgotten(one, 0.5)
        # Each connection asks with the session that is forgotten, and is given one of its own.
        await asyncio.gather(one.robot.joints(), one.robot.set_override(50))
        await one.robot.close()
        assert len(one.asked("GET /logout")) == 2


async def test_all_connections_share_one_session() -> None:
    async with rig({"sessions": 1}) as one:
        await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(0.5, abs=1e-4)


async def test_another_clients_mastership_is_named() -> None:
    async with rig() as one:
        other = AbbRws.at(one.bench.endpoints[0].endpoint, SystemClock())
        await other.connect()
        motion = asyncio.create_task(other.move_joints(AWAY))
        await one.moves()
        with pytest.raises(RefusedError, match="held by another client"):
            await one.robot.move_joints((1.0, *BENT[1:]))
        await one.robot.stop()
        await failed(motion)
        await other.close()


def test_nothing_stops_the_arm_without_a_login() -> None:
    assert AbbRws.stop_request(AbbSettings()) is None


def test_a_login_shows_no_password() -> None:
    assert "secret" not in repr(Login("me", "secret"))
    assert "secret" not in str([Login("me", "secret")])


async def test_a_login_may_be_given_by_a_program() -> None:
    async with abb_bench(options={"password": "other"}) as bench:
        first, second, third, fourth, fifth = (open_transport(bench.endpoints[0].endpoint) for _ in USES)
        login = Login("Default User", "other")
        robot = AbbRws((first, second, third, fourth, fifth), SystemClock(), login=login)
        try:
            assert (await robot.connect()).simulated
        finally:
            await robot.close()
