"""attocube IDS: requests of the maker's client, both codecs, modes, the driver on the emulator."""

import json
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.attocube import codec
from catseye.drivers.attocube.ids import AttocubeIds, IdsSettings
from catseye.drivers.roles.errors import ProtocolError, RefusedError, WrongDeviceError
from catseye.simulators.attocube.json_rpc import JsonCutter
from catseye.simulators.context import EmulationContext
from catseye.simulators.ports.session import Session
from tests.transcripts import attocube_ids as transcript
from tests.unit.drivers.interferometers.pairs import new_session, paired, quiet_world
from tests.unit.drivers.outcomes import outcome_of
from tests.unit.drivers.peers import Peer, StepClock
from tests.unit.simulators.attocube.clients import send, wait
from tests.unit.simulators.benches import aimed, driven_mm, go


def make(transport: MemoryTransport, clock: StepClock, **settings: Any) -> AttocubeIds:
    return AttocubeIds(transport, clock, IdsSettings(quiet_s=0.001, timeout_s=0.5, **settings))


def parts(data: bytes, cuts: list[int]) -> list[bytes]:
    return [data[a:b] for a, b in pairwise([0, *sorted(cuts), len(data)])]


def ask(session: Session, method: str, *params: object) -> Any:
    request = {"jsonrpc": "2.0", "method": method, "api": 2, "id": 5, "params": list(params)}
    (answer,) = said(session, json.dumps(request).encode())
    assert answer["id"] == 5
    return answer.get("result", answer.get("error"))


def said(session: Session, data: bytes) -> list[Any]:
    session.feed(data)
    answers = []
    while (answer := session.answer()) is not None:
        assert isinstance(answer, bytes)
        assert answer.endswith(b"\r\n")
        answers.append(json.loads(answer))
    return answers


@pytest.fixture
def world() -> EmulationContext:
    return quiet_world()


@pytest.fixture
def session(world: EmulationContext) -> Session:
    session = new_session(world, "attocube-ids")
    ask(session, "com.attocube.ids.system.startMeasurement")
    world.beam_bench.advance(3.0)
    return session


def test_requests_have_the_keys_of_the_makers_client() -> None:
    newer = codec.encode("com.attocube.sen.displacement.getAxisDisplacement", (0,), 7, "sen")
    assert json.loads(newer) == json.loads(transcript.NEWER_REQUEST)
    older = codec.encode("com.attocube.ids.system.getCurrentMode", (), 8, "ids")
    assert json.loads(older) == json.loads(transcript.OLDER_REQUEST)
    assert newer.endswith(b"}")


@pytest.mark.parametrize("answer", [transcript.MODE_ANSWER, transcript.BARE_MODE_ANSWER])
def test_a_mode_is_read_in_both_generations(answer: bytes) -> None:
    said = codec.AnswerDecoder(8).feed(answer)
    assert said == codec.Answer(0, ("measurement running",))


@given(st.lists(st.integers(0, len(transcript.DISPLACEMENT_ANSWER)), max_size=5))
def test_any_cut_of_an_answer_gives_the_same_value(cuts: list[int]) -> None:
    decoder = codec.AnswerDecoder(7)
    answers = [decoder.feed(part) for part in parts(transcript.DISPLACEMENT_ANSWER, cuts)]
    answer = next(answer for answer in answers if answer)
    assert answer.number() * codec.MM_PER_PM == pytest.approx(-1.23456789)


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        (b"hello\r\n", "is not JSON"),
        (b"[" * 5000 + b"\r\n", "is not JSON"),
        (transcript.MODE_ANSWER, "does not answer request 7"),
        (b'{"id": 7, "error": {"code": -32601}}\r\n', "not understood"),
        (b'{"id": 7, "result": []}\r\n', "does not begin with an error number"),
        (b"x" * 70_000, "does not end"),
    ],
)
def test_other_lines_are_garbage(line: bytes, fault: str) -> None:
    with pytest.raises(ProtocolError, match=fault):
        codec.AnswerDecoder(7).feed(line)


@pytest.mark.parametrize("value", ["NaN", "1e999", "true", '"5"', "null", "1" + "0" * 400])
def test_what_is_no_number_is_garbage(value: str) -> None:
    answer = codec.AnswerDecoder(7).feed(f'{{"id": 7, "result": [0, {value}]}}\n'.encode())
    assert answer
    with pytest.raises(ProtocolError, match="has no number"):
        answer.number()


