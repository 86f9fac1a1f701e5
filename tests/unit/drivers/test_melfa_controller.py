"""The controller beyond motion, against the sheet's telegrams and scripted controllers."""

import asyncio
import math
from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager, suppress
from dataclasses import fields, is_dataclass
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.melfa import codec, texts
from catseye.drivers.melfa.codec import AnswerDecoder
from catseye.drivers.melfa.controller import MelfaController, ProgramText
from catseye.drivers.melfa.jog import DEAD_MAN_S, PERIOD_S, telegram
from catseye.drivers.melfa.texts import EncoderReading, LogEntry, PositionValue, ProgramEntry, StopSources
from catseye.drivers.roles.errors import NotReadyError, ProtocolError, RefusedError
from tests.patience import until
from tests.transcripts import melfa_r3 as sheet
from tests.transcripts.melfa_r3 import Exchange
from tests.unit.drivers.melfa_bench import Bench, Controller, bench
from tests.unit.drivers.outcomes import outcome_of
from tests.unit.drivers.virtual_time import run


def payload(exchange: Exchange) -> str:
    """Return what stands behind the prefix, as the codec reads it."""
    answer = codec.parse_answer(exchange.answer.encode(), terminated=False)
    assert answer.accepted
    return answer.payload


def test_telegrams_of_the_sheet_are_read() -> None:
    opened = codec.parse_open(payload(sheet.OPEN_EIGHT))
    assert (opened.joints, opened.model, opened.firmware) == (0xFF, "RV-13FLM-D", "Ver.S7e")
    paused = codec.parse_state(payload(sheet.STATE_PAUSED))
    assert (paused.program, paused.override_percent, paused.teach_mode, paused.running) == (
        "KAMAL.MB4",
        50.0,
        True,
        False,
    )
    assert codec.parse_positions(payload(sheet.JOINTS_SIX))["J3"] == 102.51
    assert len(codec.parse_positions(payload(sheet.JOINTS_EIGHT))) == 8
    assert codec.parse_positions(payload(sheet.POSITION_FLAGS))["C"] == 106.80
    assert codec.parse_error(payload(sheet.ERROR)) == (4140, 2)
    assert texts.parse_variable(payload(sheet.NUMBER), "M1") == 3.0
    assert texts.parse_variable(payload(sheet.SERVO), "M_SVO") == 1.0
    position = texts.parse_variable(payload(sheet.POSITION_VALUE), "P1")
    assert position == PositionValue((400.13, 0.0, 644.62, 180.0, 0.0, 180.0), (7, 0))
    assert texts.parse_date(payload(sheet.TIME)) == "2004-02-09 17:54:32"
    entry, count = texts.parse_directory(payload(sheet.DIRECTORY))
    assert entry == ProgramEntry("1.MB4", 4767, "2024-02-28 21:05:14", 9, 82)
    assert count == 2
    assert texts.parse_parameter(payload(sheet.TOOL), "MEXTL") == ("0.00",) * 6
    assert texts.parse_parameter(payload(sheet.LANGUAGE), "RLNG") == ("1",)
    for rejected, number in ((sheet.NO_RIGHT, 6020), (sheet.BAD_SLOT, 5120)):
        assert codec.parse_answer(rejected.answer.encode(), terminated=False).number == number


@pytest.mark.parametrize("flags", sheet.COMPOSITES)
def test_composites_of_the_sheet_are_read(flags: str) -> None:
    state = codec.parse_state(f";0;100;0;{flags};0;1;;;;;;;;;REP;START;1;0")
    meaning = sheet.COMPOSITES[flags]
    assert state.servo_on == ("servo on" in meaning)
    assert state.running == ("running" in meaning)
    assert state.teach_mode == ("TEACH" in meaning)
    # 80060 and A… hold the right.
    assert state.operation_enabled == ("right" in meaning)
    assert state.error == (4220 if "4220" in meaning else 0)


