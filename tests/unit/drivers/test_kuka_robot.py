"""The driver in front of the emulated controller, over real loopback sockets."""

import asyncio
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest

from catseye.app.testing.faulty import Fault, FaultyTransport
from catseye.drivers.kuka import orders
from catseye.drivers.kuka.halt import STOP_BYTES
from catseye.drivers.kuka.robot import USES, KukaVarproxy
from catseye.drivers.kuka.settings import KukaSettings
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import (
    LinkError,
    NotReadyError,
    RefusedError,
    WrongDeviceError,
)
from catseye.simulators.config import Option
from catseye.simulators.emulated_bench import EmulatedSerialBench
from catseye.simulators.kuka.variables import UnknownVariableError
from catseye.simulators.ports.lossy import Lossy
from tests.patience import until
from tests.unit.simulators.kuka.benches import UPRIGHT, kuka_bench

AWAY = (60.0, *UPRIGHT[1:])


@dataclass
class Rig:
    """A driver and the bench behind it."""

    bench: EmulatedSerialBench
    robot: KukaVarproxy
    wire: list[bytes] = field(default_factory=list)

    @property
    def a1_deg(self) -> float:
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

    async def writes(self, data: bytes) -> None:
        """Wait until something has been written."""
        await until(lambda: any(data in sent for sent in self.wire))

    async def away(self) -> "asyncio.Task[None]":
        """Begin a motion that takes seconds."""
        await self.robot.set_override(10)
        motion = asyncio.create_task(self.robot.move_joints(AWAY))
        await self.moves()
        return motion


@asynccontextmanager
async def rig(options: dict[str, Option] | None = None, **settings: Any) -> AsyncIterator[Rig]:
    async with kuka_bench(options=options) as bench:
        wire: list[bytes] = []
        robot = KukaVarproxy.at(
            bench.endpoints[0].endpoint, SystemClock(), lambda _way, data: wire.append(data), **settings
        )
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


@pytest.mark.parametrize("old", [False, True])
async def test_the_controller_is_recognised_and_asked(old: bool) -> None:
    async with rig({"old_proxy": old}) as one:
        identity = await one.robot.connect()
        assert (identity.model, identity.simulated) == ("KR210R2700 EMULATOR C4 FLR", True)
        assert identity.firmware == ("KUKAVARPROXY" if old else "C3 BRIDGE INTERFACE")
        status = await one.robot.status()
        assert (status.servo_on, status.running, status.operation_enabled) == (True, False, True)
        assert (status.teach_mode, status.override_percent, status.alarm_number) == (False, 100.0, 0)
        assert await one.robot.joints() == UPRIGHT
        assert len(await one.robot.torques()) == 6
        assert not one.asked("write")


async def test_another_robot_is_refused() -> None:
    async with kuka_bench() as bench:
        robot = KukaVarproxy.at(bench.endpoints[0].endpoint, SystemClock(), expected_model="KR6")
        with pytest.raises(WrongDeviceError, match="KR210"):
            await robot.connect()


async def test_utf16_variables_are_read_as_well() -> None:
    async with rig(encoding="utf-16") as one:
        assert await one.robot.joints() == UPRIGHT
        assert await one.robot.set_override(30) == 30.0


async def test_a_motion_ends_at_its_target() -> None:
    async with rig() as one:
        target = (2.0, -91.0, 90.0, 1.0, 30.0, -1.0)
        await one.robot.move_joints(target)
        assert await one.robot.joints() == target


async def test_steps_are_taken_from_what_is_measured() -> None:
    async with rig() as one:
        await one.robot.step_axis("A1", 0.02)
        await one.robot.step_axis("A6", -0.001)
        assert await one.robot.joints() == pytest.approx((0.02, *UPRIGHT[1:5], -0.001), abs=1e-6)
        await one.robot.step_line((0.0, 0.0, 0.5))
        assert one.asked("write CATS_SEQ") == [f"write CATS_SEQ = {number}" for number in (1, 2, 3)]


async def test_orders_survive_a_proxy_that_loses_requests() -> None:
    async with rig({"old_proxy": True, "old_proxy_loses": True}, answer_timeout_s=0.15) as one:
        await one.robot.move_joints((1.0, *UPRIGHT[1:]))
        await one.robot.step_axis("A1", 0.01)
        assert one.a1_deg == pytest.approx(1.01, abs=1e-6)
        assert one.asked("write CATS_SEQ") == ["write CATS_SEQ = 1", "write CATS_SEQ = 2"]


