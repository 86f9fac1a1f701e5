"""An arm's guard with a process of its own, as the engine uses it."""

import asyncio
import os
import signal
import socket
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest

from catseye.app.guard import client, guard, lock, process
from catseye.app.guard.client import LOG_NAME, ArmGuard
from catseye.app.guard.lock import lock_path
from catseye.drivers.links.guarding import GuardError
from tests.system.guarded import guards_of

STOP = b"\r1;1;STOP\r"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    made = tmp_path / "locks"
    made.mkdir()
    made.chmod(0o1777)
    monkeypatch.setattr(lock, "_FOLDERS", (made,))
    return made


@pytest.fixture
async def arm(folder: Path, tmp_path: Path) -> AsyncIterator[ArmGuard]:
    """An arm on a line with a blank in its name, owned and guarded."""
    del folder
    made = ArmGuard(f"serial://{tmp_path}/a line?baud=9600")
    await made.hold("a test", tmp_path, simulated=True)
    yield made
    await made.let_go()
    for name in ("robot", "robot main", "robot 0", "robot 1"):
        await made.release(name)


@pytest.fixture
def line() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield ours, theirs


def guard_process() -> int:
    (pid,) = guards_of(os.getpid())
    return pid


def dead_guard() -> int:
    """Kill the guard process, and return its number when it has ended."""
    pid = guard_process()
    os.kill(pid, signal.SIGKILL)
    os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
    return pid


def held_by(pid: int) -> set[str]:
    return {os.readlink(found) for found in Path(f"/proc/{pid}/fd").iterdir()}


async def test_guard_holds_lock_and_log_of_an_arm(arm: ArmGuard, folder: Path, tmp_path: Path) -> None:
    del arm
    path = str(lock_path(f"{tmp_path}/a line"))
    assert os.path.dirname(path) == str(folder)
    assert {path, str(tmp_path / LOG_NAME)} <= held_by(guard_process())


async def test_guard_that_died_between_motions_is_replaced(
    arm: ArmGuard, tmp_path: Path, line: tuple[socket.socket, socket.socket]
) -> None:
    arm.protect("robot main", line[0].fileno(), STOP)
    first = dead_guard()
    async with arm.motion():
        second = guard_process()
        assert second != first
        inode = os.fstat(line[0].fileno()).st_ino
        assert {str(lock_path(f"{tmp_path}/a line")), f"socket:[{inode}]"} <= held_by(second)
    assert guards_of(os.getpid()) == [second]


async def test_two_motions_at_a_time_replace_it_once(arm: ArmGuard) -> None:
    dead_guard()

    async def moves() -> None:
        async with arm.motion():
            await asyncio.sleep(0)

    await asyncio.gather(moves(), moves())
    assert len(guards_of(os.getpid())) == 1


async def test_guard_that_lets_nothing_go_in_motion_counts_as_dead(
    arm: ArmGuard, line: tuple[socket.socket, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(client, "_ANSWER_S", 0.1)
    stopped = asyncio.Event()
    arm.on_stop = lambda _reason: stopped.set()
    arm.protect("robot", line[0].fileno(), STOP)
    async with arm.motion():
        os.kill(guard_process(), signal.SIGSTOP)
        await arm.release("robot")
        assert guards_of(os.getpid()) == []
        await stopped.wait()
        with pytest.raises(GuardError, match="ended while the arm moved"):
            arm.permit()


async def test_a_guard_death_in_motion_reaches_the_next_owner(arm: ArmGuard, tmp_path: Path) -> None:
    stopped = asyncio.Event()
    arm.on_stop = lambda _reason: stopped.set()
    async with arm.motion():
        dead_guard()
        await stopped.wait()
    await arm.let_go()
    (history,) = await arm.hold("the next one", tmp_path, simulated=True)
    assert "the guard process ended while the arm moved" in history


def no_process(*_: object) -> None:
    raise OSError("no more processes")


async def test_machine_that_was_suspended_moves_nothing_unasked(
    arm: ArmGuard, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    stops: list[str] = []
    arm.on_stop = stops.append
    async with arm.motion():
        arm.permit()
        with monkeypatch.context() as patch:
            # The program wakes sooner than its guard.
            patch.setattr(process, "boot_s", lambda: guard.boot_s() + 60.0)
            with pytest.raises(GuardError, match="stood still"):
                arm.permit()
        await asyncio.sleep(0)
    assert len(stops) == 1
    assert "stood still" in stops[0]
    await arm.let_go()
    (history,) = await arm.hold("the next one", tmp_path, simulated=True)
    assert "stopped before" in history
    assert "stood still" in history


async def test_a_guard_failing_to_start_keeps_the_stop_history(
    arm: ArmGuard, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    async with arm.motion():
        dead_guard()
        await asyncio.sleep(0)
        with pytest.raises(GuardError):
            arm.permit()
    await arm.let_go()
    with monkeypatch.context() as patch:
        patch.setattr(client, "GuardProcess", no_process)
        with pytest.raises(GuardError, match="does not start"):
            await arm.hold("a busy machine", tmp_path, simulated=True)
    (history,) = await arm.hold("the next one", tmp_path, simulated=True)
    assert "the guard process ended while the arm moved" in history


async def test_guard_that_takes_no_message_counts_as_dead(
    arm: ArmGuard, line: tuple[socket.socket, socket.socket]
) -> None:
    stopped = asyncio.Event()
    arm.on_stop = lambda _reason: stopped.set()
    async with arm.motion():
        os.kill(guard_process(), signal.SIGSTOP)
        # Until the pair is full: nothing of it waits.
        for number in range(10_000):
            arm.protect(f"robot {number % 2}", line[0].fileno(), STOP)
            if not guards_of(os.getpid()):
                break
        await stopped.wait()


@pytest.mark.parametrize("kind", ["link", "fifo"])
async def test_log_that_is_no_plain_file_stays_untouched(folder: Path, tmp_path: Path, kind: str) -> None:
    del folder
    other = tmp_path / "other"
    other.write_text("precious", encoding="ascii")
    log = tmp_path / LOG_NAME
    if kind == "link":
        log.symlink_to(other)
    else:
        os.mkfifo(log)
    arm = ArmGuard("tcp://127.0.0.1:9")
    await arm.hold("a test", tmp_path, simulated=True)
    assert str(other) not in held_by(guard_process())
    await arm.let_go()
    assert other.read_text(encoding="ascii") == "precious"