def test_stop_sources_are_described_in_text() -> None:
    """Section 1.12: stop 1 T/B, 2 PC, 4 I/O, 8 O/P; emergency 1 I/O, 2 O/P, 4 T/B."""
    assert texts.parse_stop_sources("0;0") == StopSources((), ())
    sources = texts.parse_stop_sources("B;5")
    assert sources.stop == ("teaching pendant", "personal computer", "operating panel")
    assert sources.emergency == ("I/O signal", "teaching pendant")
    assert texts.parse_stop_sources("10;0").stop == ("unknown source 10",)


def test_a_line_of_the_log_is_read() -> None:
    """Section 1.13: date;time;no;text;level;prog;line;detail."""
    line = texts.parse_log("24-02-28;21:05:14;2602;Target outside;L;ABC.MB5;12;260200000")
    assert line == LogEntry("2024-02-28 21:05:14", 2602, "Target outside", "L", "ABC.MB5", "12", "260200000")
    assert texts.parse_log("") is None


@pytest.mark.parametrize(
    "read",
    [
        lambda text: texts.parse_variable(text, "M1"),
        texts.parse_directory,
        texts.parse_log,
        texts.parse_stop_sources,
        lambda text: texts.parse_word(text, "IN"),
        texts.parse_encoders,
        lambda text: texts.parse_parameter(text, "NETIP"),
        texts.parse_date,
    ],
)
@given(
    text=st.one_of(
        st.text(max_size=60),
        st.from_regex(r"(M1=)?[M1=;,()0-9.e+-]{0,40}", fullmatch=True),
        st.sampled_from(["M1=1e999", "M1=(1e999,0,0,0)", "M1=nan"]),
    )
)
def test_random_texts_are_finite_or_a_protocol_error(read: Callable[[str], object], text: str) -> None:
    assert all(map(math.isfinite, numbers_in(outcome_of(read, text))))


def numbers_in(found: object) -> list[float]:
    """Return all numbers in what a text was read as."""
    if isinstance(found, int | float):
        return [found]
    if is_dataclass(found) and not isinstance(found, type):
        found = [getattr(found, each.name) for each in fields(found)]
    if isinstance(found, Iterable) and not isinstance(found, str):
        return [number for part in found for number in numbers_in(part)]
    assert found is None or found is ProtocolError or isinstance(found, str)
    return []


@given(st.one_of(st.floats(-1e6, 1e6), st.tuples(*[st.floats(-1e4, 1e4)] * 4)))
def test_written_values_round_trip(value: float | tuple[float, ...]) -> None:
    text = texts.value_text(value)
    assert "e" not in text.lower()
    assert "-0)" not in text
    back = texts.parse_variable(f"X={text}", "X")
    assert back == pytest.approx(value, abs=1e-6)


def replies(controller: Controller, answers: dict[str, str | list[str]]) -> None:
    """Have commands answered; a list is gone through."""
    usual = controller.usual

    def answer(command: str) -> Any:
        found = answers.get(command)
        if found is None:
            return usual(command)
        return [found.pop(0) if isinstance(found, list) else found]

    controller.usual = answer  # type: ignore[method-assign]  # the script answers otherwise here


@asynccontextmanager
async def asked(answers: dict[str, str | list[str]]) -> AsyncIterator[tuple[Bench, MelfaController]]:
    controller = Controller()
    replies(controller, answers)
    async with bench(controller) as b:
        yield b, b.robot.controller


async def test_variables_are_read_and_written() -> None:
    answers: dict[str, str | list[str]] = {
        "VALM1": "QoKM1=+3",
        "VALJ_FBC": "QoKJ_FBC=(+10.00,-20.50,+1.25,+30.00,+0.00,+0.00)",
        "VALP1": sheet.POSITION_VALUE.answer,
    }
    async with asked(answers) as (b, controller):
        assert await controller.read_variable("M1") == 3.0
        assert await controller.feedback() == (10.0, -20.5, 1.25, 30.0)
        assert isinstance(await controller.read_variable("P1"), PositionValue)
        await controller.write_variable("M2", 1e-7)
        await controller.write_variable("J1", (1.0, -0.0, 2.5, 90.0), program="ABC")
        assert b.said[-2:] == ["VAL=M2=0", "HOTABC;J1=(1,0,2.5,90)"]
        for name in ("M1\rSTOP", "M1;1", "", "1M"):
            with pytest.raises(ValueError, match="not the name"):
                await controller.read_variable(name)


