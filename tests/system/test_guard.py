"""The guard: a moving arm whose program is killed, stopped or blocked, with the controller as witness."""

import os
import select
import signal
import socket
import subprocess
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from catseye.app.guard.client import LOG_NAME
from catseye.app.guard.guard import DIED, FROZEN, FROZEN_S, SILENT
from tests.patience import HANG_S
from tests.system import forked
from tests.system.command import Emulated, catseye, emulated, environment, forget_stops
from tests.system.guarded import (
    Program,
    guards_of,
    measuring,
    moved,
    newest_end,
    program,
    requests,
    until,
    words_after_first_stop,
)
from tests.system.held_link import STOP

SLOW = {"override_cap_percent = 20 ": "override_cap_percent = 2 "}
"""A motion of some seconds: an arm that nobody stops goes on for longer than a test waits."""

SLOW_ENOUGH = {"override_cap_percent = 20 ": "override_cap_percent = 10 "}
"""A motion that is under way for a moment, and comes to its end while a test waits for that."""


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Emulated]:
    with emulated(tmp_path, "--speed", "1", edit=SLOW) as running:
        yield running


def begun_s(bench: Emulated) -> float:
    return float(bench.ask(op="state")["time_s"])


def stands_short_of_its_target(bench: Emulated, since_s: float) -> None:
    until(lambda: not bench.ask(op="state")["moving"])
    entries = bench.ask(op="log", device="robot")["entries"]
    motions = [e["text"] for e in entries if e["kind"] == "motion" and e["time_s"] > since_s]
    assert any(text.startswith("stop towards") for text in motions), motions


def test_killed_run_leaves_an_arm_that_stands(bench: Emulated) -> None:
    with measuring(bench) as run:
        run.until_moving()
        now_s = begun_s(bench)
        run.send(signal.SIGKILL)
        stands_short_of_its_target(bench, now_s)
        assert moved(words_after_first_stop(bench, now_s)) == []
        (name,) = {path.name for path in (bench.cell.parent / "catseye-runs").glob("2*_open-loop_*")}
        until(lambda: guards_of(run.process.pid) == [])
    assert DIED in (bench.cell.parent / "catseye-runs" / "guard.log").read_text(encoding="utf-8")
    # Whichever run moves this arm next gets to know.
    with program(bench, "run", "open-loop", "--cell", bench.cell, "--search", "none") as again:
        again.until_moving()
        again.send(signal.SIGTERM)
        _, stderr = again.ended()
    assert "this arm was stopped before" in stderr
    assert DIED in stderr
    assert name in stderr


def stopped_process(run: Program) -> None:
    run.send(signal.SIGSTOP)


def blocked_loop(run: Program) -> None:
    run.send(signal.SIGUSR2)


@pytest.mark.parametrize("silence", [stopped_process, blocked_loop])
def test_silent_program_is_stopped_and_sends_no_motion(
    bench: Emulated, silence: Callable[[Program], None]
) -> None:
    with measuring(bench, "tests.system.blockable") as run:
        run.until_moving()
        now_s = begun_s(bench)
        silence(run)
        stands_short_of_its_target(bench, now_s)
        run.send(signal.SIGCONT)
        code, stderr = run.ended()
        assert code == 5, stderr
        assert SILENT in stderr
        assert moved(words_after_first_stop(bench, now_s)) == []
    end = newest_end(bench)
    assert end["status"] == "stopped"


def test_after_a_freeze_nothing_moves_before_an_acknowledgement(tmp_path: Path) -> None:
    """Program and guard stand still together, as under the freezer of a control group or a machine's suspend."""
    with emulated(tmp_path, "--speed", "1", edit=SLOW_ENOUGH) as bench, measuring(bench) as run:
        run.until_moving()
        now_s = begun_s(bench)
        frozen = [*guards_of(run.process.pid), run.process.pid]
        for pid in frozen:
            os.kill(pid, signal.SIGSTOP)
        # Long enough for the arm to come to the end of its motion, so that the next one is due at the thaw.
        until(lambda: not run.moving)
        time.sleep(1.5 * FROZEN_S)
        for pid in reversed(frozen):
            os.kill(pid, signal.SIGCONT)
        code, stderr = run.ended()
        assert code == 5, stderr
        assert FROZEN in stderr
        words = [text for time_s, text in requests(bench) if time_s > now_s]
        assert "STOP" in words
        assert moved(words) == []
        assert newest_end(bench)["status"] == "stopped"


def test_run_goes_on_after_the_guard_has_stopped_it(bench: Emulated) -> None:
    with measuring(bench) as run:
        run.until_moving()
        run.send(signal.SIGSTOP)
        until(lambda: not run.moving)
        run.send(signal.SIGCONT)
        assert run.ended()[0] == 5
    with program(bench, "resume", newest_end(bench)["run"], "--json") as resumed:
        resumed.until_moving()


def test_death_of_the_guard_stops_the_arm(bench: Emulated) -> None:
    with measuring(bench) as run:
        run.until_moving()
        now_s = begun_s(bench)
        (guard,) = guards_of(run.process.pid)
        os.kill(guard, signal.SIGKILL)
        code, stderr = run.ended()
        assert code == 5, stderr
        assert "the guard process ended while the arm moved" in stderr
        assert moved(words_after_first_stop(bench, now_s)) == []
    with program(bench, "run", "open-loop", "--cell", bench.cell, "--search", "none") as again:
        again.until_moving()
        again.send(signal.SIGTERM)
        _, stderr = again.ended()
    assert "this arm was stopped before" in stderr
    assert "the guard process ended while the arm moved" in stderr


