"""What the emulated operator's hands do on a bench, and when they do it."""

import asyncio
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from catseye.app.engine.operator import Answer, Operator, says_done
from catseye.app.engine.simulated_operator import SimulatedOperator
from catseye.app.errors import ConfigError, LinkFailedError
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.tasks import (
    ClearBeam,
    ExportBallbar,
    MountBallbar,
    MountInterferometer,
    PlaceReflector,
    PlaceTarget,
    ReadBallbar,
    SetUpScaleBar,
    TakeBallbarOff,
    TurnScrew,
)
from catseye.simulators.config import EmulationConfig, ErrorBudget, Remounting, Screws
from catseye.simulators.emulated_bench import EmulatedBench, EmulatedSerialBench
from catseye.simulators.survey import Mark, SurveyConfig
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.simulators.benches import QUIET
from tests.unit.simulators.world.serial.arms import serial_arm

# Reflectors are drawn some millimetres off: the straight arm meets P2 with a wide acceptance.
WIDE = replace(QUIET, one_reflector=True, acceptance_mm=50.0, devices=())
EXACT = replace(
    WIDE, screws=Screws(setting_turns=0.0, play_turns=0.0), remounting=Remounting(0.0, 0.0, 0.0, 0.0, 0.0)
)
TURN = TurnScrew(screw="stage", turns=0.5)
STAGE = Prompt("stage/1", "choice", "Turn.", choices=("done", "stop"), safe_answer="stop", task=TURN)


@pytest.fixture
async def bench() -> AsyncIterator[EmulatedBench]:
    async with EmulatedBench(EXACT) as running:
        yield running


def endpoint(bench: EmulatedBench) -> str:
    return bench.endpoints[-1].endpoint


async def test_hands_turn_a_screw_clockwise(bench: EmulatedBench) -> None:
    done = await SimulatedOperator(endpoint(bench)).do(TURN)
    # Half a turn of a screw with 0.5 mm a turn.
    assert bench.bench.beam.mount.offset_mm == pytest.approx(0.25)
    assert done == {"op": "turn_screw", "screw": "stage", "turns": 0.5}


async def test_clumsy_hands_turn_it_the_wrong_way(bench: EmulatedBench) -> None:
    await SimulatedOperator(endpoint(bench), clumsy=True).do(TurnScrew(screw="level", turns=1))
    assert 1e3 * bench.bench.beam.mount.pitch_rad == pytest.approx(-2.0)


async def test_hands_carry_the_reflector_and_clear_the_beam(bench: EmulatedBench) -> None:
    hands = SimulatedOperator(endpoint(bench))
    assert bench.bench.beam.in_place == ["P1"]
    await hands.do(PlaceReflector(reflector="P2"))
    assert bench.bench.beam.in_place == ["P2"]
    bench.bench.beam.block(None)
    assert not bench.bench.beam.read().returns
    await hands.do(ClearBeam())
    assert bench.bench.beam.read().returns


async def test_hands_mount_the_interferometer_turned_once(bench: EmulatedBench) -> None:
    hands = SimulatedOperator(endpoint(bench))
    for _ in range(2):
        # Asked again, they leave it as it is asked for: it is no further half turn.
        done = await hands.do(MountInterferometer(turned_deg=180.0))
    assert done == {"op": "mount_interferometer", "turned_deg": 180.0}
    assert bench.bench.true_state().beam_deg % 360.0 == pytest.approx(180.0 + drawn_theta40_deg(bench))


def drawn_theta40_deg(bench: EmulatedBench) -> float:
    theta40_deg = bench.context.truth["theta40_deg"]
    assert isinstance(theta40_deg, float)
    return theta40_deg + bench.bench.true_state().joints[3] + sum(bench.bench.true_state().joints[:2])


async def test_what_the_bench_refuses_is_said(bench: EmulatedBench) -> None:
    with pytest.raises(LinkFailedError, match="no reflector 'P9'; there are P1, P2, P3"):
        await SimulatedOperator(endpoint(bench)).do(PlaceReflector(reflector="P9"))
    with pytest.raises(LinkFailedError, match="turns"):
        await SimulatedOperator(endpoint(bench)).do(TurnScrew(screw="stage", turns=500.0))