async def test_a_second_motion_is_refused_and_the_first_goes_on() -> None:
    async with rig() as one:
        first = asyncio.create_task(one.robot.move_joints((2.0, *UPRIGHT[1:])))
        await asyncio.sleep(0)
        with pytest.raises(NotReadyError, match="is under way, which goes on"):
            await one.robot.step_axis("A1", 0.01)
        await first
        assert one.a1_deg == pytest.approx(2.0, abs=1e-6)
        assert one.asked("write CATS_SEQ") == ["write CATS_SEQ = 1"]
        await one.robot.step_axis("A1", 0.01)


async def test_a_step_to_a_pose_is_driven_slowly() -> None:
    async with rig() as one:
        target = (0.02, *UPRIGHT[1:])
        await one.robot.step_to(target)
        assert await one.robot.joints() == pytest.approx(target, abs=1e-6)
        assert one.asked("write CATS_CMD") == ["write CATS_CMD = 4"]
        with pytest.raises(RefusedError, match="larger than"):
            await one.robot.step_to(AWAY)
        assert one.a1_deg == pytest.approx(0.02, abs=1e-6)


async def test_a_step_beyond_the_cap_moves_nothing() -> None:
    async with rig() as one:
        with pytest.raises(RefusedError, match="larger than"):
            await one.robot.step_axis("A1", 1.1)
        assert one.bench.bench.joints == UPRIGHT


@pytest.mark.parametrize(("axis", "increment"), [("A7", 0.1), ("a1", 0.1), ("A1", float("nan"))])
async def test_a_step_that_is_none_is_an_error(axis: str, increment: float) -> None:
    async with rig() as one:
        with pytest.raises(ValueError, match="step needs"):
            await one.robot.step_axis(axis, increment)


async def test_stop_overtakes_a_motion_and_is_confirmed() -> None:
    async with rig() as one:
        motion = await one.away()
        await one.robot.stop()
        stood = one.a1_deg
        assert not one.bench.bench.moving
        assert 0.0 < stood < 60.0
        assert isinstance(await failed(motion), RefusedError)
        assert (await one.robot.status()).override_percent == 0.0
        assert one.a1_deg == stood


async def test_the_next_motion_undoes_the_override_of_a_stop() -> None:
    async with rig() as one:
        motion = await one.away()
        await one.robot.stop()
        await failed(motion)
        await one.robot.step_axis("A6", 0.01)
        assert (await one.robot.status()).override_percent == 10.0


async def test_an_override_of_0_by_somebody_else_is_left() -> None:
    async with rig() as one:
        one.bench.controller.variables.write("$OV_PRO", "0")
        with pytest.raises(NotReadyError, match=r"\$OV_PRO is 0.*smartPAD"):
            await one.robot.step_axis("A1", 0.01)


async def test_an_order_held_by_an_override_of_0_stays_held() -> None:
    async with rig() as one:
        motion = await one.away()
        await one.robot.stop()
        await failed(motion)
        # The operator starts the program again, and its interrupts have missed the stop.
        one.bench.controller.program.variables |= {"CATS_SEQ": 7, "CATS_TAKEN": 7, "CATS_DONE": 6}
        before = len(one.asked("write $OV_PRO"))
        with pytest.raises(NotReadyError, match="order 7 is still under way"):
            await one.robot.step_axis("A1", 0.01)
        assert len(one.asked("write $OV_PRO")) == before


async def test_a_cancelled_motion_is_stopped() -> None:
    async with rig() as one:
        motion = await one.away()
        motion.cancel()
        assert isinstance(await failed(motion), asyncio.CancelledError)
        assert not one.bench.bench.moving
        assert one.asked("write CATS_STOP = TRUE")


async def test_a_cancellation_stops_before_connections_are_put_in_order() -> None:
    async with rig(answer_timeout_s=3.0) as one:
        motion = await one.away()
        (port,) = one.bench.reach.ports_of("robot")
        port.stalled_until_s = 1e9
        one.wire.clear()
        # A sign of life has no answer, and may not have one for long.
        await one.writes(b"CATS_BEAT")
        motion.cancel()
        async with asyncio.timeout(1.0):
            await one.writes(STOP_BYTES)
        assert not motion.done()
        port.stalled_until_s = 0.0
        await failed(motion)
        assert not one.bench.bench.moving