def test_signals_to_the_group_leave_the_guard_alive(bench: Emulated) -> None:
    with measuring(bench) as run:
        run.until_moving()
        (guard,) = guards_of(run.process.pid)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGTSTP):
            os.kill(guard, number)
        assert os.getsid(guard) != os.getsid(run.process.pid)
        now_s = begun_s(bench)
        run.send(signal.SIGKILL)
        stands_short_of_its_target(bench, now_s)


def test_second_program_is_refused_and_disturbs_nothing(bench: Emulated) -> None:
    with measuring(bench) as run:
        run.until_moving()
        now_s = begun_s(bench)
        second = catseye("run", "open-loop", "--cell", bench.cell, "--search", "none", cwd=bench.cell.parent)
        assert second.returncode == 3, second.stderr
        assert f"in use by process {run.process.pid}" in second.stderr
        assert "_open-loop_" in second.stderr
        # Reading moves nothing.
        assert catseye("doctor", bench.cell, cwd=bench.cell.parent).returncode == 0
        asked = [text for time_s, text in requests(bench) if time_s > now_s]
        assert not [word for word in asked if word.startswith(("STOP", "SRV", "CNTL", "OVRD="))]
        assert run.process.poll() is None


def test_healed_link_is_guarded_and_the_old_one_let_go(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(HANG_S)
        with held_link(tmp_path, endpoint_of(listener)) as process:
            old, _ = listener.accept()
            new, _ = listener.accept()
            with old, new:
                for connection in (old, new):
                    connection.settimeout(HANG_S)
                # Nobody holds a duplicate: a port that serves one client is free again.
                assert old.recv(100) == b""
                assert new.recv(100) == b"moving"
                process.kill()
                assert new.recv(100).startswith(STOP)
                while new.recv(100):
                    """The guard says it again, lets the connection go, and ends."""


def test_children_of_a_killed_program_do_not_hide_its_death(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(HANG_S)
        with held_link(tmp_path, endpoint_of(listener), "forked") as process:
            listener.accept()[0].close()
            link, _ = listener.accept()
            with link:
                link.settimeout(HANG_S)
                assert link.recv(100) == b"moving"
                process.kill()
                assert link.recv(100).startswith(STOP)
                until(lambda: guards_of(process.pid) == [])
    # The child has the program's end of the pair too: its silence only would be noticed, and that later.
    assert SILENT not in (tmp_path / LOG_NAME).read_text(encoding="utf-8")


def test_killed_program_stops_the_arm_on_a_serial_line(tmp_path: Path) -> None:
    controller, line = os.openpty()
    try:
        tty.setraw(line)
        device = os.ttyname(line)
        with held_link(tmp_path, f"serial://{device}?baud=115200") as process:
            # The port is held by one program at a time: it was opened again, so nobody holds a duplicate.
            assert heard(controller, b"moving") == b"moving"
            process.kill()
            assert heard(controller, STOP) == STOP
    finally:
        os.close(controller)
        os.close(line)


def heard(descriptor: int, wanted: bytes) -> bytes:
    """Return as many bytes as are wanted, fewer where they do not come."""
    came = b""
    while len(came) < len(wanted) and select.select([descriptor], [], [], HANG_S)[0]:
        came += os.read(descriptor, len(wanted) - len(came))
    return came


def endpoint_of(listener: socket.socket) -> str:
    return f"tcp://127.0.0.1:{listener.getsockname()[1]}"


@contextmanager
def held_link(folder: Path, endpoint: str, *words: str) -> Iterator[forked.Forked]:
    """Start the program that heals its link and then moves; nothing of it is left at the end."""
    with (folder / "said").open("wb") as said:
        process = forked.Forked(
            "tests.system.held_link",
            [endpoint, *words],
            cwd=folder,
            env=environment(),
            out=said,
            err=said,
        )
    try:
        yield process
    finally:
        process.kill()
        process.wait(HANG_S)
        until(lambda: guards_of(process.pid) == [])
        forget_stops(endpoint)


def test_raw_bytes_are_guarded_and_owned(bench: Emulated) -> None:
    words: list[str | Path] = [
        "terminal",
        "robot",
        "--cell",
        bench.cell,
        "--arm",
        "lab-1",
        "--eol",
        "cr",
        "--wait",
        "60",
    ]
    with program(bench, *words, stdin=subprocess.PIPE) as terminal:
        assert terminal.process.stdin is not None
        terminal.process.stdin.write(
            "1;1;OPEN=HAND\n1;1;CNTLON\n1;1;OVRD=2\n1;1;SRVON\n1;1;EXECMOV (60,0,0,0)\n"
        )
        terminal.process.stdin.flush()
        until(lambda: [w for _, w in requests(bench) if w.startswith("SRVON")] != [])
        second = catseye("run", "open-loop", "--cell", bench.cell, "--search", "none", cwd=bench.cell.parent)
        assert second.returncode == 3
        assert "raw bytes by hand" in second.stderr
        now_s = begun_s(bench)
        terminal.send(signal.SIGKILL)
        until(lambda: guards_of(terminal.process.pid) == [])
        assert words_after_first_stop(bench, now_s)