@given(st.binary(max_size=300))
def test_random_bytes_are_an_answer_or_garbage(data: bytes) -> None:
    assert outcome_of(codec.AnswerDecoder(7).feed, data) in (None, ProtocolError)


NESTED = b'\r\n {"a": {"b": "}\\"{["}, "c": [1, [2]]}'
REQUESTS = transcript.NEWER_REQUEST + transcript.OLDER_REQUEST + b"\r\n" + NESTED


@given(st.lists(st.integers(0, len(REQUESTS)), max_size=8))
def test_any_cut_of_requests_gives_the_same_objects(cuts: list[int]) -> None:
    cutter = JsonCutter()
    objects = [found for part in parts(REQUESTS, cuts) for found in cutter.feed(part)]
    assert objects == [transcript.NEWER_REQUEST, transcript.OLDER_REQUEST, NESTED.strip()]


def test_objects_too_long_or_too_deep_are_given_up_once() -> None:
    cutter = JsonCutter()
    assert cutter.feed(b'{"a": "' + b"x" * 65_536) == [b""]
    assert cutter.feed(b'{"a":' * 33) == [b""]
    assert cutter.feed(b"}}" + transcript.OLDER_REQUEST) == [transcript.OLDER_REQUEST]


near_requests = st.sampled_from(
    [b"{", b"}", b"{}", b'{"id": 1, "method": 5}', b'{"method": ""}', b"{x}", b'"']
)


@given(st.lists(st.one_of(st.binary(max_size=100), near_requests), max_size=8))
def test_random_bytes_are_errors_and_do_the_emulator_no_harm(chunks: list[bytes]) -> None:
    session = new_session(quiet_world(), "attocube-ids")
    answers = [answer for chunk in chunks for answer in said(session, chunk)]
    assert all(answer["error"]["code"] < 0 for answer in answers)
    # What was begun is given up for good at its longest.
    said(session, b"x" * 70_000)
    assert ask(session, "com.attocube.ids.system.getCurrentMode") == [0, "system idle"]


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        (b'{"id": 1, "method": "com.attocube.ids.nothing"}', -32601),
        (b'{"id": 1, "method": 5}', -32600),
        (b'{"id": 1, "method": "com.attocube.ids.system.getCurrentMode", "params": 5}', -32602),
        (b'{"id": 1, "method": "com.attocube.ids.system.resetAxis", "params": []}', -32602),
        (b"{not json}", -32700),
    ],
)
def test_what_is_no_request_is_an_error_of_json_rpc(
    world: EmulationContext, request_: bytes, code: int
) -> None:
    (answer,) = said(new_session(world, "attocube-ids"), request_)
    assert answer["error"]["code"] == code


def test_a_measurement_takes_time_to_start(world: EmulationContext) -> None:
    session = new_session(world, "attocube-ids")
    space = "com.attocube.ids."
    assert ask(session, space + "system.getCurrentMode") == [0, "system idle"]
    assert ask(session, space + "displacement.getAxisDisplacement", 0)[0] != 0
    assert ask(session, space + "system.startMeasurement") == [0]
    assert ask(session, space + "system.getCurrentMode") == [0, "measurement starting"]
    world.beam_bench.advance(3.0)
    assert ask(session, space + "system.getCurrentMode") == [0, "measurement running"]
    assert ask(session, space + "displacement.getAxisDisplacement", 0) == [0, pytest.approx(0, abs=1e4)]
    assert ask(session, space + "displacement.getAxisDisplacement", 1)[0] != 0
    number = ask(session, space + "system.startMeasurement")[0]
    assert (
        "not possible in this mode" in ask(session, "com.attocube.system.errorNumberToString", 1, number)[1]
    )
    assert ask(session, space + "system.stopMeasurement") == [0]


