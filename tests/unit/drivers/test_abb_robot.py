"""The driver in front of the emulated controller, over real loopback sockets."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest

from catseye.drivers.abb.digest import Login
from catseye.drivers.abb.robot import USES, AbbRws
from catseye.drivers.abb.settings import AbbSettings
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import (
    LinkError,
    NotArrivedError,
    NotReadyError,
    RefusedError,
    WrongDeviceError,
)
from catseye.simulators.abb.failing import Failing
from catseye.simulators.abb.program import Result
from catseye.simulators.config import Option
from catseye.simulators.emulated_bench import EmulatedAbbBench
from catseye.simulators.ports.lossy import Lossy
from tests.unit.drivers.guards import RecordingGuard
from tests.unit.simulators.abb.benches import BENT, abb_bench

AWAY = (60.0, *BENT[1:])
STRICT: dict[str, Option] = {"strict_counts": True, "explicit_mastership": True}
"""A controller that refuses whatever it may refuse."""

STOP = "POST /rw/rapid/execution?action=stop"
ORDER = "POST /rw/rapid/symbol/data/RAPID/T_ROB1/CATSABB/cats_seq"


@dataclass
class Rig:
    """A driver and the bench behind it."""

    bench: EmulatedAbbBench
    robot: AbbRws
    wire: list[bytes] = field(default_factory=list)

    @property
    def j1_deg(self) -> float:
        return self.bench.bench.joints[0]

    def asked(self, beginning: str) -> list[str]:
        """Return the requests that begin so."""
        entries = self.bench.journal.entries("robot")
        return [e.text for e in entries if e.kind == "request" and e.text.startswith(beginning)]

    async def moves(self) -> None:
        """Wait until the arm moves."""
        while not self.bench.bench.moving:
            await asyncio.sleep(0)
            self.bench.keeper.sync()

    async def away(self) -> "asyncio.Task[None]":
        """Begin a motion that takes seconds."""
        await self.robot.set_override(5)
        motion = asyncio.create_task(self.robot.move_joints(AWAY))
        await self.moves()
        return motion


@asynccontextmanager
async def rig(options: dict[str, Option] | None = None, **settings: Any) -> AsyncIterator[Rig]:
    wire: list[bytes] = []
    async with abb_bench(options=options) as bench:
        endpoint = bench.endpoints[0].endpoint
        robot = AbbRws.at(endpoint, SystemClock(), lambda _way, data: wire.append(data), **settings)
        try:
            await robot.connect()
            yield Rig(bench, robot, wire)
        finally:
            await robot.close()


async def failed(motion: Awaitable[None]) -> BaseException:
    """Return why a motion failed."""
    (error,) = await asyncio.gather(motion, return_exceptions=True)
    assert isinstance(error, BaseException)
    return error


async def test_the_controller_is_recognised_and_asked() -> None:
    async with rig() as one:
        identity = await one.robot.connect()
        assert (identity.model, identity.simulated) == ("IRB_120_EMULATOR", True)
        assert identity.firmware.startswith("RobotWare 6")
        status = await one.robot.status()
        assert (status.servo_on, status.running, status.operation_enabled) == (True, False, True)
        assert (status.teach_mode, status.override_percent, status.alarm_number) == (False, 100.0, 0)
        assert status.program == "CATSABB"
        assert await one.robot.joints() == pytest.approx(BENT, abs=1e-4)
        assert {text.partition("?")[0] for text in one.asked("POST")} == {"POST /rw/rapid/symbols"}


async def test_another_program_that_runs_may_move(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        main = one.bench.controller.symbols.named("RAPID/T_ROB1/CATSABB/main")
        monkeypatch.setattr(main, "module", "MainModule")
        assert (await one.robot.status()).running
        one.bench.controller.press("stop")
        assert not (await one.robot.status()).running


async def test_another_controller_is_refused() -> None:
    async with abb_bench() as bench:
        robot = AbbRws.at(bench.endpoints[0].endpoint, SystemClock(), expected_model="IRB_6700")
        with pytest.raises(WrongDeviceError, match="IRB_120"):
            await robot.connect()


@pytest.mark.parametrize("options", [{}, STRICT])
async def test_a_motion_ends_at_its_target(options: dict[str, Option]) -> None:
    async with rig(options) as one:
        target = (2.0, -1.0, 3.0, 1.0, 31.0, -1.0)
        await one.robot.move_joints(target)
        assert await one.robot.joints() == pytest.approx(target, abs=1e-4)
        assert len(one.asked(ORDER)) == 1


@pytest.mark.parametrize("options", [{}, STRICT])
async def test_stop_overtakes_a_motion_and_the_next_starts(options: dict[str, Option]) -> None:
    async with rig(options) as one:
        motion = await one.away()
        await one.robot.stop()
        stood = one.j1_deg
        assert not one.bench.bench.moving
        assert 0.0 < stood < 60.0
        assert isinstance(await failed(motion), RefusedError)
        assert one.j1_deg == stood
        await one.robot.move_joints((stood + 0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(stood + 0.5, abs=1e-4)


async def test_a_cancelled_motion_is_stopped() -> None:
    async with rig() as one:
        motion = await one.away()
        motion.cancel()
        assert isinstance(await failed(motion), asyncio.CancelledError)
        assert not one.bench.bench.moving
        assert one.asked("POST /rw/rapid/execution?action=stop")


async def test_a_cancellation_stops_before_connections_are_put_in_order() -> None:
    async with rig() as one:
        motion = await one.away()
        before = len(one.asked(""))
        motion.cancel()
        await failed(motion)
        later = one.asked("")[before:]
        stop = next(k for k, text in enumerate(later) if "action=stop" in text)
        assert stop < next(k for k, text in enumerate(later) if "action=release" in text)


@pytest.mark.parametrize("refused", ["^GET .*execution", "^GET .*cats_taken", "^GET .*cats_done"])
async def test_a_look_that_is_refused_stops_the_arm(refused: str) -> None:
    async with rig() as one:
        motion = await one.away()
        one.bench.controller.failing = Failing(refused, carried_out=False, left=1)
        assert isinstance(await failed(motion), RefusedError)
        assert one.asked(STOP)
        assert not one.bench.bench.moving
        assert one.bench.controller.program.data["cats_result"] == Result.UNDER_WAY


async def test_no_sign_of_life_is_given_once_a_stop_begins() -> None:
    async with rig(stop_timeout_s=1.5) as one:
        motion = await one.away()
        began_s = one.bench.bench.time_s
        one.bench.controller.failing = Failing(
            "action=stop|^GET .*execution", carried_out=False, left=100_000
        )
        assert isinstance(await failed(motion), RefusedError)
        assert one.bench.controller.program.data["cats_result"] == Result.NO_HEARTBEAT
        assert one.bench.bench.standstill_s - began_s < 1.0


async def test_an_order_that_is_answered_with_an_error_is_followed() -> None:
    async with rig() as one:
        one.bench.controller.failing = Failing("^POST .*cats_seq", carried_out=True, left=1)
        await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(0.5, abs=1e-4)
        assert len(one.asked(ORDER)) == 1


async def test_an_order_that_fails_is_taken_back() -> None:
    async with rig() as one:
        one.bench.controller.failing = Failing("^POST .*cats_seq", carried_out=False, left=1)
        with pytest.raises(RefusedError, match="503"):
            await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.bench.controller.program.data["cats_for"] == 0.0
        assert one.j1_deg == 0.0


async def test_an_order_of_which_nothing_is_known_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        await one.robot.set_override(5)
        controller, written = one.bench.controller, one.bench.controller.program.written

        def begin() -> None:
            if controller.program.data["cats_seq"] == 1.0:
                controller.failing = Failing("^GET .*cats_seq", carried_out=False, left=1)
            written()

        monkeypatch.setattr(controller.program, "written", begin)
        controller.failing = Failing("^POST .*cats_seq", carried_out=True, left=1)
        assert isinstance(await failed(one.robot.move_joints(AWAY)), RefusedError)
        assert one.asked(STOP)
        assert not one.bench.bench.moving


async def test_a_start_that_is_answered_with_an_error_is_followed() -> None:
    async with rig() as one:
        one.bench.controller.press("stop")
        one.bench.controller.failing = Failing("action=start", carried_out=True, left=1)
        await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(0.5, abs=1e-4)


async def test_a_motion_survives_lost_answers_and_is_given_once() -> None:
    async with rig(answer_timeout_s=0.15) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.lossy = Lossy(0.02, 3)
        for number in range(3):
            await one.robot.move_joints((0.2 * (number + 1), *BENT[1:]))
            assert one.j1_deg == pytest.approx(0.2 * (number + 1), abs=1e-4)
        orders = one.asked(ORDER)
        assert len(orders) == len(set(orders))


async def test_connections_that_end_after_requests_are_renewed() -> None:
    async with rig({"requests": 7, **STRICT}) as one:
        await one.robot.move_joints((1.0, *BENT[1:]))
        assert one.j1_deg == pytest.approx(1.0, abs=1e-4)
        motion = await one.away()
        await one.robot.stop()
        await failed(motion)
        assert not one.bench.bench.moving


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
    async with rig(answer_timeout_s=0.05, stop_timeout_s=0.3) as one:
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


async def test_four_connections_share_one_session() -> None:
    async with rig({"sessions": 1}) as one:
        await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(0.5, abs=1e-4)


async def test_a_module_that_is_not_loaded_is_named() -> None:
    async with rig(task="T_ROB2") as one:
        assert not (await one.robot.status()).operation_enabled
        with pytest.raises(NotReadyError, match=r"load CATSABB\.mod into the task T_ROB2"):
            await one.robot.move_joints(AWAY)
        assert "not loaded" in (await one.robot.examine()).advice[0]


async def test_a_module_of_another_version_is_named() -> None:
    async with rig() as one:
        one.bench.controller.program.data["cats_version"] = 7.0
        with pytest.raises(NotReadyError, match="version 7"):
            await one.robot.move_joints(AWAY)
        assert "version 7" in (await one.robot.examine()).advice[0]


async def test_a_program_with_a_foreign_main_is_not_started(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        one.bench.controller.press("stop")
        main = one.bench.controller.symbols.named("RAPID/T_ROB1/CATSABB/main")
        monkeypatch.setattr(main, "module", "MainModule")
        with pytest.raises(NotReadyError, match="main of T_ROB1"):
            await one.robot.move_joints(AWAY)
        assert not one.asked("POST /rw/rapid/execution?action=start")


async def test_a_program_that_begins_late_swallows_no_order(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        one.bench.controller.press("stop")
        program, bench = one.bench.controller.program, one.bench.bench
        start, written = program.start, program.written

        def begin() -> None:
            monkeypatch.setattr(program, "written", written)
            start()

        def start_late() -> None:
            program.running = True
            bench.call_at(bench.time_s + 0.5, begin)

        monkeypatch.setattr(program, "start", start_late)
        monkeypatch.setattr(program, "written", lambda: None)
        await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(0.5, abs=1e-4)


async def test_a_stop_during_the_start_is_called_so(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        one.bench.controller.press("stop")
        program, robot = one.bench.controller.program, one.robot
        stops: list[asyncio.Task[None]] = []

        def marked() -> None:
            # The number that marks the start is written: the next request is the reset.
            if not stops:
                stops.append(asyncio.create_task(robot.stop()))

        monkeypatch.setattr(program, "written", marked)
        with pytest.raises(RefusedError, match="a stop overtook") as caught:
            await robot.move_joints(AWAY)
        assert not isinstance(caught.value, NotReadyError)
        await stops[0]


async def test_a_program_started_anew_has_not_arrived() -> None:
    async with rig() as one:
        motion = asyncio.create_task(one.robot.move_joints(AWAY))
        await one.moves()
        data = one.bench.controller.program.data
        data |= {"cats_done": data["cats_taken"]}
        with pytest.raises(NotArrivedError, match="started anew"):
            await motion
        assert one.asked("POST /rw/rapid/execution?action=stop")


async def test_numbers_of_orders_fit_into_six_digits() -> None:
    async with rig() as one:
        data = one.bench.controller.program.data
        for name in ("cats_seq", "cats_taken", "cats_done"):
            data[name] = 999_999.0
        await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(0.5, abs=1e-4)
        assert data["cats_done"] == 1.0


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


async def test_an_operators_stop_ends_the_motion_with_advice() -> None:
    async with rig() as one:
        motion = await one.away()
        one.bench.controller.press("stop")
        error = await failed(motion)
        assert isinstance(error, NotReadyError)
        assert "stands" in str(error)


async def test_the_arm_stops_when_the_heartbeat_ends() -> None:
    async with rig() as one:
        motion = await one.away()
        # The process is gone: nothing closes anything, nothing says STOP.
        for port in one.bench.reach.ports_of("robot"):
            port.drop()
            port.stalled_until_s = 1e9
        began_s = one.bench.bench.time_s
        while one.bench.bench.moving:
            await asyncio.sleep(0)
            one.bench.keeper.sync()
        assert one.bench.bench.time_s - began_s < 0.7
        motion.cancel()
        for port in one.bench.reach.ports_of("robot"):
            port.stalled_until_s = 0.0
        await failed(motion)


async def test_the_motors_are_switched() -> None:
    async with rig() as one:
        await one.robot.servo(on=False)
        assert not one.bench.controller.servo_on
        await one.robot.servo(on=True)
        await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(0.5, abs=1e-4)


async def test_motors_that_stay_off_are_said_with_the_state() -> None:
    async with rig() as one:
        one.bench.controller.press("guard")
        with pytest.raises(NotReadyError, match="guardstop"):
            await one.robot.servo(on=True)


@pytest.mark.parametrize(
    ("key", "teach", "alarm"), [("MANR", True, 0), ("MANF", True, 0), ("guard", False, 2), ("AUTO", False, 0)]
)
async def test_modes_and_safeguards_are_in_the_status(key: str, teach: bool, alarm: int) -> None:
    async with rig() as one:
        one.bench.controller.press(key)
        status = await one.robot.status()
        assert (status.teach_mode, status.alarm_number) == (teach, alarm)


async def test_faults_are_in_the_status() -> None:
    async with rig() as one:
        one.bench.controller.set_emergency_stop(on=True)
        status = await one.robot.status()
        assert (status.emergency_stop, status.servo_on) == (True, False)
        one.bench.controller.raise_alarm(5)
        status = await one.robot.status()
        assert status.alarm_number == 1
        assert "event log" in status.alarm_text


async def test_a_stop_that_nobody_hears_is_reported() -> None:
    async with rig(stop_timeout_s=0.3, answer_timeout_s=0.1) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.muted = True
        with pytest.raises(LinkError, match="PRESS THE EMERGENCY STOP"):
            await one.robot.stop()


@pytest.mark.parametrize("options", [{}, STRICT])
async def test_the_guards_bytes_stop_the_arm_at_any_moment(options: dict[str, Option]) -> None:
    guard = RecordingGuard()
    async with abb_bench(options=options) as bench:
        endpoint = bench.endpoints[0].endpoint
        robot = AbbRws.at(endpoint, SystemClock(), guard=guard, renewal_s=0.05)
        await robot.connect()
        one = Rig(bench, robot)
        try:
            motion = await one.away()
            await asyncio.sleep(0.2)
            assert guard.names == {"stop"}
            guard.write_stop("stop")
            while bench.bench.moving:
                await asyncio.sleep(0)
                bench.keeper.sync()
            assert 0.0 < one.j1_deg < 60.0
            assert isinstance(await failed(motion), NotReadyError)
        finally:
            await robot.close()
        assert not guard.names


async def test_the_guards_bytes_release_mastership_of_a_dead_program() -> None:
    guard = RecordingGuard()
    async with abb_bench(options=STRICT) as bench:
        endpoint = bench.endpoints[0].endpoint
        dead, other = (AbbRws.at(endpoint, SystemClock(), guard=one) for one in (guard, None))
        one = Rig(bench, dead)
        try:
            await dead.connect()
            await other.connect()
            motion = await one.away()
            guard.write_stop("stop")
            await failed(motion)
            # Signs of life come on a connection of their own, whenever they are due.
            asked = [text for text in one.asked("POST /rw/") if "cats_beat" not in text]
            stop = next(at for at, text in enumerate(asked) if "execution?action=stop" in text)
            assert "mastership/rapid?action=release" in asked[stop + 1]
            await other.set_override(50)
            await other.move_joints(BENT)
        finally:
            await dead.close()
            await other.close()


def test_nothing_stops_the_arm_without_a_login() -> None:
    assert AbbRws.stop_request(AbbSettings()) is None


def test_a_login_shows_no_password() -> None:
    assert "secret" not in repr(Login("me", "secret"))
    assert "secret" not in str([Login("me", "secret")])


def test_only_tcp_endpoints_are_taken() -> None:
    with pytest.raises(LinkError, match="tcp://host:80"):
        AbbRws.at("http://192.168.125.1", SystemClock())


async def test_a_login_may_be_given_by_a_program() -> None:
    async with abb_bench(options={"password": "other"}) as bench:
        first, second, third, fourth = (open_transport(bench.endpoints[0].endpoint) for _ in USES)
        login = Login("Default User", "other")
        robot = AbbRws((first, second, third, fourth), SystemClock(), login=login)
        try:
            assert (await robot.connect()).simulated
        finally:
            await robot.close()
