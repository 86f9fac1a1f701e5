"""Orders that are carried out once, whatever is lost on the way."""

import asyncio

import pytest

from catseye.drivers.roles.errors import (
    NotArrivedError,
    NotReadyError,
    RefusedError,
)
from catseye.simulators.abb.failing import Failing
from catseye.simulators.config import Option
from catseye.simulators.ports.lossy import Lossy
from tests.unit.drivers.abb_rig import AWAY, ORDER, STRICT, Searches, rig
from tests.unit.simulators.abb.benches import BENT


@pytest.mark.parametrize("options", [{}, STRICT])
async def test_a_motion_ends_at_its_target(options: dict[str, Option]) -> None:
    async with rig(options) as one:
        target = (2.0, -1.0, 3.0, 1.0, 31.0, -1.0)
        await one.robot.move_joints(target)
        assert await one.robot.joints() == pytest.approx(target, abs=1e-4)
        assert len(one.asked(ORDER)) == 1


async def test_a_second_motion_is_refused_and_the_first_goes_on() -> None:
    async with rig() as one:
        target = (2.0, *BENT[1:])
        first = asyncio.create_task(one.robot.move_joints(target))
        await asyncio.sleep(0)
        with pytest.raises(NotReadyError, match="is under way, which goes on"):
            await one.robot.move_joints(AWAY)
        await first
        assert one.j1_deg == pytest.approx(2.0, abs=1e-4)
        assert len(one.asked(ORDER)) == 1
        await one.robot.move_joints(BENT)


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


async def test_a_program_with_a_foreign_main_is_not_started(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        one.bench.controller.press("stop")
        main = one.bench.controller.symbols.named("RAPID/T_ROB1/CATSABB/main")
        monkeypatch.setattr(main, "module", "MainModule")
        with pytest.raises(NotReadyError, match="main of T_ROB1"):
            await one.robot.move_joints(AWAY)
        assert not one.asked("POST /rw/rapid/execution?action=start")


async def test_no_order_is_given_while_another_main_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        main = one.bench.controller.symbols.named("RAPID/T_ROB1/CATSABB/main")
        monkeypatch.setattr(main, "module", "MainModule")
        with pytest.raises(
            NotReadyError, match=r"MAINMODULE.*runs instead of CATSABB.*stop it at the pendant"
        ):
            await one.robot.move_joints(AWAY)
        assert not one.asked(ORDER)
        assert one.bench.controller.program.data["cats_for"] == 0.0


async def test_a_search_without_an_answer_keeps_no_order_back() -> None:
    async with rig(answer_timeout_s=0.3) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.lossy = Searches()
        await one.robot.move_joints((0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(0.5, abs=1e-4)


async def test_whose_main_runs_is_asked_before_the_first_order_only() -> None:
    async with rig() as one:
        for j1_deg in (0.1, 0.2, 0.3):
            await one.robot.move_joints((j1_deg, *BENT[1:]))
        assert len(one.asked("POST /rw/rapid/symbols")) == 1


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


async def test_a_program_started_anew_has_not_arrived() -> None:
    async with rig() as one:
        motion = asyncio.create_task(one.robot.move_joints(AWAY))
        await one.moves()
        data = one.bench.controller.program.data
        data |= {"cats_done": data["cats_taken"]}
        with pytest.raises(NotArrivedError, match="restarted"):
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
