"""Who may work by hand, one thing at a time, and what becomes of it when its client loses control."""

import asyncio
from dataclasses import replace
from functools import partial

import pytest

from catseye.app.errors import ArmInUseError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.answers import Answer, LinkTaken
from catseye.app.service.errors import RefusedError
from catseye.app.service.watching.bench_facts import DeviceFacts
from catseye.drivers.roles.errors import LinkError
from tests.unit.app.service.manual.played_engine import Engine, played
from tests.unit.app.service.manual.timed_arm import TimedArm


def test_each_jog_counts_however_short_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        for _ in range(2):
            await engine.jog()
            await engine.jog(on=False)
        assert (engine.manual.begun, engine.manual.occupied) == (2, None)

    played(script, monkeypatch)


def test_nothing_begins_during_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        engine.busy = RefusedError("a run is under way")
        with pytest.raises(RefusedError, match="a run is under way"):
            engine.jog()
        with pytest.raises(RefusedError, match="a run is under way"):
            engine.raw()

    assert played(script, monkeypatch).arm.log == []


def test_what_is_under_way_is_shown_from_the_start(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        begun = engine.jog()
        assert "Ada (test-1) moves the arm by hand" in str(engine.manual.occupied)
        for again in (engine.jog, engine.raw):
            with pytest.raises(RefusedError, match="moves the arm by hand: end that first"):
                again()
        await begun
        await engine.jog(on=False)
        assert engine.manual.occupied is None
        await engine.raw()
        with pytest.raises(RefusedError, match="link of interferometer is open for raw bytes: give it back"):
            engine.jog()
        with pytest.raises(RefusedError, match="give it back first"):
            engine.raw()

    played(script, monkeypatch)


def test_without_a_jog_nothing_is_moved_and_nothing_to_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        for ask in (lambda: engine.step(1.0), lambda: engine.hold(1)):
            with pytest.raises(RefusedError, match="begin that first"):
                ask()
        assert engine.hold(0) == Answer()
        assert not engine.manual.stop("Ben stopped it")
        assert not engine.manual.abort("Ben aborted it")
        assert await engine.jog(on=False) == Answer()

    assert played(script, monkeypatch).arm.log == []


@pytest.mark.parametrize("how", ["release", "hand over", "force", "left", "lost"])
@pytest.mark.parametrize("moving", ["step", "hold", "no"])
def test_the_arm_stops_when_its_client_loses_control(
    monkeypatch: pytest.MonkeyPatch, how: str, moving: str
) -> None:
    async def script(engine: Engine) -> None:
        await engine.jog()
        if moving == "step":
            engine.step(80.0).add_done_callback(lambda done: done.exception())
        elif moving == "hold":
            await engine.hold(1)
        await asyncio.sleep(0.05)
        lost_s = asyncio.get_running_loop().time()
        match how:
            case "release":
                engine.registry.lease.release(engine.ada)
            case "hand over":
                engine.registry.lease.hand_over(engine.ben)
            case "force":
                engine.registry.lease.take(engine.ben, force=True)
            case "left":
                engine.registry.leave(engine.ada, None)
            case _:
                engine.registry.leave(engine.ada, "it closed the connection")
        await asyncio.sleep(0.5)
        assert next(time_s for time_s, text in engine.arm.log if text == "stop") == lost_s
        await asyncio.sleep(1.0)
        assert engine.manual.occupied is None

    engine = played(script, monkeypatch)
    assert engine.arm.said("servo")[-1] == "servo off"
    assert engine.fixture.events("jog")[-1]["reason"] == "Ada (test-1) no longer holds control"


def test_somebody_elses_loss_of_control_means_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.jog()
        engine.registry.leave(engine.ben, "it closed the connection")
        await asyncio.sleep(1.0)
        assert engine.manual.occupied is not None

    played(script, monkeypatch)


def test_only_an_aborted_jog_has_to_be_cleared(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.jog()
        assert engine.manual.stop("Ben stopped it")
        assert engine.manual.stop("Ben stopped it")
        await engine.jog(on=False)
        assert engine.aborts == []
        await engine.jog()
        assert engine.manual.abort("Ben aborted it")
        await engine.jog(on=False)
        assert engine.aborts == ["Ben aborted it"]

    played(script, monkeypatch)


def test_bytes_go_out_and_what_comes_is_recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        assert await engine.raw() == LinkTaken(endpoint="memory://counter")
        assert engine.fixture.detached_now == ["interferometer"]
        assert await engine.send("610d") == Answer()
        await asyncio.sleep(0.01)
        assert engine.fixture.wire == [("interferometer", "tx", b"a\r"), ("interferometer", "rx", b"A\r")]
        assert await engine.raw(on=False) == Answer()
        assert engine.fixture.detached_now == []
        assert await engine.raw(on=False) == Answer()
        with pytest.raises(RefusedError, match="was not taken: take it first"):
            engine.send("61")

    events = played(script, monkeypatch).fixture.events("raw")
    assert [event["on"] for event in events] == [True, False]
    assert events[1]["reason"] == "Ada (test-1) gave it back"


WRITTEN_STOP = ("robot", "tx", b"\r1;1;STOP\r")


def test_several_links_may_be_open(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw("interferometer")
        await engine.raw("robot")
        assert engine.fixture.detached_now == ["interferometer", "robot"]
        await engine.raw("robot", on=False)

    # What was started by hand goes on at the operator's word: no stop is sent.
    assert played(script, monkeypatch).arm.said("stop") == []


@pytest.mark.parametrize(
    ("typed", "code", "text"),
    [(None, ExitCode.USAGE, "may move the arm"), ("x", ExitCode.SAFETY, "names 'x'")],
)
def test_a_real_robot_is_sent_nothing_without_the_cells_name(
    monkeypatch: pytest.MonkeyPatch, typed: str | None, code: ExitCode, text: str
) -> None:
    async def script(engine: Engine) -> None:
        engine.arm.simulated = False
        with pytest.raises(RefusedError, match=text) as refused:
            await engine.raw("robot", arm=typed)
        assert refused.value.code == code
        await asyncio.sleep(0)
        await engine.raw("robot", arm="lab-1")

    # The link that was let in is cut off by the end of the engine.
    assert played(script, monkeypatch).fixture.wire == [WRITTEN_STOP]


def test_a_link_that_cannot_be_had_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        with pytest.raises(RefusedError, match="no device 'nothing'; there are robot, interferometer"):
            await engine.raw("nothing")
        engine.wire.open_error = LinkError("memory://counter: refused")
        with pytest.raises(RefusedError, match="refused") as refused:
            await engine.raw()
        assert refused.value.code == ExitCode.DEVICE

    assert played(script, monkeypatch).fixture.announced == []


def test_a_link_that_breaks_is_reported_and_given_back(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw()
        engine.wire.breaks()
        await asyncio.sleep(0.01)
        assert engine.manual.occupied is None

    last = played(script, monkeypatch).fixture.events("raw")[-1]
    assert (last["on"], last["reason"]) == (False, "the other side has closed the link")


def test_a_device_that_takes_no_bytes_gives_its_link_back(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw()
        engine.wire.stuck = True
        with pytest.raises(RefusedError, match="interferometer does not take the bytes"):
            await engine.send("61")
        await asyncio.sleep(0.01)
        assert engine.manual.occupied is None

    played(script, monkeypatch)


def test_losing_the_raw_bytes_client_stops_the_robot(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw("robot")
        engine.registry.leave(engine.ada, "it closed the connection")
        await asyncio.sleep(1.0)
        assert engine.manual.occupied is None

    engine = played(script, monkeypatch)
    assert engine.arm.said("stop") == ["stop"]
    assert engine.fixture.events("warning") == []


@pytest.mark.parametrize("how", ["stop", "lost"])
def test_another_robot_of_the_cell_is_stopped_likewise(monkeypatch: pytest.MonkeyPatch, how: str) -> None:
    other = TimedArm()

    async def script(engine: Engine) -> None:
        second = DeviceFacts("second", "memory://second", "melfa-r3")
        facts = engine.fixture.facts_now
        engine.fixture.facts_now = replace(facts, devices=(*facts.devices, second))
        engine.fixture.robots["second"] = other
        with pytest.raises(RefusedError, match="what is sent to second may move the arm"):
            await engine.raw("second")
        await asyncio.sleep(0)
        await engine.raw("second", arm="lab-1")
        if how == "stop":
            assert engine.manual.stop("Ben stopped it")
        else:
            engine.registry.leave(engine.ada, "it closed the connection")
        await asyncio.sleep(1.0)

    engine = played(script, monkeypatch)
    assert engine.arm.log == []
    assert other.said("stop") == ["stop"]
    assert engine.fixture.events("warning") == []


@pytest.mark.parametrize("word", ["stop", "abort"])
def test_a_stop_reaches_a_robot_that_is_sent_raw_bytes(monkeypatch: pytest.MonkeyPatch, word: str) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw("interferometer")
        assert not engine.manual.stop("Ben stopped it")
        await engine.raw("robot")
        assert getattr(engine.manual, word)("Ben stopped it")
        await asyncio.sleep(1.0)
        assert engine.fixture.detached_now == ["interferometer"]

    assert played(script, monkeypatch).arm.said("stop") == ["stop"]


@pytest.mark.parametrize("word", ["stop", "abort", "release"])
def test_a_stop_reaches_a_robot_while_its_link_returns(monkeypatch: pytest.MonkeyPatch, word: str) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw("robot")
        engine.wire.closing_s = 0.5
        given_back = engine.raw("robot", on=False)
        await asyncio.sleep(0.1)
        if word == "release":
            engine.registry.lease.release(engine.ada)
        else:
            assert getattr(engine.manual, word)("Ben stopped it")
        await given_back
        assert not engine.manual.stop("Ben stopped it")

    # Control that is given up after the link is no stop: what was started goes on at the operator's word.
    wanted = [] if word == "release" else ["stop"]
    assert played(script, monkeypatch).arm.said("stop") == wanted


def test_an_arm_is_given_back_after_its_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever takes it next must not meet that STOP."""
    stops_before: list[list[str]] = []

    async def script(engine: Engine) -> None:
        let_go = engine.guard.let_go

        async def noted() -> None:
            stops_before.append(engine.arm.said("stop"))
            await let_go()

        monkeypatch.setattr(engine.guard, "let_go", noted)
        await engine.raw("robot")
        engine.registry.leave(engine.ada, "it closed the connection")
        await asyncio.sleep(1.0)

    assert played(script, monkeypatch).arm.said("stop") == ["stop"]
    assert stops_before == [["stop"]]


def test_a_robot_not_stoppable_after_raw_bytes_warns(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw("robot")
        engine.fixture.acquire_error = RefusedError("the robot is not connected")
        engine.registry.leave(engine.ada, "it closed the connection")
        await asyncio.sleep(1.0)

    warned = played(script, monkeypatch).fixture.events("warning")
    assert "whether the arm of robot moves is not known: look at it" in str(warned[0]["text"])


def test_a_link_that_is_ended_in_its_first_moment_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        begun = engine.raw("robot", arm="lab-1")
        assert engine.manual.stop("Ben stopped it")
        with pytest.raises(RefusedError, match="Ben stopped it"):
            async with asyncio.timeout(1.0):
                await begun

    assert played(script, monkeypatch).wire.sink is None


def test_whatever_keeps_a_robot_from_being_stopped_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw("robot")
        engine.fixture.acquire_error = ValueError("no number: b'?'")
        engine.registry.leave(engine.ada, "it closed the connection")
        await asyncio.sleep(1.0)
        assert engine.manual.occupied is None

    engine = played(script, monkeypatch)
    text = str(engine.fixture.events("warning")[0]["text"])
    assert "whether the arm of robot moves is not known: look at it" in text
    assert engine.aborts == [text]


def test_a_guard_stop_ends_a_jog_and_must_be_cleared(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.jog()
        engine.fixture.guard.stops("the guard stopped the arm")
        await asyncio.sleep(1.0)
        assert engine.manual.occupied is None

    engine = played(script, monkeypatch)
    assert engine.aborts == ["the guard stopped the arm"]
    assert engine.fixture.guard.calls == ["hold moved by hand", "let go"]


def test_an_arm_of_another_program_is_not_moved_by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        engine.fixture.guard.refusal = engine.guard.refusal = ArmInUseError("in use by process 7")
        for begin in (engine.jog, partial(engine.raw, "robot")):
            with pytest.raises(RefusedError, match="process 7") as refused:
                await begin()
            assert refused.value.code == ExitCode.DEVICE
            await asyncio.sleep(1.0)

    assert played(script, monkeypatch).arm.log == []


def test_a_guard_stop_ends_raw_bytes_and_must_be_cleared(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        await engine.raw("robot")
        engine.guard.stops("the guard stopped the arm")
        with pytest.raises(RefusedError):
            await engine.send("31", "robot")
        await asyncio.sleep(1.0)

    engine = played(script, monkeypatch)
    assert engine.aborts == ["the guard stopped the arm"]
    # On the open link first: its driver has yet to connect.
    assert engine.fixture.wire == [WRITTEN_STOP]
    assert engine.arm.said("stop") == ["stop"]


def test_raw_bytes_are_stopped_with_the_settings_of_the_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    async def script(engine: Engine) -> None:
        robot = DeviceFacts("robot", "memory://robot", "melfa-r3", {"robot_number": 2, "slot": 3})
        engine.fixture.facts_now = replace(engine.fixture.facts_now, devices=(robot,))
        await engine.raw("robot")

    engine = played(script, monkeypatch)
    assert r"protect raw b'\r2;3;STOP\r'" in engine.guard.calls