async def test_programs_are_listed_read_and_written() -> None:
    answers: dict[str, str | list[str]] = {
        "PDIRTOP": sheet.DIRECTORY.answer,
        "PDIR2": "QoK2.MB4;100;24-02-2821:05:15;12;;3;0;0;0;0;0",
        "FCHECKABC": "QoKN",
        "FCHECKNEW": "QoKF",
        "LISTITOP": "QoK10 MOV P1",
        "LISTI+1": ["QoK20 END", "QoK"],
        "LISTPTOP": sheet.POSITION_VALUE.answer,
        "LISTP+1": "QoK",
    }
    async with asked(answers) as (b, controller):
        assert [(entry.name, entry.lines) for entry in await controller.programs()] == [
            ("1.MB4", 9),
            ("2.MB4", 3),
        ]
        program = await controller.read_program("ABC")
        assert program.lines == ("10 MOV P1", "20 END")
        assert program.variables["P1"] == PositionValue((400.13, 0.0, 644.62, 180.0, 0.0, 180.0), (7, 0))
        assert b.said[-1] == "NEW"
        with pytest.raises(RefusedError, match="no program NEW"):
            await controller.read_program("NEW")
        with pytest.raises(RefusedError, match="already"):
            await controller.write_program("ABC", program)
        await controller.write_program("NEW", program)
        assert b.said[-7:] == [
            "LOAD=NEW",
            "ECLR",
            "EDATA10 MOV P1",
            "EDATA20 END",
            "EDATAP1=(400.13,0,644.62,180,0,180)(7,0)",
            "SAVE",
            "NEW",
        ]


async def test_a_refused_line_leaves_the_program_as_it_was() -> None:
    """Section 1.6: Qer<no>;<pos>."""
    answers: dict[str, str | list[str]] = {"FCHECKNEW": "QoKF", "EDATA10 MOVE": "Qer422000000;5"}
    async with asked(answers) as (b, controller):
        with pytest.raises(RefusedError, match="4220"):
            await controller.write_program("NEW", ProgramText(("10 MOVE",)))
        assert "SAVE" not in b.said
        assert b.said[-1] == "NEW"


@pytest.mark.parametrize("line", ["MOV P1", "10", "10 " + "A" * 128, "10 \u00e4"])
async def test_unsendable_lines_are_refused_before_any_change(line: str) -> None:
    async with asked({}) as (b, controller):
        before = list(b.said)
        with pytest.raises(ValueError, match=r"begins with|at most 127|ASCII"):
            await controller.write_program("NEW", ProgramText((line,)))
        assert b.said == before


async def test_a_parameter_is_written_only_when_it_is_meant() -> None:
    async with asked({"PNRNETIP": "QoKNETIP;192.168.0.20;1"}) as (b, controller):
        assert await controller.read_parameter("NETIP") == ("192.168.0.20",)
        with pytest.raises(ValueError, match="confirm=True"):
            await controller.write_parameter("NETIP", ["192.168.0.21"])
        assert not any(command.startswith("PRM") for command in b.said)
        await controller.write_parameter("NETIP", ["192.168.0.21"], confirm=True)
        assert b.said[-1] == "PRM=NETIP;192.168.0.21"


@pytest.mark.parametrize("newest_first", [True, False])
async def test_the_newest_lines_of_the_log_come_first(newest_first: bool) -> None:
    lines = [f"QoK24-02-28;21:05:1{n};260{n};text;L;;0;260{n}00000" for n in (3, 2, 1)]
    step, top, end = ("+1", "TOP", "END") if newest_first else ("-1", "END", "TOP")
    answers: dict[str, str | list[str]] = {
        f"ERRORLOG{top}": lines[0],
        f"ERRORLOG{end}": lines[2],
        f"ERRORLOG{step}": [lines[1], lines[2], "QoK"],
    }
    async with asked(answers) as (_, controller):
        assert [entry.number for entry in await controller.error_log(10)] == [2603, 2602, 2601]
    answers[f"ERRORLOG{step}"] = [lines[1], lines[2]]
    async with asked(answers) as (_, controller):
        assert [entry.number for entry in await controller.error_log(2)] == [2603, 2602]
    async with asked({"ERRORLOGTOP": "QoK", "ERRORLOGEND": "QoK"}) as (_, controller):
        assert await controller.error_log(5) == []


