"""The line counter's dialect: driver and emulator are held to the same bytes."""

from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.counter.profile import load_profile
from catseye.simulators.ports.session import Session
from tests.transcripts import line_counter as transcript
from tests.unit.drivers.interferometers.pairs import new_session, quiet_world
from tests.unit.drivers.peers import Peer, StepClock


def talk(session: Session, data: bytes) -> bytes:
    session.feed(data)
    answer = session.answer()
    assert isinstance(answer, bytes)
    return answer


def test_the_emulator_keeps_to_the_transcript() -> None:
    world = quiet_world()
    session = new_session(world, "line-counter")
    assert talk(session, transcript.ZERO) == transcript.DONE
    assert talk(session, transcript.QUERY) == transcript.AT_ZERO
    assert talk(session, transcript.STATUS) == transcript.READY
    world.beam_bench.beam.block(0.5)
    assert talk(session, transcript.STATUS) == transcript.BROKEN
    world.beam_bench.advance(1.0)
    assert talk(session, transcript.STATUS) == transcript.RETURNED


async def test_the_driver_keeps_to_the_transcript() -> None:
    bits = transcript.READY
    answers = {transcript.QUERY: transcript.AT_ZERO, transcript.ZERO: transcript.DONE}

    def answer(data: bytes) -> list[bytes]:
        return [answers.get(data, bits if data == transcript.STATUS else b"50\r\n")]

    async with Peer(answer) as peer:
        counter = LineCounter(peer.transport, StepClock(), load_profile("default"), quiet_s=0.001)
        await counter.connect()
        assert await counter.zero() == 1
        assert (await counter.read()).displacement_mm == 0.0
        assert not (await counter.status()).beam_lost
        bits = transcript.BROKEN
        assert not (await counter.status()).beam_ok
        bits = transcript.RETURNED
        status = await counter.status()
        assert (status.beam_ok, status.beam_lost) == (True, True)
        await counter.close()