async def test_a_bench_that_is_not_there_is_said() -> None:
    server = await asyncio.start_server(_hang_up, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    async with server:
        with pytest.raises(LinkFailedError, match="does not do"):
            await SimulatedOperator(f"tcp://127.0.0.1:{port}").do(TURN)
    with pytest.raises(LinkFailedError, match="catseye emulate"):
        await SimulatedOperator(f"tcp://127.0.0.1:{port}").do(TURN)


async def _hang_up(_reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    writer.close()


@pytest.mark.parametrize(
    ("prompt", "text", "done"),
    [
        (Prompt("a", "confirm", "?"), "yes", True),
        (Prompt("a", "confirm", "?"), "no", False),
        (STAGE, "done", True),
        (STAGE, "stop", False),
        (Prompt("a", "number", "?"), "3", True),
    ],
)
def test_which_answers_say_that_the_task_is_done(prompt: Prompt, text: str, *, done: bool) -> None:
    assert says_done(prompt, text) is done


async def test_the_task_is_done_unattended_despite_a_safe_answer(bench: EmulatedBench) -> None:
    operator = Operator(ManualClock(), {}, None, simulated=True, hands=SimulatedOperator(endpoint(bench)))
    answer = await operator.answer(STAGE)
    assert (answer.text, answer.who) == ("done", "emulated operator")
    assert answer.done == {"op": "turn_screw", "screw": "stage", "turns": 0.5}
    assert bench.bench.beam.mount.offset_mm == pytest.approx(0.25)


async def test_the_hands_obey_a_person_and_the_answers_file_too(bench: EmulatedBench) -> None:
    async def person(_prompt: Prompt) -> Answer:
        return Answer("done", "Ada")

    hands = SimulatedOperator(endpoint(bench))
    await Operator(ManualClock(), {}, person, simulated=True, hands=hands).answer(STAGE)
    assert bench.bench.beam.mount.offset_mm == pytest.approx(0.25)
    stopped = await Operator(ManualClock(), {"stage/1": "stop"}, None, simulated=True, hands=hands).answer(
        STAGE
    )
    assert stopped == Answer("stop", "answers file")
    assert bench.bench.beam.mount.offset_mm == pytest.approx(0.25)


async def test_on_real_hardware_no_hands_move(bench: EmulatedBench) -> None:
    async def person(_prompt: Prompt) -> Answer:
        return Answer("done", "Ada")

    operator = Operator(ManualClock(), {}, person, simulated=False, hands=SimulatedOperator(endpoint(bench)))
    assert await operator.answer(STAGE) == Answer("done", "Ada")
    assert bench.bench.beam.mount.offset_mm == 0.0


async def test_without_a_way_to_the_bench_the_remedy_is_reported() -> None:
    operator = Operator(ManualClock(), {}, None, simulated=True)
    with pytest.raises(ConfigError, match=r"'stage/1' asks for: Turn\. Add a \[tracker\]"):
        await operator.answer(STAGE)


TOOL = (Mark("nest1", (0.0, 0.0, 125.0)), Mark("nest2", (71.0, 90.0, 215.0)))


@pytest.fixture
async def room() -> AsyncIterator[EmulatedSerialBench]:
    arm = serial_arm("irb120")
    start = (0.0, 10.0, -10.0, 0.0, 5.0, 0.0)
    config = EmulationConfig(
        serial=arm, start_joints=start, devices=(), survey=SurveyConfig(targets=TOOL), seed=4
    )
    async with EmulatedSerialBench(config, arm) as running:
        yield running


READ = Prompt("ballbar/1", "text", "Type the deviation.", task=ReadBallbar())


async def hang(room: EmulatedSerialBench) -> SimulatedOperator:
    hands = SimulatedOperator(room.endpoints[-1].endpoint)
    x_mm, y_mm, z_mm = room.bench.room.places_mm(["nest1"], np.zeros(1))[0, 0].tolist()
    await hands.do(MountBallbar(target="nest1", centre_mm=(x_mm, y_mm, z_mm - 300.0)))
    return hands


async def test_the_emulated_operator_types_what_the_ballbar_shows(room: EmulatedSerialBench) -> None:
    hands = await hang(room)
    places = room.bench.room.places_mm(["nest1", "centre"], np.array([room.bench.time_s]))[:, 0]
    true_mm = float(np.linalg.norm(places[0] - places[1])) - 300.0
    answer = await Operator(ManualClock(), {}, None, simulated=True, hands=hands).answer(READ)
    assert answer.who == "emulated operator"
    assert float(answer.text) == pytest.approx(true_mm, abs=0.006)


async def test_a_person_types_the_reading_themselves(room: EmulatedSerialBench) -> None:
    async def person(_prompt: Prompt) -> Answer:
        return Answer("0.125", "Ada")

    hands = await hang(room)
    answer = await Operator(ManualClock(), {}, person, simulated=True, hands=hands).answer(READ)
    assert answer.text == "0.125"


async def test_the_recording_is_written_where_it_is_typed(room: EmulatedSerialBench, tmp_path: Path) -> None:
    hands = await hang(room)
    typed, own = tmp_path / "bar.csv", tmp_path / "own.csv"
    own.write_text("t_s,deviation_mm\n", encoding="utf-8")
    asked = Prompt("lengths/nest1", "text", "Type the path.", task=ExportBallbar())
    answers = {"lengths/nest1": str(typed), "lengths/nest1/2": str(own)}
    operator = Operator(ManualClock(), answers, None, simulated=True, hands=hands)
    assert (await operator.answer(asked)).done == {"op": "ballbar_recording"}
    header, first, *_ = typed.read_text("utf-8").splitlines()
    assert header == "t_s,deviation_mm"
    assert float(first.split(",")[1]) == pytest.approx(float(await hands.read(ReadBallbar())), abs=0.006)
    await operator.answer(replace(asked, id="lengths/nest1/2"))
    assert own.read_text("utf-8") == "t_s,deviation_mm\n"


async def test_a_reading_over_range_is_no_number(room: EmulatedSerialBench) -> None:
    hands = await hang(room)
    await hands.do(TakeBallbarOff())
    operator = Operator(ManualClock(), {}, None, simulated=True, hands=hands)
    assert (await operator.answer(READ)).text == "none"
    number = replace(READ, kind="number", safe_answer="9")
    assert (await operator.answer(number)).text == "9"


async def test_hands_put_targets_back_and_stand_the_bar_up(room: EmulatedSerialBench) -> None:
    hands = SimulatedOperator(room.endpoints[-1].endpoint)
    room.bench.room.named("nest2").occupied = False
    await hands.do(PlaceTarget(target="nest2"))
    assert room.bench.room.named("nest2").occupied
    await hands.do(SetUpScaleBar(place_mm=(700.0, 0.0, 300.0), turn_deg=90.0))
    one, other = room.bench.room.places_mm(["bar1", "bar2"], np.array([room.bench.time_s]))[:, 0]
    assert np.linalg.norm(one - other) == pytest.approx(1000.0, abs=0.02)
    assert abs((other - one)[0]) < 100.0


async def test_each_start_of_a_bench_tells_itself_apart(bench: EmulatedBench) -> None:
    first = await SimulatedOperator(endpoint(bench)).bench()
    assert first["bench_started"]
    assert await SimulatedOperator(endpoint(bench)).bench() == first
    async with EmulatedBench(EXACT) as restarted:
        second = await SimulatedOperator(endpoint(restarted)).bench()
    assert second["bench_started"] not in {"", first["bench_started"]}
    assert second["bench_truth"] == first["bench_truth"]
    # Nobody answers any more; a run does not fail for that.
    assert await SimulatedOperator(endpoint(restarted)).bench() == {"bench_started": "", "bench_truth": ""}


async def test_each_true_arm_tells_itself_apart() -> None:
    told = []
    for seed in (1, 2, 1):
        async with EmulatedBench(replace(EXACT, budget=ErrorBudget(), seed=seed)) as emulated:
            told.append((await SimulatedOperator(endpoint(emulated)).bench())["bench_truth"])
    assert told[0] == told[2] != told[1]