async def test_signals_and_monitors() -> None:
    answers: dict[str, str | list[str]] = {
        "IN0": "QoK0005",
        "OUT16": "QoK00FF",
        "SRVENC": "QoK" + ";".join(["1;2;3;4"] * 8),
        "SRVCUR1": "QoK" + ";".join(["0.50;1.25;1.20"] * 8),
        "TIME": sheet.TIME.answer,
        "STPSIG": "QoK2;0",
    }
    async with asked(answers) as (b, controller):
        assert await controller.inputs(0) == 5
        assert await controller.outputs(16) == 0xFF
        await controller.write_outputs(16, 0x0A)
        assert b.said[-1] == "OUT=16;000A"
        with pytest.raises(ValueError, match="65535"):
            await controller.write_outputs(16, 65_536)
        assert (await controller.encoders())[7] == EncoderReading(1, 2, 3, 4)
        assert await controller.currents() == (0.5,) * 8
        assert await controller.clock() == "2004-02-09 17:54:32"
        assert (await controller.stop_sources()).stop == ("personal computer",)


async def test_a_caution_is_no_alarm() -> None:
    """Section 1.13: level 3; section 5.3: a caution goes on."""
    controller = Controller()
    controller.replies["ERROR"] = lambda: ["Qok9200;3"]
    controller.replies["STATE"] = lambda: ["Qok;0;20;0;A0060;0;1;;;;;;;;;REP;START;1;0"]
    async with bench(controller) as b:
        assert (await b.robot.status()).alarm_number == 0


def test_the_telegram_of_a_jog() -> None:
    """Section 1.9: mode 00, 00, minus axes, plus axes, inching 00."""
    assert telegram({"J1": 1}) == "JOG00;00;00;01;00"
    assert telegram({"J2": -1, "J4": 1}) == "JOG00;00;02;08;00"
    for wrong in ({}, {"J5": 1}):
        with pytest.raises(ValueError, match="joints to jog"):
            telegram(wrong)  # type: ignore[arg-type]  # the wrong value is the test
    # Half a period late, and a telegram still comes in time.
    assert 1.5 * PERIOD_S < DEAD_MAN_S


def jogs(b: Bench) -> int:
    return sum(command.startswith("JOG") for command in b.said)


async def hold(b: Bench, *, fail: bool = False) -> None:
    """Feed once, then wait for what happens."""
    async with b.robot.controller.jog({"J1": 1}) as jog:
        jog.feed()
        await until(lambda: jogs(b) > 0)
        if fail:
            raise ZeroDivisionError
        await asyncio.Event().wait()


async def test_a_jog_continues_while_fed_and_ends_stopped() -> None:
    async with bench() as b:
        async with b.robot.controller.jog({"J1": 1}) as jog:
            await asyncio.sleep(0)
            assert jogs(b) == 0
            jog.feed()
            await until(lambda: jogs(b) > 0)
            assert "STOP" not in b.said_aside
        assert "STOP" in b.said_aside
        assert b.said.index("CNTLON") < b.said.index("JOG00;00;00;01;00")
        sent = jogs(b)
        await asyncio.sleep(0)
        assert jogs(b) == sent


def test_a_jog_that_is_not_fed_falls_silent() -> None:
    async def feed_twice() -> None:
        async with bench() as b, b.robot.controller.jog({"J1": 1}) as jog:
            jog.feed()
            await asyncio.sleep(10.0)
            # 0.2 s at a telegram every 0.05 s.
            assert jogs(b) == 4
            jog.feed()
            await asyncio.sleep(0.06)
            assert jogs(b) == 6

    run(feed_twice())