@pytest.mark.parametrize("name", ["CATS_TAKEN", "CATS_DONE", "$PRO_STATE"])
async def test_a_look_that_is_refused_stops_the_arm(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        motion = await one.away()
        variables = one.bench.controller.variables
        read = variables.read

        def refuse_once(asked: str) -> str:
            if asked != name:
                return read(asked)
            monkeypatch.undo()
            raise UnknownVariableError

        monkeypatch.setattr(variables, "read", refuse_once)
        assert isinstance(await failed(motion), RefusedError)
        assert one.asked("write CATS_STOP = TRUE")
        assert not one.bench.bench.moving


async def test_a_motion_survives_lost_answers_and_is_given_once() -> None:
    async with rig(answer_timeout_s=0.1) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.lossy = Lossy(0.02, 3)
        for number in range(4):
            await one.robot.step_axis("A1", 0.01)
            assert one.a1_deg == pytest.approx(0.01 * (number + 1), abs=1e-5)


async def test_nothing_moves_without_a_connection_for_stop() -> None:
    async with kuka_bench() as bench:
        # Its greeting needs two answers; then whatever it says is lost.
        silent = [Fault(at, "drop") for at in range(2, 1000)]
        first, second, third, fourth, fifth = (
            FaultyTransport(open_transport(bench.endpoints[0].endpoint), silent if use == "stop" else [])
            for use in USES
        )
        settings = KukaSettings(answer_timeout_s=0.1)
        robot = KukaVarproxy((first, second, third, fourth, fifth), SystemClock(), settings)
        try:
            await robot.connect()
            with pytest.raises(LinkError, match="stop connection"):
                await robot.step_axis("A1", 0.01)
        finally:
            await robot.close()
        assert not [e for e in bench.journal.entries("robot") if e.text.startswith("write CATS_SEQ")]
        assert bench.bench.joints == UPRIGHT


async def test_the_connection_for_stop_is_kept_alive(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(orders, "_ALIVE_S", 0.2)
    async with rig() as one:
        motion = await one.away()
        before = len(one.asked("read CATS_STOP"))
        await until(lambda: len(one.asked("read CATS_STOP")) >= before + 2 or motion.done())
        assert not motion.done()
        assert one.bench.bench.moving
        await one.robot.stop()
        assert isinstance(await failed(motion), RefusedError)


class LosesSigns(Lossy):
    """Loses the answer to the first sign of life."""

    def __init__(self) -> None:
        super().__init__(0.0, 1)
        self.lost = 0

    def passed(self, answer: bytes) -> bytes:
        if b"TRUE" not in answer or self.lost:
            return answer
        self.lost += 1
        return b""


async def test_a_lost_answer_to_a_sign_of_life_stops_nothing() -> None:
    async with rig(answer_timeout_s=1.0) as one:
        await one.robot.set_override(5)
        (port,) = one.bench.reach.ports_of("robot")
        port.lossy = lossy = LosesSigns()
        # It lasts longer than the program waits for a sign, and than the answer is waited for.
        await one.robot.move_joints((10.0, *UPRIGHT[1:]))
        assert lossy.lost == 1
        assert one.a1_deg == 10.0


async def test_a_program_that_does_not_run_is_named() -> None:
    async with rig() as one:
        one.bench.controller.press("stop")
        assert not (await one.robot.status()).operation_enabled
        with pytest.raises(NotReadyError, match="start CATSKUKA"):
            await one.robot.step_axis("A1", 0.01)
        one.bench.controller.press("start")
        one.bench.keeper.sync()
        assert one.bench.bench.joints == UPRIGHT


async def test_an_order_that_is_not_taken_is_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig(taken_timeout_s=0.05) as one:
        # It says that it runs, and waits at a message.
        monkeypatch.setattr(one.bench.controller.program, "written", lambda: None)
        with pytest.raises(NotReadyError, match="not taken order 1"):
            await one.robot.step_axis("A1", 0.01)
        monkeypatch.undo()
        one.bench.controller.program.written()
        await one.robot.step_axis("A2", 0.01)
        assert one.a1_deg == 0.0
        assert one.asked("write CATS_SEQ") == ["write CATS_SEQ = 1", "write CATS_SEQ = 2"]


async def test_a_number_that_may_still_arrive_is_not_used_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig(taken_timeout_s=0.05) as one:
        variables = one.bench.controller.program.variables
        # The proxy has acknowledged the number, and keeps it to itself.
        monkeypatch.setattr(one.bench.controller.program, "written", lambda: variables.update(CATS_SEQ=0))
        with pytest.raises(NotReadyError, match="not taken order 1"):
            await one.robot.step_axis("A1", 0.01)
        monkeypatch.undo()
        await one.robot.step_axis("A2", 0.01)
        assert one.asked("write CATS_SEQ") == ["write CATS_SEQ = 1", "write CATS_SEQ = 2"]


async def test_an_order_taken_at_the_last_moment_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig(taken_timeout_s=0.001) as one:
        variables = one.bench.controller.program.variables

        def late() -> None:
            # The driver waits no longer and takes the order back; the program has just passed its look at that.
            if variables["CATS_SEQ"] == 1 and variables["CATS_FOR"] == 0:
                variables.update(CATS_TAKEN=1, CATS_DONE=1, CATS_RESULT=0)

        monkeypatch.setattr(one.bench.controller.program, "written", late)
        await one.robot.step_axis("A1", 0.01)
        assert one.asked("write CATS_SEQ") == ["write CATS_SEQ = 1"]


async def test_a_program_of_another_version_is_named() -> None:
    async with rig() as one:
        one.bench.controller.program.variables["CATS_VERSION"] = 7
        with pytest.raises(NotReadyError, match="version 7"):
            await one.robot.step_axis("A1", 0.01)
        assert "version 7" in (await one.robot.examine()).advice[0]


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


async def test_the_drives_are_an_operators() -> None:
    async with rig() as one:
        await one.robot.servo(on=True)
        with pytest.raises(NotReadyError, match="no variable switches"):
            await one.robot.servo(on=False)


async def test_a_resting_arm_takes_no_order() -> None:
    async with rig() as one:
        text = await one.robot.rest()
        assert "CATS_STOP" in text
        assert "$OV_PRO is 100 %" in text
        assert "the drives are on" in text
        assert one.bench.controller.variables.read("CATS_STOP") == "TRUE"
        one.bench.controller.variables.write("CATS_SEQ", "9")
        assert one.bench.bench.joints == UPRIGHT


async def test_drives_of_which_nothing_is_said_are_not_called_on() -> None:
    async with rig(drives_variable="") as one:
        assert "on or off, which this controller does not say" in await one.robot.rest()


async def test_an_override_of_0_is_named_with_its_remedy() -> None:
    async with rig() as one:
        one.bench.controller.variables.write("$OV_PRO", "0")
        assert "raise it at the smartPAD" in (await one.robot.examine()).advice[0]


@pytest.mark.parametrize(("key", "teach"), [("T1", True), ("T2", True), ("AUT", False), ("EX", False)])
async def test_manual_modes_are_teach_modes(key: str, teach: bool) -> None:
    async with rig() as one:
        one.bench.controller.press(key)
        assert (await one.robot.status()).teach_mode is teach


async def test_faults_are_in_the_status() -> None:
    async with rig() as one:
        one.bench.controller.raise_alarm(5)
        status = await one.robot.status()
        assert (status.alarm_number, status.operation_enabled) == (1, False)
        assert "smartPAD" in status.alarm_text
        one.bench.controller.set_emergency_stop(on=True)
        status = await one.robot.status()
        assert (status.emergency_stop, status.servo_on) == (True, False)


async def test_what_a_controller_does_not_say_is_called_unknown() -> None:
    async with rig(drives_variable="$NONE_SUCH", message_variable="") as one:
        status = await one.robot.status()
        assert (status.servo_on, status.alarm_number) == (True, 0)
        assert "$NONE_SUCH" in one.robot.notes[0]


async def test_a_stop_that_nobody_hears_is_reported() -> None:
    async with rig(stop_timeout_s=0.3, answer_timeout_s=0.1) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.muted = True
        with pytest.raises(LinkError, match="PRESS THE EMERGENCY STOP"):
            await one.robot.stop()


def test_the_guards_bytes_are_those_of_a_stop() -> None:
    stop = b"\x01\x00\x09CATS_STOP\x00\x04TRUE"
    override = b"\x01\x00\x07$OV_PRO\x00\x010"
    assert KukaVarproxy.stop_request(KukaSettings()) == STOP_BYTES
    assert b"\xf0\x00\x00\x12" + stop + b"\xf0\x01\x00\x0d" + override == STOP_BYTES


def test_only_tcp_endpoints_are_taken() -> None:
    with pytest.raises(LinkError, match="tcp://host:7000"):
        KukaVarproxy.at("serial:///dev/ttyS0", SystemClock())