def test_an_interrupted_axis_keeps_its_error_until_reset(world: EmulationContext, session: Session) -> None:
    space = "com.attocube.ids."
    world.beam_bench.beam.block(0.5)
    error, value = ask(session, space + "displacement.getAxisDisplacement", 0)
    assert error != 0
    assert isinstance(value, int)
    assert ask(session, space + "system.resetAxis", 0)[0] != 0
    world.beam_bench.advance(1.0)
    assert ask(session, space + "displacement.getAxisDisplacement", 0)[0] == error
    assert ask(session, space + "system.resetError", False) == [0]
    assert ask(session, space + "displacement.getAxisDisplacement", 0)[0] == 0


def test_contrast_average_and_environment(world: EmulationContext, session: Session) -> None:
    space = "com.attocube.ids."
    error, contrast, _, _ = ask(session, space + "adjustment.getContrastInPermille", 0)
    assert error == 0
    assert 900 < contrast <= 1000
    assert ask(session, space + "displacement.setAverageN", 14) == [0]
    assert ask(session, space + "displacement.getAverageN") == [0, 14]
    assert ask(session, space + "displacement.setAverageN", 25)[0] != 0
    assert ask(session, "com.attocube.ecu.getTemperatureInDegrees") == [0, pytest.approx(20.0, abs=0.5)]
    index = ask(session, "com.attocube.ecu.getRefractiveIndex")[1]
    assert index == pytest.approx(1.000271, abs=2e-6)
    absolute_pm = ask(session, space + "displacement.getAbsolutePosition", 0)[1]
    optical_mm = world.bench.air_index() * world.beam_bench.true_state().length_mm
    assert absolute_pm * 1e-9 == pytest.approx(optical_mm, abs=0.1)
    assert len(ask(session, space + "displacement.getAxesDisplacement")) == 4


def test_an_absolute_length_is_known_no_better_than_stated(world: EmulationContext, session: Session) -> None:
    """Each start finds it anew; half of the variance of 0.02 mm is the instrument's own."""
    space, errors = "com.attocube.ids.", []
    for _ in range(40):
        assert ask(session, space + "system.stopMeasurement") == [0]
        assert ask(session, space + "system.startMeasurement") == [0]
        world.beam_bench.advance(3.0)
        found = ask(session, space + "displacement.getAbsolutePosition", 0)
        assert found == [
            0,
            pytest.approx(ask(session, space + "displacement.getAbsolutePosition", 0)[1], abs=1e6),
        ]
        errors.append(found[1] * 1e-9 - world.bench.air_index() * world.beam_bench.true_state().length_mm)
    # 95 % of the standard deviations of 40 draws lie within 23 % of theirs, all but one in 10 000 within 45 %.
    part_mm = 0.02 / np.sqrt(2.0)
    assert 0.55 * part_mm < np.std(errors) < 1.45 * part_mm
    assert 0.0 < abs(np.mean(errors)) < 4.0 * np.hypot(part_mm, part_mm / np.sqrt(40.0))


def test_without_a_beam_no_start_finds_a_length(world: EmulationContext) -> None:
    session = new_session(world, "attocube-ids")
    world.beam_bench.block_beam(None)
    space = "com.attocube.ids."
    assert ask(session, space + "system.startMeasurement") == [0]
    world.beam_bench.advance(3.0)
    for name in ("getAbsolutePosition", "getReferencePosition"):
        error, length_pm = ask(session, f"{space}displacement.{name}", 0)
        assert error != 0
        assert length_pm == 0


async def test_the_driver_starts_an_idle_system_and_says_so() -> None:
    async with paired("attocube-ids", lambda t, c: make(t, c), connect=False) as pair:
        identity = await pair.driver.connect()
        assert identity.model == "attocube IDS3010 EMULATOR"
        assert identity.simulated
        assert "has been started" in pair.driver.notes[0]
        assert pair.driver.compensated == "none"


@pytest.mark.parametrize("dialect", ["ids", "sen"])
async def test_both_name_spaces_and_the_environment_unit(dialect: str) -> None:
    options: dict[str, str | int | bool] = {
        "dialect": dialect,
        "start_time_s": 0,
        "ecu_enabled": True,
        "sign": -1,
        "axis": 2,
        "bare_mode": True,
    }
    async with paired(
        "attocube-ids", lambda t, c: make(t, c, dialect=dialect, sign=-1, axis=2), options
    ) as pair:
        assert pair.driver.compensated == "instrument"
        await pair.driver.zero()
        way_mm = driven_mm(pair.bench, aimed(20.01, 30.01))
        assert (await pair.driver.read()).displacement_mm == pytest.approx(way_mm, abs=1e-6)