def test_a_stop_ends_a_jog_although_it_is_fed() -> None:
    async def feed_on() -> None:
        async with bench() as b:
            held = asyncio.create_task(feeding(b))
            await asyncio.sleep(0.12)
            await b.robot.stop()
            sent = jogs(b)
            with pytest.raises(RefusedError, match="stop overtook"):
                await held
            assert jogs(b) == sent > 0

    async def feeding(b: Bench) -> None:
        async with b.robot.controller.jog({"J1": 1}) as jog:
            while True:
                jog.feed()
                await asyncio.sleep(0.05)

    run(feed_on())


async def test_a_refused_telegram_ends_the_jog_with_its_reason() -> None:
    controller = Controller()
    replies(controller, {"JOG00;00;00;01;00": "QeR200000000"})
    async with bench(controller) as b:
        with pytest.raises(NotReadyError, match="servo is off"):
            await hold(b)
        assert "STOP" in b.said_aside
        assert asyncio.current_task().cancelling() == 0  # type: ignore[union-attr]  # a test runs in a task


def test_a_jog_ended_during_a_telegram_sends_no_other() -> None:
    """Its answer is waited for while STOP goes past it, also on its own connection, which is healed then."""

    async def end_early() -> None:
        controller = Controller()
        controller.replies["JOG00;00;00;01;00"] = list
        async with bench(controller) as b:
            answering = asyncio.create_task(answer_after_stop(b))
            async with b.robot.controller.jog({"J1": 1}) as jog:
                jog.feed()
                await until(lambda: jogs(b) > 0)
            await answering
            await b.robot.status()
            assert jogs(b) == 1
            assert sum(command.startswith("OPEN") for command in b.said) == 2

    async def answer_after_stop(b: Bench) -> None:
        await until(lambda: "STOP" in b.said_aside)
        await b.main.say(b"QoK")

    run(end_early())


@pytest.mark.parametrize("by", ["stop", "end"])
def test_a_queued_telegram_is_not_sent_after_a_stop(by: str) -> None:
    async def overtaken() -> None:
        controller = Controller()
        controller.replies["TIME"] = list
        async with bench(controller) as b:
            with suppress(RefusedError):
                async with b.robot.controller.jog({"J1": 1}) as jog:
                    asking = asyncio.create_task(b.robot.controller.clock())
                    await until(lambda: "TIME" in b.said)
                    jog.feed()
                    await asyncio.sleep(0.05)
                    # The telegram waits behind a question that has no answer yet.
                    assert jogs(b) == 0
                    if by == "stop":
                        await b.robot.stop()
                        await b.main.say(sheet.TIME.answer.encode())
                        await asyncio.sleep(0.1)
            if by == "end":
                await b.main.say(sheet.TIME.answer.encode())
            await asyncio.sleep(0.1)
            assert await asking == "2004-02-09 17:54:32"
            assert "STOP" in b.said_aside
            assert jogs(b) == 0

    run(overtaken())


@pytest.mark.parametrize("how", ["error", "cancel"])
async def test_whatever_ends_a_jog_stops_the_robot(how: str) -> None:
    async with bench() as b:
        task = asyncio.create_task(hold(b, fail=how == "error"))
        await until(lambda: jogs(b) > 0)
        if how == "cancel":
            task.cancel()
        with pytest.raises((ZeroDivisionError, asyncio.CancelledError)):
            await task
        assert "STOP" in b.said_aside


@given(exchange=st.sampled_from(sheet.ANSWERS_IN_LAYOUT), cuts=st.lists(st.integers(0, 200), max_size=6))
def test_any_split_of_a_terminated_answer_reads_the_same(exchange: Exchange, cuts: list[int]) -> None:
    data = exchange.answer.encode() + b"\r"
    places = [0, *sorted(min(cut, len(data)) for cut in cuts), len(data)]
    decoder = AnswerDecoder(codec.free_text, terminated=True)
    answers = [decoder.feed(data[a:b]) for a, b in pairwise(places)]
    assert next(answer for answer in answers if answer).payload == exchange.answer[3:]
