"""Who the controller is, and what it says of itself, its module and its motors."""

import pytest

from catseye.app.engine.first_motion import require_rest
from catseye.app.errors import SafetyError
from catseye.drivers.abb import state
from catseye.drivers.abb.robot import AbbRws
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import LinkError, NotReadyError, WrongDeviceError
from catseye.simulators.abb.failing import Failing
from tests.unit.drivers.abb_rig import AWAY, Searches, rig
from tests.unit.simulators.abb.benches import BENT, abb_bench


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
        status = await one.robot.status()
        assert (status.running, status.program) == (True, "MAINMODULE")
        one.bench.controller.press("stop")
        assert not (await one.robot.status()).running


async def test_a_run_does_not_begin_beside_another_main(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        main = one.bench.controller.symbols.named("RAPID/T_ROB1/CATSABB/main")
        monkeypatch.setattr(main, "module", "MainModule")
        with pytest.raises(SafetyError, match=r"program MAINMODULE runs on the controller.*stop it"):
            await require_rest(one.robot, SystemClock(), 1.0, unwarned)


async def unwarned(text: str) -> None:
    raise AssertionError(text)


SEARCH = "POST /rw/rapid/symbols"


async def test_whose_program_runs_is_searched_once() -> None:
    async with rig() as one:
        for _ in range(3):
            assert not (await one.robot.status()).running
        assert len(one.asked(SEARCH)) == 1


async def test_a_program_that_stood_is_searched_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        assert not (await one.robot.status()).running
        one.bench.controller.press("stop")
        await one.robot.status()
        main = one.bench.controller.symbols.named("RAPID/T_ROB1/CATSABB/main")
        monkeypatch.setattr(main, "module", "MainModule")
        one.bench.controller.press("start")
        assert (await one.robot.status()).running


async def test_what_a_search_found_grows_old(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(state, "SEARCHED_S", 0.0)
    async with rig() as one:
        for _ in range(2):
            await one.robot.status()
        assert len(one.asked(SEARCH)) == 2


async def test_a_search_without_an_answer_leaves_it_unknown() -> None:
    """Whose program runs nobody knows then: it may move the arm."""
    async with rig(answer_timeout_s=0.1) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.lossy = Searches()
        for _ in range(2):
            status = await one.robot.status()
            assert (status.running, status.program) == (True, "")
        assert len(one.asked(SEARCH)) == 1


async def test_a_program_of_unknown_main_may_move() -> None:
    async with rig() as one:
        one.bench.controller.failing = Failing("symbols", carried_out=False, left=1)
        assert (await one.robot.status()).running
        one.bench.controller.press("stop")
        assert not (await one.robot.status()).running


async def test_another_controller_is_refused() -> None:
    async with abb_bench() as bench:
        robot = AbbRws.at(bench.endpoints[0].endpoint, SystemClock(), expected_model="IRB_6700")
        with pytest.raises(WrongDeviceError, match="IRB_120"):
            await robot.connect()


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


async def test_a_module_that_was_replaced_meanwhile_is_named() -> None:
    async with rig() as one:
        await one.robot.move_joints((0.5, *BENT[1:]))
        one.bench.controller.press("stop")
        one.bench.controller.program.data["cats_version"] = 7.0
        with pytest.raises(NotReadyError, match="version 7"):
            await one.robot.move_joints(AWAY)


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


def test_only_tcp_endpoints_are_taken() -> None:
    with pytest.raises(LinkError, match="tcp://host:80"):
        AbbRws.at("http://192.168.125.1", SystemClock())