async def test_no_zero_without_a_beam_in_the_instruments_words() -> None:
    async with paired("attocube-ids", make, {"start_time_s": 0}) as pair:
        pair.bench.beam.block(None)
        with pytest.raises(RefusedError, match=r"resetAxis gave error 4: EMULATOR: no signal"):
            await pair.driver.zero()


@pytest.mark.parametrize("enabled", [False, True])
async def test_no_zero_after_somebody_switched_the_environment_unit(enabled: bool) -> None:
    async with paired("attocube-ids", make, {"start_time_s": 0, "ecu_enabled": enabled}) as pair:
        await pair.driver.zero()
        web_page = pair.far.new_session()
        assert ask(web_page, f"com.attocube.ecu.{'disable' if enabled else 'enable'}") == [0]
        with pytest.raises(RefusedError, match=f"switched {'off' if enabled else 'on'} since the connection"):
            await pair.driver.zero()
        await pair.driver.connect()
        assert pair.driver.compensated == ("none" if enabled else "instrument")
        await pair.driver.zero()


@pytest.mark.parametrize("dialect", ["ids", "sen"])
async def test_a_reset_by_somebody_else_ends_the_count(dialect: str) -> None:
    options: dict[str, str | int | bool] = {"start_time_s": 0, "dialect": dialect}
    async with paired("attocube-ids", lambda t, c: make(t, c, dialect=dialect), options) as pair:
        await pair.driver.zero()
        go(pair.bench, aimed(20.01, 30.01))
        assert not (await pair.driver.status()).beam_lost
        web_page = pair.far.new_session()
        assert ask(web_page, f"com.attocube.{dialect}.system.resetAxis", 0) == [0]
        status = await pair.driver.status()
        assert status.beam_lost
        assert status.beam_ok
        await pair.driver.zero()
        assert not (await pair.driver.status()).beam_lost


async def test_an_instrument_reporting_no_reference_is_used_without(monkeypatch: pytest.MonkeyPatch) -> None:
    def without(self: AttocubeIds, method: str) -> str:
        return "com.attocube.ids.displacement.none" if "getReference" in method else full(self, method)

    full = AttocubeIds._full  # noqa: SLF001  # the method that names requests
    monkeypatch.setattr(AttocubeIds, "_full", without)
    async with paired("attocube-ids", make, {"start_time_s": 0}) as pair:
        await pair.driver.zero()
        status = await pair.driver.status()
        assert status.beam_ok
        assert not status.beam_lost


async def test_nothing_is_read_when_the_measurement_does_not_run() -> None:
    async with paired("attocube-ids", make, {"start_time_s": 0}) as pair:
        web_page = pair.far.new_session()
        assert ask(web_page, "com.attocube.ids.system.stopMeasurement") == [0]
        with pytest.raises(RefusedError, match="mode 'system idle'"):
            await pair.driver.read()


async def test_nothing_is_read_while_another_client_makes_a_table() -> None:
    async with paired("attocube-ids", make, {"start_time_s": 0, "nlc_time_s": 5}) as pair:
        await pair.driver.zero()
        waiting = send(pair.far.new_session(), "com.attocube.ids.nlc.createLut", 0)
        with pytest.raises(RefusedError, match="mode 'measurement starting'"):
            await pair.driver.read()
        assert wait(pair.bench, waiting) == [0]
        assert (await pair.driver.status()).beam_lost
        await pair.driver.zero()
        assert not (await pair.driver.status()).beam_lost


async def test_the_wrong_name_space_is_reported() -> None:
    async with paired("attocube-ids", lambda t, c: make(t, c, dialect="sen"), connect=False) as pair:
        with pytest.raises(WrongDeviceError, match=r"com\.attocube\.sen.*setting dialect"):
            await pair.driver.connect()


async def test_a_stranger_is_named_by_its_bytes() -> None:
    async with Peer(lambda _data: [b"SSH-2.0-OpenSSH\r\n"]) as peer:
        driver = make(peer.transport, StepClock())
        with pytest.raises(WrongDeviceError, match=r"not an attocube IDS.*SSH"):
            await driver.connect()
