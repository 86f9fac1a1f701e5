"""The line counter against a scripted one that speaks the dialect of the default profile."""

from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager
from typing import Any

import pytest

from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.counter.profile import CounterProfile, load_profile
from catseye.drivers.roles.errors import (
    LinkTimeoutError,
    ProfileError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from tests.unit.drivers.peers import Peer, StepClock

QUIET_S = 0.001


class Counter:
    """Speaks the dialect: R value, Z zero, S status, L level, I identification, anything else E01."""

    def __init__(self) -> None:
        self.lines: dict[str, Callable[[], Iterable[str]]] = {}
        self.shown = "+000012.345678 mm"
        self.bits = "10"

    def answer(self, data: bytes) -> Iterable[bytes]:
        command = data.decode().removesuffix("\r\n")
        usual = {"R": self.shown, "Z": "OK", "S": self.bits, "L": "87", "I": "EMULATOR line counter 1"}
        lines = self.lines.get(command, lambda: [usual.get(command, "E01")])()
        return [f"{line}\r\n".encode() for line in lines]


def profile(**changes: dict[str, Any]) -> CounterProfile:
    """Return the default profile with changed tables."""
    tables = load_profile("default").model_dump(exclude_none=True)
    for name, table in changes.items():
        tables[name] = tables.get(name, {}) | table
    return CounterProfile.model_validate(tables)


@asynccontextmanager
async def connected(
    device: Counter | None = None, used: CounterProfile | None = None, *, connect: bool = True
) -> AsyncIterator[tuple[LineCounter, Counter, Peer, StepClock]]:
    device = device or Counter()
    clock = StepClock()
    async with Peer(device.answer, endpoint="memory://counter") as peer:
        counter = LineCounter(peer.transport, clock, used or profile(), quiet_s=QUIET_S)
        if connect:
            await counter.connect()
        yield counter, device, peer, clock
        await counter.close()


async def test_connecting_returns_the_identity() -> None:
    async with connected(connect=False) as (counter, _, peer, _):
        identity = await counter.connect()
        assert identity.model == "line counter: EMULATOR line counter 1"
        assert identity.simulated
        assert counter.notes == ()
        assert counter.compensated == "instrument"
        assert peer.requests == [b"I\r\n", b"R\r\n"]


async def test_the_distax_profile_says_that_it_has_to_be_confirmed() -> None:
    async with connected(used=load_profile("distax"), connect=False) as (counter, _, _, _):
        identity = await counter.connect()
        claim = "DISTAX via user profile; protocol not published: complete and confirm the profile with the manual"
        assert identity.model == f"{claim}: EMULATOR line counter 1"
        assert counter.notes == (claim,)
        assert counter.compensated == "none"


async def test_the_vacuum_profile_leaves_the_air_to_the_program() -> None:
    async with connected(used=load_profile("vacuum")) as (counter, _, _, _):
        assert counter.compensated == "none"
        assert counter.notes == ()


async def test_a_counter_without_identification_is_known_by_its_values() -> None:
    used = CounterProfile.model_validate(load_profile("default").model_dump(exclude={"identify"}))
    async with connected(used=used, connect=False) as (counter, _, peer, _):
        identity = await counter.connect()
        assert (identity.model, identity.simulated) == ("line counter", False)
        assert peer.requests == [b"R\r\n"]


async def test_a_reading_has_displacement_raw_text_and_time() -> None:
    async with connected() as (counter, _, _, clock):
        clock.time_s = 123.5
        reading = await counter.read()
        assert (reading.displacement_mm, reading.raw, reading.time_s) == (
            12.345678,
            "+000012.345678 mm",
            123.5,
        )


async def test_status_is_bits_and_level() -> None:
    async with connected() as (counter, _, peer, _):
        status = await counter.status()
        assert (status.beam_ok, status.beam_lost, status.overspeed) == (True, False, False)
        assert (status.laser_ready, status.signal) == (True, 0.87)
        assert peer.requests[2:] == [b"S\r\n", b"L\r\n"]


async def test_a_lost_beam_stays_lost_until_the_next_zero() -> None:
    """Sheet, section 8: a returning beam does not make old counts valid; only a zero clears."""
    async with connected() as (counter, device, _, _):
        device.bits = "14"
        status = await counter.status()
        assert (status.beam_ok, status.beam_lost) == (False, True)
        # This instrument forgets; the driver does not.
        device.bits = "10"
        status = await counter.status()
        assert (status.beam_ok, status.beam_lost) == (True, True)
        assert await counter.zero() == 1
        assert not (await counter.status()).beam_lost


async def test_overspeed_stays_until_the_next_zero() -> None:
    async with connected() as (counter, device, _, _):
        device.bits = "12"
        assert (await counter.status()).overspeed
        device.bits = "10"
        assert (await counter.status()).overspeed
        await counter.zero()
        assert not (await counter.status()).overspeed


async def test_a_latch_that_the_zero_does_not_clear_is_reported() -> None:
    async with connected() as (counter, device, _, _):
        device.bits = "11"
        await counter.zero()
        status = await counter.status()
        assert (status.beam_ok, status.beam_lost) == (True, True)


async def test_zeros_are_numbered() -> None:
    async with connected() as (counter, _, peer, _):
        assert [await counter.zero(), await counter.zero()] == [1, 2]
        assert peer.requests.count(b"Z\r\n") == 2


async def test_a_refused_zero_is_no_zero() -> None:
    async with connected() as (counter, device, _, _):
        device.bits = "14"
        device.lines["Z"] = lambda: ["E02"]
        await counter.status()
        with pytest.raises(
            RefusedError, match=r"line counter at memory://counter refused 'Z' with 'E02'.*manual"
        ) as e:
            await counter.zero()
        assert e.value.number == 2
        assert (await counter.status()).beam_lost
        del device.lines["Z"]
        assert await counter.zero() == 1


async def test_a_zero_whose_answer_is_lost_is_sent_again() -> None:
    async with connected(used=profile(line={"timeout_s": 0.1})) as (counter, device, peer, _):
        answers = iter([[], ["OK"]])
        device.lines["Z"] = lambda: next(answers)
        assert await counter.zero() == 1
        assert peer.requests.count(b"Z\r\n") == 2
        assert not (await counter.status()).beam_lost


async def test_a_zero_refused_after_a_lost_answer_spoils_the_count() -> None:
    """The first one may have been taken, and the count before it is gone then."""
    async with connected(used=profile(line={"timeout_s": 0.1})) as (counter, device, _, _):
        await counter.zero()
        answers = iter([[], ["E03"]])
        device.lines["Z"] = lambda: next(answers)
        with pytest.raises(RefusedError):
            await counter.zero()
        assert (await counter.status()).beam_lost


async def test_an_unanswered_zero_invalidates_the_count() -> None:
    """The instrument may have zeroed, and nothing shows it, since the link heals in place."""
    async with connected(used=profile(line={"timeout_s": 0.1})) as (counter, device, _, _):
        await counter.zero()
        device.lines["Z"] = list
        with pytest.raises(LinkTimeoutError):
            await counter.zero()
        assert (await counter.read()).zero_id == 1
        assert (await counter.status()).beam_lost
        del device.lines["Z"]
        await counter.zero()
        assert not (await counter.status()).beam_lost


async def test_a_zero_with_a_strange_answer_is_a_protocol_error() -> None:
    async with connected() as (counter, device, _, _):
        device.lines["Z"] = lambda: ["12.5 mm"]
        with pytest.raises(ProtocolError, match=r"'Z' was answered by '12\.5 mm'"):
            await counter.zero()


async def test_a_zero_without_answer() -> None:
    """Sheet, section 9: the zero's reply may be empty."""
    async with connected(used=profile(zero={"reply": ""})) as (counter, device, peer, _):
        device.lines["Z"] = list
        assert await counter.zero() == 1
        assert (await counter.read()).displacement_mm == 12.345678
        assert peer.requests[2:] == [b"Z\r\n", b"R\r\n"]


async def test_a_software_zero_is_an_offset() -> None:
    async with connected(used=profile(zero={"mode": "software"})) as (counter, device, peer, _):
        await counter.zero()
        assert (await counter.read()).displacement_mm == 0.0
        device.shown = "+000013.345678 mm"
        assert (await counter.read()).displacement_mm == pytest.approx(1.0, abs=1e-12)
        await counter.zero()
        assert (await counter.read()).displacement_mm == 0.0
        assert b"Z\r\n" not in peer.requests


async def test_counts_are_scaled_turned_and_unwrapped() -> None:
    scale = {"unit": "count", "count_mm": 1e-5, "sign": -1, "wrap_bits": 24}
    device = Counter()
    device.shown = "0"
    async with connected(device, profile(scale=scale)) as (counter, _, _, _):
        await counter.zero()
        for shown, displacement_mm in (("8000000", -80.0), ("16000000", -160.0), ("500000", -172.77216)):
            device.shown = shown
            assert (await counter.read()).displacement_mm == pytest.approx(displacement_mm, abs=1e-9)


async def test_another_unit_than_the_profiles_is_refused() -> None:
    async with connected() as (counter, device, _, _):
        device.shown = "+0.5 in"
        with pytest.raises(
            ProtocolError, match="shows 'in', the profile says unit = 'mm': check the profile"
        ):
            await counter.read()


async def test_an_error_line_names_profile_and_remedy() -> None:
    async with connected() as (counter, device, _, _):
        device.shown = "E04"
        with pytest.raises(
            RefusedError, match=r"refused 'R' with 'E04': look .*profile \(line counter\)"
        ) as caught:
            await counter.read()
        assert caught.value.number == 4


async def test_a_question_refused_once_is_asked_again() -> None:
    """It may have been garbled on its way."""
    async with connected() as (counter, device, _, _):
        answers = iter([["E01"]])
        device.lines["R"] = lambda: next(answers, ["+000012.345678 mm"])
        assert (await counter.read()).displacement_mm == 12.345678


async def test_status_e1_is_a_status_and_no_error() -> None:
    async with connected() as (counter, device, _, _):
        device.bits = "E1"
        status = await counter.status()
        assert (status.beam_lost, status.laser_ready) == (True, False)


async def test_a_status_of_another_layout_is_a_protocol_error() -> None:
    async with connected() as (counter, device, _, _):
        device.bits = "ready"
        with pytest.raises(ProtocolError, match="'S' was answered by 'ready'"):
            await counter.status()


async def test_without_signal_command_the_level_follows_the_beam() -> None:
    used = CounterProfile.model_validate(load_profile("default").model_dump(exclude={"signal"}))
    async with connected(used=used) as (counter, device, _, _):
        assert (await counter.status()).signal == 1.0
        device.bits = "14"
        assert (await counter.status()).signal == 0.0


async def test_the_level_stays_within_its_scale() -> None:
    async with connected() as (counter, device, _, _):
        device.lines["L"] = lambda: ["120"]
        assert (await counter.status()).signal == 1.0


async def test_echo_and_gap_are_kept() -> None:
    used = profile(line={"echo": True, "gap_s": 0.25})
    device = Counter()
    device.lines = {"I": lambda: ["I", "counter"], "R": lambda: ["R", "+1.5 mm"]}
    async with connected(device, used, connect=False) as (counter, _, _, clock):
        await counter.connect()
        before = clock.time_s
        assert (await counter.read()).displacement_mm == 1.5
        assert clock.time_s - before == 0.25


@pytest.mark.parametrize("first", ["SSH-2.0-OpenSSH_9.2", "QeR601000000", "E01"])
async def test_a_stranger_is_named_by_its_first_bytes(first: str) -> None:
    device = Counter()
    device.lines = {"I": lambda: [first], "R": lambda: [first]}
    async with connected(device, connect=False) as (counter, _, peer, _):
        with pytest.raises(
            WrongDeviceError, match=rf"memory://counter: .*does not fit the profile.*{first[:6]}"
        ):
            await counter.connect()
        assert not peer.transport.is_open


async def test_a_counter_without_beam_or_value_can_connect() -> None:
    device = Counter()
    device.shown = "E02"
    async with connected(device, connect=False) as (counter, _, _, _):
        assert (await counter.connect()).simulated


async def test_a_silent_port_is_a_timeout() -> None:
    device = Counter()
    device.lines["I"] = list
    async with connected(device, profile(line={"timeout_s": 0.1}), connect=False) as (counter, _, _, _):
        with pytest.raises(LinkTimeoutError, match=r"no answer to b'I\\r\\n' within 0.1 s"):
            await counter.connect()


async def test_a_lost_answer_is_asked_for_again_after_healing() -> None:
    answers = iter([["+1.0 mm"], [], ["+2.0 mm"], ["+3.0 mm"]])
    device = Counter()
    device.lines["R"] = lambda: next(answers)
    async with connected(device, profile(line={"timeout_s": 0.1})) as (counter, _, peer, _):
        assert (await counter.read()).displacement_mm == 2.0
        assert peer.requests == [b"I\r\n", b"R\r\n", b"R\r\n", b"I\r\n", b"R\r\n"]
        # The instrument has reported its name on the open link: its count has gone on.
        assert not (await counter.status()).beam_lost


async def test_a_count_is_invalid_after_the_link_healed() -> None:
    """The counter started anew meanwhile: it shows 0 and a clean status, and only a zero makes that good."""
    async with connected(used=profile(line={"timeout_s": 0.1})) as (counter, device, peer, _):
        await counter.zero()
        assert not (await counter.status()).beam_lost
        device.shown = "+000000.000000 mm"
        await peer.far.close()
        await peer.far.open()
        assert (await counter.read()).displacement_mm == 0.0
        status = await counter.status()
        assert (status.beam_ok, status.beam_lost) == (True, True)
        await counter.zero()
        assert not (await counter.status()).beam_lost


async def test_a_new_connection_invalidates_the_count() -> None:
    async with connected() as (counter, _, _, _):
        await counter.zero()
        await counter.close()
        await counter.connect()
        assert (await counter.status()).beam_lost
        await counter.zero()
        assert not (await counter.status()).beam_lost


async def test_a_connection_that_failed_has_no_count_to_lose() -> None:
    device = Counter()
    device.lines["I"] = lambda: ["SSH-2.0-OpenSSH_9.2"]
    device.lines["R"] = device.lines["I"]
    async with connected(device, connect=False) as (counter, _, _, _):
        with pytest.raises(WrongDeviceError):
            await counter.connect()
        device.lines.clear()
        await counter.connect()
        assert not (await counter.status()).beam_lost


async def test_healing_between_status_and_level_loses_the_beam() -> None:
    """A counter that reports no name proves nothing on the open link: it is opened again."""
    answers = iter([[], ["87"]])
    device = Counter()
    device.lines["L"] = lambda: next(answers)
    nameless = profile(line={"timeout_s": 0.1}).model_copy(update={"identify": None})
    async with connected(device, nameless) as (counter, _, _, _):
        assert (await counter.status()).beam_lost


async def test_another_counter_after_healing_is_refused() -> None:
    async with connected(used=profile(line={"timeout_s": 0.1})) as (counter, device, _, _):
        device.lines["R"] = list
        device.lines["I"] = lambda: ["another counter"]
        with pytest.raises(
            WrongDeviceError, match="'another counter' answers instead of 'EMULATOR line counter 1'"
        ):
            await counter.read()


def test_wrong_settings_are_reported_before_anything_is_opened() -> None:
    with pytest.raises(ProfileError, match="built-in profiles: default, distax"):
        LineCounter.at("tcp://127.0.0.1:1", StepClock(), profile="nothing")
    assert LineCounter.at("tcp://127.0.0.1:1", StepClock(), profile="distax").notes
