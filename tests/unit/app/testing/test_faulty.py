"""Links that go wrong: the wrapper itself, and drivers behind it."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.app.testing.faulty import KINDS, SENT_KINDS, Fault, FaultyTransport, random_faults
from catseye.app.testing.memory import MemoryTransport, pipe
from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.counter.profile import CounterProfile, load_profile
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.errors import DeviceError, LinkError
from catseye.drivers.roles.pose import Pose
from tests.patience import HANG_S
from tests.unit.drivers.melfa_bench import Controller
from tests.unit.drivers.peers import Answer, Peer
from tests.unit.drivers.virtual_time import VirtualClock, run

"""Far more than all time-outs of one operation together."""


async def joined(*faults: Fault) -> tuple[FaultyTransport, MemoryTransport]:
    """Return a faulty link and its far end, both open."""
    near, far = pipe("memory://device")
    link = FaultyTransport(near, faults, note="seed 7")
    await link.open()
    await far.open()
    return link, far


async def came(link: FaultyTransport, count: int) -> list[tuple[float, bytes]]:
    """Return chunks with the time at which they came."""
    loop = asyncio.get_running_loop()
    return [(loop.time(), data) for data in [await link.read() for _ in range(count)]]


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        (Fault(9, "drop"), [b"abcd", b"efgh"]),
        (Fault(0, "split"), [b"ab", b"cd", b"efgh"]),
        (Fault(0, "coalesce"), [b"abcdefgh"]),
        (Fault(1, "coalesce"), [b"abcd", b"efgh"]),
        (Fault(0, "delay"), [b"abcd", b"efgh"]),
        (Fault(0, "drop"), [b"efgh"]),
        (Fault(0, "duplicate"), [b"abcd", b"abcd", b"efgh"]),
        (Fault(0, "corrupt"), [b"ab\xe3d", b"efgh"]),
        (Fault(0, "corrupt", mask=1), [b"abbd", b"efgh"]),
        (Fault(0, "foreign", data=b"XY"), [b"abcd", b"XY", b"efgh"]),
    ],
)
def test_what_comes_goes_wrong_as_scripted(fault: Fault, expected: list[bytes]) -> None:
    async def work() -> list[bytes]:
        link, far = await joined(fault)
        await far.write(b"abcd")
        await far.write(b"efgh")
        chunks = [data for _, data in await came(link, len(expected))]
        assert link.waiting() == b""
        await link.close()
        return chunks

    assert run(work()) == expected


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        (Fault(0, "split", "tx"), [b"ab", b"cd", b"efgh"]),
        (Fault(0, "drop", "tx"), [b"efgh"]),
        (Fault(0, "delay", "tx"), [b"abcd", b"efgh"]),
        (Fault(0, "stall", "tx"), []),
    ],
)
def test_what_is_sent_goes_wrong_as_scripted(fault: Fault, expected: list[bytes]) -> None:
    async def work() -> list[bytes]:
        link, far = await joined(fault)
        await link.write(b"abcd")
        await link.write(b"efgh")
        chunks = [await far.read() for _ in expected]
        assert far.waiting() == b""
        await link.close()
        return chunks

    assert run(work()) == expected


def test_a_delay_takes_its_time_and_holds_up_what_follows() -> None:
    async def work() -> float:
        link, far = await joined(Fault(0, "delay", amount_s=0.3))
        await far.write(b"a")
        await far.write(b"b")
        assert link.waiting() == b""
        assert [await link.read(), await link.read()] == [b"a", b"b"]
        await link.close()
        return asyncio.get_running_loop().time()

    assert run(work()) == pytest.approx(0.3)


def test_a_late_reply_precedes_the_next_within_its_connection() -> None:
    async def work() -> None:
        link, far = await joined(Fault(0, "late"), Fault(2, "late"))
        await far.write(b"one")
        assert link.waiting() == b""
        await link.write(b"next?")
        await far.write(b"two")
        assert [await link.read(), await link.read()] == [b"one", b"two"]
        await far.write(b"three")
        assert link.waiting() == b""
        await link.close()
        await link.open()
        await link.write(b"next?")
        assert link.waiting() == b""
        await link.close()

    run(work())


def test_a_stall_ends_with_the_connection() -> None:
    async def work() -> None:
        link, far = await joined(Fault(0, "stall"))
        await far.write(b"lost")
        reading = asyncio.create_task(link.read())
        await asyncio.sleep(0.01)
        await link.write(b"lost too")
        assert not reading.done()
        await link.close()
        with pytest.raises(LinkError, match="was closed"):
            await reading
        await link.open()
        await far.write(b"here")
        assert await link.read() == b"here"
        await link.close()

    run(work())


def test_a_half_closed_peer_still_listens() -> None:
    async def work() -> None:
        link, far = await joined(Fault(0, "half-close"))
        await far.write(b"last")
        assert await link.read() == b"last"
        for look in (link.read, _waiting(link)):
            with pytest.raises(LinkError, match=r"memory://device \(seed 7\): the other side has closed"):
                await look()
        await link.write(b"STOP")
        assert await far.read() == b"STOP"
        await link.close()

    run(work())


def _waiting(link: FaultyTransport) -> Callable[[], Awaitable[bytes]]:
    async def look() -> bytes:
        return link.waiting()

    return look


def test_only_some_faults_fit_what_is_sent() -> None:
    with pytest.raises(ValueError, match="cannot have 'duplicate', only split, delay, drop, stall"):
        Fault(0, "duplicate", "tx")


def test_random_faults_come_again_with_their_seed() -> None:
    assert random_faults(7) == random_faults(7) != random_faults(8)
    assert 100 < len(random_faults(7)) < 300
    assert {fault.kind for fault in random_faults(7)} == set(KINDS) - {"foreign"}
    assert {fault.at for fault in random_faults(7, chunks=3, rate=1.0)} == {0, 1, 2}


def faults(foreign: bytes) -> st.SearchStrategy[list[Fault]]:
    """Return scripts of faults that a driver can notice (see the table of `catseye.app.testing.faulty`)."""
    amounts = st.sampled_from([0.001, 0.03, 0.2])
    received = st.builds(
        Fault,
        st.integers(0, 30),
        st.sampled_from(KINDS),
        st.just("rx"),
        amounts,
        st.just(0x80),
        st.just(foreign),
    )
    sent = st.builds(Fault, st.integers(0, 30), st.sampled_from(SENT_KINDS), st.just("tx"), amounts)
    return st.lists(received | sent, max_size=12)


def by_lines(end: bytes, answer: Answer) -> Answer:
    """Return a device that takes requests cut anywhere; a hang-up forgets half a request."""
    buffer = b""

    def take(data: bytes) -> Iterable[bytes]:
        nonlocal buffer
        *lines, buffer = (buffer + data).split(end)
        return [chunk for line in lines for chunk in answer(line + end)]

    return take


class NumberedCounter:
    """A line counter that shows the number of times it was read: each answer belongs to one question."""

    def __init__(self) -> None:
        self.reads = 0

    def answer(self, data: bytes) -> Iterable[bytes]:
        match data.strip():
            case b"R":
                self.reads += 1
                return [b"%+014.6f mm\r\n" % self.reads]
            case b"I":
                return [b"EMULATOR line counter 1\r\n"]
            case b"S":
                return [b"10\r\n"]
            case b"L":
                return [b"87\r\n"]
        return [b"E01\r\n"]


def patient_profile() -> CounterProfile:
    """Return the default profile with a short time-out."""
    tables = load_profile("default").model_dump(exclude_none=True)
    tables["line"]["timeout_s"] = 0.1
    return CounterProfile.model_validate(tables)


PROFILE = patient_profile()


@settings(max_examples=150)
@given(script=faults(b"+000099.000000 mm\r\n"))
def test_no_fault_makes_the_counter_take_a_foreign_answer(script: list[Fault]) -> None:
    run(read_through(script))


@pytest.mark.parametrize("seed", range(20))
def test_random_faults_never_make_the_counter_take_foreign_answers(seed: int) -> None:
    run(read_through(random_faults(seed, rate=0.3)))


async def read_through(script: list[Fault]) -> None:
    device = NumberedCounter()
    async with Peer(by_lines(b"\r\n", device.answer)) as peer:
        counter = LineCounter(FaultyTransport(peer.transport, script), VirtualClock(), PROFILE, quiet_s=0.001)
        for _ in range(12):
            async with asyncio.timeout(HANG_S):
                before = device.reads
                try:
                    await counter.connect()
                    before = device.reads
                    shown = (await counter.read()).displacement_mm
                    assert before < shown <= device.reads
                    assert not (await counter.status()).overspeed
                    before = device.reads
                    shown = (await counter.read()).displacement_mm
                    assert before < shown <= device.reads
                except DeviceError:
                    continue
        # Once the script is through, everything works again.
        await counter.close()


QUICK = MelfaSettings(quiet_s=0.001, answer_timeout_s=0.1, move_timeout_s=1.0, stop_timeout_s=1.0)


@settings(max_examples=150)
@given(
    script=faults(b"QoKJ1;99.00;J2;99.00;J3;0.00;J4;0.00;;****,****;20;0.00;00000000\r"),
    aside=faults(b"QoK\r"),
    suffix=st.sampled_from(["", "\r", "\r\n"]),
)
def test_no_fault_repeats_a_motion_or_mismatches_an_answer(
    script: list[Fault], aside: list[Fault], suffix: str
) -> None:
    run(move_through(script, aside, suffix))


@pytest.mark.parametrize("seed", range(20))
def test_no_random_fault_moves_the_robot_twice(seed: int) -> None:
    run(move_through(random_faults(seed, rate=0.2), random_faults(seed + 1000, rate=0.2), "\r"))


async def move_through(script: list[Fault], aside: list[Fault], suffix: str) -> None:
    controller = Controller()
    controller.suffix = suffix
    async with (
        Peer(by_lines(b"\r", controller.answer), endpoint="memory://robot") as main,
        Peer(by_lines(b"\r", controller.answer), endpoint="memory://stop") as beside,
    ):
        robot = MelfaR3(
            FaultyTransport(main.transport, script),
            FaultyTransport(beside.transport, aside),
            VirtualClock(),
            QUICK,
        )
        for number in range(1, 9):
            await one_move(
                robot, controller, [main, beside], (float(number), -float(number), 0.0, 2.0 * number)
            )
        await robot.close()


async def one_move(robot: MelfaR3, controller: Controller, peers: list[Peer], target: Pose) -> None:
    """Connect if need be, move, ask where the robot is; check what comes back against the controller itself."""
    async with asyncio.timeout(HANG_S):
        moves = motions(peers)
        try:
            if target[0] % 3 == 1.0:
                await robot.connect()
            await robot.move_joints(target)
            assert controller.at == target
            assert await robot.joints() == controller.at
            assert (await robot.status()).servo_on
        except DeviceError:
            pass
        assert motions(peers) - moves <= 1
        try:
            await robot.stop()
        except DeviceError:
            return


def motions(peers: list[Peer]) -> int:
    """Return how many motions the controller received."""
    said = [b"".join(peer.requests) for peer in peers]
    return sum(text.count(b"EXEC2=MOV") + text.count(b"EXECMOV") for text in said)
