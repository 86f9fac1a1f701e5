"""The data link driver against a scripted controller and program."""

import asyncio
import math
from collections.abc import AsyncIterator, Iterable, Iterator
from contextlib import asynccontextmanager

import pytest

from catseye.drivers.links.guarding import Unguarded
from catseye.drivers.melfa.datalink.robot import DatalinkSettings, MelfaDatalink
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.errors import (
    LinkError,
    NotArrivedError,
    NotReadyError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.pose import Pose
from tests.patience import HANG_S, until
from tests.unit.drivers.datalink_bench import QUICK, WAY, Linked, Program, linked
from tests.unit.drivers.melfa_bench import JPOS, STATE, Controller
from tests.unit.drivers.peers import Peer, StepClock


@pytest.mark.parametrize("form", ["{:.3f}", "{:+.3f}", " {:.2f}", "{:.6E}", "{:g}"])
async def test_a_way_is_sent_and_driven_in_one_go(form: str) -> None:
    async with linked() as bench:
        bench.program.form = form
        await bench.robot.follow(WAY)
        assert bench.program.driven == [pytest.approx(target) for target in WAY]
        assert [command for _, command in bench.program.requests].count(2) == 1
        assert await bench.robot.joints() == pytest.approx(WAY[-1])


async def test_an_arrival_of_a_locked_machine_is_none() -> None:
    """Section 1.10: run bit 04. The program says that the arm is there, and it has not moved."""
    async with linked() as bench:
        bench.controller.flags = "E4060"
        with pytest.raises(NotReadyError, match="machine lock is on"):
            await bench.robot.follow(WAY)
        assert bench.program.driven == [pytest.approx(target) for target in WAY]


async def test_a_path_exceeding_the_program_buffer_is_split() -> None:
    way: list[Pose] = [(0.1 * number, 0.0, 0.0, 0.0) for number in range(1, 126)]
    driven: list[tuple[float, ...]] = []
    async with linked() as bench:

        def keep(number: int) -> str:
            driven.extend(bench.program.driven)
            assert len(bench.program.driven) <= 60
            return f"{number},2," + ",".join(map(str, bench.controller.at))

        bench.program.replies[2] = keep
        await bench.robot.follow(way)
    assert driven == [pytest.approx(target) for target in way]


async def test_a_program_of_another_version_is_not_used() -> None:
    controller = Controller()
    controller.flags = "E0060"
    program = Program(controller)
    program.version = "2"
    async with (
        Peer(controller.answer) as main,
        Peer(controller.answer) as aside,
        Peer(program.answer) as link,
    ):
        r3 = MelfaR3(main.transport, aside.transport, StepClock(), MelfaSettings.model_validate(QUICK))
        robot = MelfaDatalink(r3, link.transport, DatalinkSettings.model_validate(QUICK))
        with pytest.raises(WrongDeviceError, match=r"version 2.*needs 1"):
            await robot.connect()


async def test_a_path_is_not_resent_after_a_lost_answer() -> None:
    async with linked() as bench:
        bench.program.silent = {2}
        await bench.robot.follow(WAY)
        assert [command for _, command in bench.program.requests].count(2) == 1


async def test_a_lost_answer_to_a_way_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """The program runs on while it waits for the next request: only the joints show that the path is over."""
    monkeypatch.setattr("catseye.drivers.melfa.datalink.robot._LOOK_S", 0.005)
    async with linked(move_timeout_s=1e3) as bench:
        bench.program.silent = {2}
        async with asyncio.timeout(HANG_S):
            await bench.robot.follow(WAY)
        assert [command for _, command in bench.program.requests].count(2) == 1


async def test_a_lost_answer_with_the_arm_elsewhere_stops_it() -> None:
    async with linked() as bench:
        bench.program.silent = {2}
        bench.program.moves = False
        with pytest.raises(NotArrivedError):
            await bench.robot.follow(WAY[:1])
        assert any(b"STOP" in request for request in bench.main.requests + bench.aside.requests)


async def test_a_program_that_somebody_else_stopped_is_not_waited_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A STOP of the pendant is no alarm; STATE says that nothing runs (sheet, section 1.10)."""
    monkeypatch.setattr("catseye.drivers.melfa.datalink.robot._LOOK_S", 0.005)
    async with linked(move_timeout_s=30.0) as bench:
        bench.program.silent = {2}
        bench.program.moves = False
        bench.controller.flags = "E0000"

        def creep() -> list[str]:
            if bench.controller.flags == "E0000":
                bench.controller.at = (bench.controller.at[0] + 0.01, *bench.controller.at[1:])
            return [JPOS.format(*bench.controller.at)]

        bench.controller.replies["JPOSF"] = creep
        way = asyncio.create_task(bench.robot.follow(WAY))
        await until(lambda: any(command == 2 for _, command in bench.program.requests))
        await asyncio.sleep(0.03)
        assert not way.done()
        bench.controller.flags = "A0020"
        async with asyncio.timeout(HANG_S):
            with pytest.raises(NotArrivedError, match="program stands"):
                await way


@pytest.mark.parametrize("question", ["STATE", "JPOSF"])
async def test_a_question_refused_on_the_way_leaves_no_arm_driving(
    question: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A line that garbles bytes has the controller refuse a question with L3810."""
    monkeypatch.setattr("catseye.drivers.melfa.datalink.robot._LOOK_S", 0.005)
    async with linked(move_timeout_s=30.0) as bench:
        bench.program.silent = {2}
        bench.program.moves = False
        way = asyncio.create_task(bench.robot.follow(WAY))
        await until(lambda: any(command == 2 for _, command in bench.program.requests))
        refusals: Iterator[list[str]] = iter([["QeR381000000"]])
        bench.controller.replies[question] = lambda: next(refusals, bench.controller.usual(question))
        async with asyncio.timeout(HANG_S):
            with pytest.raises(NotArrivedError, match="refused while the arm may move"):
                await way
        assert any(b"STOP" in request for request in bench.aside.requests)


async def test_an_answer_with_another_number_is_no_answer() -> None:
    async with linked() as bench:
        bench.program.replies[3] = lambda number: f"{number + 1},3,1,2,3,4"
        with pytest.raises(ProtocolError, match="was answered by"):
            await bench.robot.joints()


async def test_what_the_program_refuses_is_reported_with_its_number() -> None:
    async with linked() as bench:
        bench.program.replies[1] = lambda number: f"{number},-2,3120,0,0,0"
        with pytest.raises(RefusedError, match="3120") as caught:
            await bench.robot.follow(WAY)
        assert caught.value.number == 3120
        assert bench.program.driven == []


async def test_miscounted_points_are_not_driven() -> None:
    async with linked() as bench:
        bench.program.replies[1] = lambda number: f"{number},1,9,0,0,0"
        with pytest.raises(ProtocolError, match="counts 9"):
            await bench.robot.follow(WAY)
        assert bench.program.driven == []


async def test_standing_elsewhere_at_the_end_is_an_error() -> None:
    async with linked() as bench:
        bench.program.replies[2] = lambda number: f"{number},2,1,1,1,1"
        with pytest.raises(NotArrivedError, match=r"J1 is at 1\.00 deg instead of 3"):
            await bench.robot.follow(WAY)


async def test_the_first_path_after_a_stop_restarts_the_program() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        assert not any(b"RUN" in request for request in bench.main.requests)
        await bench.robot.follow(WAY)
        asked = [request.decode().strip() for request in bench.main.requests]
        assert asked.index("1;1;RSTPRG") < asked.index("1;1;RUNCATSDL;1")
        assert bench.program.driven == [pytest.approx(target) for target in WAY]


async def test_a_port_refusing_after_the_start_is_retried(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with linked() as bench:
        await bench.robot.stop()
        refusals, opened = iter([LinkError("connection refused")]), bench.datalink.near.open

        async def open_late() -> None:
            for refusal in refusals:
                raise refusal
            await opened()

        monkeypatch.setattr(bench.datalink.near, "open", open_late)
        await bench.robot.follow(WAY)
        assert started(bench) == 1
        assert bench.program.driven == [pytest.approx(target) for target in WAY]


async def test_a_program_is_asked_nothing_before_it_runs() -> None:
    """What comes before its Open puts the program in alarm (sheet, section 4.1)."""
    async with linked() as bench:
        await bench.robot.stop()
        begun = False
        looks: list[int] = []

        def begin_late() -> Iterable[str]:
            nonlocal begun
            begun = True
            return ["QoK"]

        def states() -> Iterable[str]:
            if begun:
                looks.append(len(bench.program.requests))
                bench.controller.flags = "E0060" if len(looks) > 2 else "A0060"
            return bench.controller.usual("STATE")

        bench.controller.replies["RUNCATSDL;1"] = begin_late
        bench.controller.replies["STATE"] = states
        before = len(bench.program.requests)
        await bench.robot.follow(WAY)
        assert looks[:3] == [before] * 3
        assert bench.program.driven == [pytest.approx(target) for target in WAY]


async def test_a_stop_ends_waiting_for_the_port() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        before = len(bench.program.requests)
        way = asyncio.create_task(bench.robot.follow(WAY))
        await until(lambda: started(bench) == 1)
        await bench.robot.stop()
        with pytest.raises(RefusedError, match="stop overtook"):
            await way
        assert len(bench.program.requests) == before


async def test_closing_amid_a_start_leaves_the_port_closed() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        way = asyncio.create_task(bench.robot.follow(WAY))
        await until(lambda: started(bench) == 1)
        await bench.robot.close()
        with pytest.raises(LinkError):
            await way
        assert not bench.datalink.near.is_open


async def test_a_way_that_a_stop_overtakes_is_not_driven() -> None:
    async with linked() as bench:
        bench.program.silent = {1}
        way = asyncio.create_task(bench.robot.follow(WAY[:1]))
        await until(lambda: any(command == 1 for _, command in bench.program.requests))
        await bench.robot.stop()
        number = bench.program.requests[-1][0]
        await bench.datalink.say(f"{number},1,1,0,0,0\r".encode())
        with pytest.raises(RefusedError, match="stop overtook"):
            await way
        assert bench.program.driven == []


async def test_a_stop_while_restarting_the_program_is_obeyed() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        bench.controller.replies["RUNCATSDL;1"] = list
        way = asyncio.create_task(bench.robot.follow(WAY))
        await until(lambda: b"1;1;RUNCATSDL;1\r" in bench.main.requests)
        await bench.robot.stop()
        await bench.main.say(b"QoK")
        with pytest.raises(RefusedError, match="stop overtook"):
            await way
        assert bench.program.driven == []
        del bench.controller.replies["RUNCATSDL;1"]
        await bench.robot.follow(WAY)
        assert bench.main.requests.count(b"1;1;RUNCATSDL;1\r") == 2


async def test_a_program_is_not_started_behind_a_stop() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        bench.controller.replies["RSTPRG"] = list
        way = asyncio.create_task(bench.robot.follow(WAY))
        await until(lambda: b"1;1;RSTPRG\r" in bench.main.requests)
        del bench.controller.replies["RSTPRG"]
        await bench.robot.stop()
        await bench.main.say(b"QoK")
        with pytest.raises(RefusedError, match="stop overtook"):
            await way
        assert b"1;1;RUNCATSDL;1\r" not in bench.main.requests


async def test_a_lost_answer_to_the_program_reset_is_harmless() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        lost: Iterator[list[str]] = iter([[]])
        bench.controller.replies["RSTPRG"] = lambda: next(lost, ["QoK"])
        await bench.robot.follow(WAY)
        assert bench.main.requests.count(b"1;1;RUNCATSDL;1\r") == 1


def started(bench: Linked) -> int:
    """Return how often the program was started."""
    return bench.main.requests.count(b"1;1;RUNCATSDL;1\r")


def run_unanswered(bench: Linked, flags: str) -> None:
    """Have the controller start the program, or not, and the answer get lost."""

    def reply() -> Iterable[str]:
        bench.controller.flags = flags
        return []

    bench.controller.replies["RUNCATSDL;1"] = reply


async def test_a_lost_start_answer_is_harmless_once_running() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        run_unanswered(bench, "E0060")
        await bench.robot.follow(WAY)
        assert started(bench) == 1
        assert bench.program.driven == [pytest.approx(target) for target in WAY]


async def test_a_start_that_was_kept_back_is_sent_after_all() -> None:
    """The reset is answered twice, and so is the right when the connection is opened again for it."""
    async with linked() as bench:
        await bench.robot.stop()
        bench.controller.suffix = "\r"
        resets: Iterator[list[str]] = iter([["QoK\rQoK"]])
        bench.controller.replies["RSTPRG"] = lambda: next(resets, ["QoK"])
        rights: Iterator[list[str]] = iter([["QoK"], ["QoK", "QoK"]])
        bench.controller.replies["CNTLON"] = lambda: next(rights, ["QoK"])
        await bench.robot.follow(WAY)
        assert bench.main.requests.count(b"1;1;CNTLON\r") == 3
        assert started(bench) == 1
        assert bench.program.driven == [pytest.approx(target) for target in WAY]


async def test_a_program_that_does_not_run_is_not_started_twice() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        run_unanswered(bench, "A0060")
        with pytest.raises(LinkError, match="not started a second time"):
            await bench.robot.follow(WAY)
        assert started(bench) == 1
        assert bench.program.driven == []


async def test_a_lost_path_answer_leaves_the_program_running() -> None:
    async with linked() as bench:
        bench.program.silent = {2}
        await bench.robot.follow(WAY)
        bench.program.silent = set()
        before = len(bench.main.requests)
        await bench.robot.follow(WAY[:1])
        assert bench.program.driven == [pytest.approx(WAY[0])]
        asked = b"".join(bench.main.requests[before:])
        assert b"RSTPRG" not in asked
        assert b"RUN" not in asked


async def test_another_program_that_runs_is_not_reset() -> None:
    async with linked() as bench:
        await bench.robot.stop()
        bench.controller.replies["STATE"] = lambda: ["QoKOTHER.MB5" + STATE.format(flags="E0060")[3:]]
        with pytest.raises(
            NotReadyError, match="the program OTHER runs on the controller, CATSDL was not started"
        ):
            await bench.robot.follow(WAY)
        assert b"RSTPRG" not in b"".join(bench.main.requests)


class SlowGuard(Unguarded):
    """Takes its time before a motion."""

    def __init__(self) -> None:
        self.asked = asyncio.Event()
        self.go_on = asyncio.Event()

    @asynccontextmanager
    async def motion(self) -> AsyncIterator[None]:
        self.asked.set()
        await self.go_on.wait()
        yield


async def test_a_stop_while_the_guard_is_asked_counts() -> None:
    guard = SlowGuard()
    async with linked(guard=guard) as bench:
        way = asyncio.create_task(bench.robot.follow(WAY))
        await guard.asked.wait()
        await bench.robot.stop()
        guard.go_on.set()
        with pytest.raises(RefusedError, match="stop overtook"):
            await way
        assert bench.program.driven == []


async def test_a_stopped_data_link_program_starts_before_the_path() -> None:
    async with linked(flags="A0060") as bench:
        assert not any(b"RUN" in request for request in bench.main.requests)
        assert bench.program.requests == []
        await bench.robot.follow(WAY)
        assert b"1;1;RUNCATSDL;1\r" in bench.main.requests
        assert bench.program.driven == [pytest.approx(target) for target in WAY]


async def test_without_a_program_name_the_operator_starts_it() -> None:
    async with linked(program="") as bench:
        await bench.robot.stop()
        with pytest.raises(RefusedError, match="start the program CATSDL"):
            await bench.robot.follow(WAY)


async def test_a_cancelled_way_is_stopped() -> None:
    async with linked(move_timeout_s=30.0) as bench:
        bench.program.silent = {2}
        task = asyncio.create_task(bench.robot.follow(WAY))
        await until(lambda: any(command == 2 for _, command in bench.program.requests))
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert any(b"STOP" in request for request in bench.aside.requests)


@pytest.mark.parametrize("way", [(), ((math.nan, 0.0, 0.0, 0.0),)])
async def test_ways_that_cannot_be_are_refused(way: tuple[Pose, ...]) -> None:
    async with linked() as bench:
        with pytest.raises(ValueError, match=r"targets|finite"):
            await bench.robot.follow(way)


def test_a_missing_data_link_endpoint_is_named() -> None:
    with pytest.raises(LinkError, match="datalink_endpoint"):
        MelfaDatalink.at("tcp://127.0.0.1:1", StepClock())


async def test_a_jog_stops_the_program_until_the_next_path() -> None:
    async with linked() as bench:
        async with bench.robot.jogging({"J1": 1}) as jog:
            # A controller refuses JOG while a program runs.
            assert any(b"STOP" in request for request in bench.aside.requests)
            jog.feed()
            await until(lambda: any(b"JOG00;00;00;01;00" in request for request in bench.main.requests))
        assert not any(b"RUN" in request for request in bench.main.requests)
        await bench.robot.follow(WAY)
        assert any(b"RUNCATSDL;1" in request for request in bench.main.requests)
        assert bench.program.driven == [pytest.approx(target) for target in WAY]


async def test_a_jog_without_a_running_program_needs_no_stop() -> None:
    async with linked(flags="A0060") as bench:
        async with bench.robot.jogging({"J4": -1}):
            assert not any(b"STOP" in request for request in bench.aside.requests)
        assert any(b"STOP" in request for request in bench.aside.requests)


def test_melfa_drivers_jog() -> None:
    assert MelfaDatalink.abilities.jogs
    assert MelfaR3.abilities.jogs
