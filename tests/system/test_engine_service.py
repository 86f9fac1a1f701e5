"""Engines and their clients as processes: who dies, who goes on, and what the arm does meanwhile."""

import contextlib
import fcntl
import getpass
import json
import os
import pty
import select
import signal
import socket
import stat
import subprocess
import sys
import termios
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from catseye.app.service.address import find_socket
from catseye.app.store.reader import RunReader
from tests.patience import HANG_S
from tests.system.command import Emulated, begun, catseye, emulated, environment, own_runtime, start
from tests.system.socket_client import Lines

SPEED = "40"
ONE_REFLECTOR = ("--param", 'reflectors=["P1"]')
SMALL = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-60.0, -40.0, -20.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 60.0]",
}
_clients: list[subprocess.Popen[str]] = []


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with own_runtime(), emulated(tmp_path_factory.mktemp("service"), "--speed", SPEED, edit=SMALL) as running:
        yield running
        for client in _clients:
            client.kill()
            client.communicate()
        for run in (running.cell.parent / "catseye-runs").iterdir():
            # A test that failed leaves nothing that moves.
            if (path := find_socket(run)) is not None and RunReader(run).status == "running":
                with contextlib.closing(Lines(str(path))) as left:
                    left.ask("abort")


def detached(bench: Emulated, *options: str, folder: Path | None = None) -> Path:
    """Start a measurement that runs on by itself, kill the starter, and return the run."""
    starter = begun(
        "run",
        "open-loop",
        "--cell",
        bench.cell,
        "--search",
        "none",
        "--speed",
        SPEED,
        *ONE_REFLECTOR,
        "--detach",
        *options,
        cwd=folder or bench.cell.parent,
    )  # fmt: skip - a command line
    with starter as (_, output):
        return Path(output.readline().strip())


def held(bench: Emulated, *options: str) -> Path:
    """Start a measurement by itself and hold it, so that clients have time to come."""
    run = detached(bench, *options)
    end_s = time.monotonic() + HANG_S
    while (path := find_socket(run)) is None:
        assert time.monotonic() < end_s
    with contextlib.closing(Lines(str(path))) as client:
        # Before the devices are ready there is nothing to hold.
        while not client.ask("hold")["ok"]:
            assert time.monotonic() < end_s
    return run


def joined(bench: Emulated, run: Path, *options: str) -> subprocess.Popen[str]:
    """Attach a program."""
    client = subprocess.Popen(
        [sys.executable, "-m", "catseye", "attach", str(run), "--json", *options],
        cwd=bench.cell.parent,
        env=environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    _clients.append(client)
    return client


def received(client: subprocess.Popen[str], event: str, **fields: object) -> dict[str, Any]:
    """Wait until a client receives an event."""
    assert client.stdout is not None
    watchdog = threading.Timer(HANG_S, client.kill)
    watchdog.start()
    try:
        for line in client.stdout:
            message: dict[str, Any] = json.loads(line)
            if message.get("event", "snapshot") == event and fields.items() <= message.items():
                return message
    finally:
        watchdog.cancel()
        watchdog.join()
    assert client.stderr is not None
    raise AssertionError(f"it ended without {event} {fields}: {client.stderr.read()}")


def ask(client: subprocess.Popen[str], **request: object) -> None:
    assert client.stdin is not None
    client.stdin.write(json.dumps(request) + "\n")
    client.stdin.flush()


def ended(process: subprocess.Popen[str]) -> int:
    process.communicate(timeout=HANG_S)
    return process.returncode


def motions(bench: Emulated) -> int:
    entries = bench.ask(op="log", device="robot")["entries"]
    return sum(entry["kind"] == "motion" for entry in entries)


def while_the_arm_moves(bench: Emulated) -> None:
    """Return in the middle of a motion."""
    end_s = time.monotonic() + HANG_S
    while not bench.ask(op="state")["moving"]:
        assert time.monotonic() < end_s


def nothing_moves(bench: Emulated) -> None:
    """Check for several times the length of a motion that none begins."""
    before = motions(bench)
    assert before > 0
    for _ in range(10):
        time.sleep(0.05)
        assert bench.ask(op="state")["moving"] is False
    assert motions(bench) == before


def show_json(bench: Emulated, run: Path) -> dict[str, Any]:
    shown = catseye("show", str(run), "--json", cwd=bench.cell.parent)
    found: dict[str, Any] = json.loads(shown.stdout)
    return found


def test_another_client_continues_the_run_a_killed_client_held(bench: Emulated) -> None:
    """A client that stands still holds up neither."""
    run = held(bench)
    path = find_socket(run)
    assert path is not None
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    steering, watching, stalled = joined(bench, run, "--control"), joined(bench, run), joined(bench, run)
    for client in (steering, watching, stalled):
        received(client, "snapshot")
    stalled.send_signal(signal.SIGSTOP)
    # An answer is no event; it names the request as the program did.
    ask(steering, id="mine", op="override", percent=100)
    assert "only ever lowered" in received(steering, "snapshot", re="mine")["error"]
    ask(steering, op="unhold")
    received(steering, "step-done")
    while_the_arm_moves(bench)
    steering.kill()
    ended(steering)
    assert "is lost" in received(watching, "state", state="HOLDING")["reason"]
    received(watching, "state", state="HELD")
    nothing_moves(bench)
    with at_a_terminal(bench, "attach", str(run), "--control") as terminal:
        terminal.shows("HELD; control: you")
        terminal.type("g\n")
        terminal.shows("run complete")
        assert terminal.process.wait(HANG_S) == 0
    assert received(watching, "run-ended")["status"] == "complete"
    assert ended(watching) == 0
    stalled.send_signal(signal.SIGCONT)
    # What it missed waited for it in its own connection.
    assert ended(stalled) == 0
    found = show_json(bench, run)
    assert found["status"] == "complete"
    kinds = [event["kind"] for event in found["events"]]
    assert kinds.count("client-lost") == 1
    assert kinds.count("control") == 3
    over = catseye("attach", str(run), cwd=bench.cell.parent)
    assert over.returncode == 2
    assert "is complete: see it with: catseye show" in over.stderr


def test_a_run_held_by_a_lost_client_stops_by_itself(bench: Emulated) -> None:
    text = bench.cell.read_text(encoding="utf-8")
    short = bench.cell.parent / "short.toml"
    short.write_text(text.replace("\nhold_limit_s = 900 ", "\nhold_limit_s = 1 "), encoding="utf-8")
    run = detached(replace(bench, cell=short))
    steering = joined(bench, run, "--control")
    received(steering, "step-done")
    watching = joined(bench, run)
    received(watching, "snapshot")
    steering.kill()
    ended(steering)
    assert "is lost" in received(watching, "state", state="HOLDING")["reason"]
    over = received(watching, "run-ended")
    assert (over["status"], over["exit_code"]) == ("stopped", 4)
    assert "for 1 s ([engine] hold_limit_s)" in over["text"]
    assert ended(watching) == 4
    nothing_moves(bench)
    assert show_json(bench, run)["resumable"]


class Terminal:
    """A terminal with a command on it; closing it is what a closed window does."""

    def __init__(self, bench: Emulated, *arguments: str) -> None:
        self.descriptor, slave = pty.openpty()
        self._open = True
        self.process = subprocess.Popen(
            [sys.executable, "-m", "catseye", *arguments],
            cwd=bench.cell.parent,
            env=environment(),
            stdin=slave,
            stdout=slave,
            stderr=slave,
            preexec_fn=_own_terminal,
        )
        os.close(slave)

    def close(self) -> None:
        if self._open:
            self._open = False
            os.close(self.descriptor)

    def end(self) -> None:
        self.close()
        self.process.kill()
        self.process.wait(HANG_S)

    def type(self, text: str) -> None:
        os.write(self.descriptor, text.encode())

    def shows(self, text: str) -> str:
        """Wait until it shows a text; return everything up to then."""
        seen, end_s = "", time.monotonic() + HANG_S
        while text not in seen:
            assert time.monotonic() < end_s, seen
            if select.select([self.descriptor], [], [], 0.5)[0]:
                try:
                    seen += os.read(self.descriptor, 4096).decode(errors="replace")
                except OSError:
                    raise AssertionError(f"the command ended without {text!r}: {seen}") from None
        return seen


def _own_terminal() -> None:
    os.setsid()
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


@contextlib.contextmanager
def at_a_terminal(bench: Emulated, *arguments: str) -> Iterator[Terminal]:
    terminal = Terminal(bench, *arguments)
    try:
        yield terminal
    finally:
        terminal.end()


def test_a_run_held_by_a_closed_terminal_can_be_stopped(bench: Emulated) -> None:
    run = held(bench)
    watching = joined(bench, run)
    received(watching, "snapshot")
    with at_a_terminal(bench, "attach", str(run), "--control") as terminal:
        terminal.shows("control: you")
        terminal.type("g\n")
        while_the_arm_moves(bench)
        terminal.close()
        terminal.process.wait(HANG_S)
    assert "is lost" in received(watching, "state", state="HOLDING")["reason"]
    received(watching, "state", state="HELD")
    nothing_moves(bench)
    with at_a_terminal(bench, "attach", str(run), "--control") as terminal:
        terminal.shows("HELD; control: you")
        terminal.type("s\n")
        terminal.shows("run stopped")
        assert terminal.process.wait(HANG_S) == 130
    assert ended(watching) == 130
    over = catseye("attach", str(run), cwd=bench.cell.parent)
    assert over.returncode == 2
    assert "is over, its state is stopped: go on with it with: catseye resume" in over.stderr


def test_a_killed_engine_is_reported_with_the_remedy(bench: Emulated) -> None:
    run = held(bench)
    watching = joined(bench, run)
    os.kill(received(watching, "snapshot")["snapshot"]["pid"], signal.SIGKILL)
    _, said = watching.communicate(timeout=HANG_S)
    assert watching.returncode == 3
    assert f"if it died: catseye resume {run.name}" in said
    assert find_socket(run) is not None
    over = catseye("attach", str(run), cwd=bench.cell.parent)
    assert over.returncode == 2
    assert f"its state is died: go on with it with: catseye resume {run.name}" in over.stderr


def test_a_run_detaches_in_a_folder_with_strangers_packages(bench: Emulated, tmp_path: Path) -> None:
    for name in ("app", "drivers"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise ImportError('a stranger')\n", encoding="utf-8")
    run = detached(bench, folder=tmp_path)
    assert catseye("attach", str(run), "--json", cwd=tmp_path).returncode == 0
    assert show_json(bench, run)["status"] == "complete"


def test_what_cannot_be_started_is_reported_by_the_starter(bench: Emulated) -> None:
    options = ("--cell", bench.cell, "--detach")
    wrong = catseye("run", "open-loop", *options, "--param", "nope=1", cwd=bench.cell.parent)
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert "nope" in wrong.stderr
    nobody = bench.cell.parent / "nobody.toml"
    text = bench.cell.read_text()
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
        robot = next(line for line in text.splitlines() if line.startswith("endpoint"))
        nobody.write_text(text.replace(robot, f'endpoint = "tcp://127.0.0.1:{port}"', 1))
        unreachable = catseye(
            "run",
            "open-loop",
            "--cell",
            nobody,
            "--search",
            "none",
            "--detach",
            "--json",
            cwd=bench.cell.parent,
        )
    assert unreachable.returncode == 3, unreachable.stderr
    assert "robot" in unreachable.stderr
    opened, failed = map(json.loads, unreachable.stdout.splitlines())
    assert Path(opened["path"]).is_dir()
    assert failed["exit_code"] == 3


def test_an_engine_starts_stops_and_resumes_runs_for_its_clients(bench: Emulated) -> None:
    engine = start("engine", "--cell", bench.cell, cwd=bench.cell.parent)
    try:
        assert engine.stdout is not None
        ready = json.loads(engine.stdout.readline())
        with contextlib.closing(Lines(ready["socket"])) as client:
            hello = client.ask("hello", client="test", who="Ada")
            assert hello["snapshot"]["state"] == "IDLE"
            assert "needs control" in client.ask("start", procedure="open-loop")["error"]
            client.ask("control")
            chosen = {"params": {"reflectors": ["P1"]}, "search": "none", "speed": float(SPEED)}
            started = client.ask("start", procedure="open-loop", **chosen)
            assert started["ok"], started
            client.until(state="EXECUTE")
            assert client.ask("hold")["ok"]
            client.until(state="HELD")
            assert "only ever lowered" in client.ask("override", percent=20)["error"]
            assert client.ask("override", percent=10)["ok"]
            assert client.ask("unhold")["ok"]
            assert client.until(event="happened", kind="override")["data"] == {"percent": 10.0}
            entries = bench.ask(op="log", device="robot")["entries"]
            assert any(entry["text"].endswith("OVRD=10") for entry in entries)
            client.until(event="step-done")
            client.ask("stop")
            assert client.until(event="run-ended")["status"] == "stopped"
            client.until(event="idle")
            resumed = client.ask("resume", run=started["run"])
            assert resumed["ok"], resumed
            assert resumed["run"] == started["run"]
            while (event := client.until(run=started["run"]))["event"] != "run-ended":
                if event["event"] == "prompt":
                    answer = "yes" if event["kind"] == "confirm" else event["choices"][0]
                    client.ask("answer", prompt=event["id"], text=answer)
            assert event["status"] == "complete"
            client.until(event="idle")
            client.ask("shutdown")
        assert ended(engine) == 0
    finally:
        engine.kill()
        engine.communicate()


def test_questions_are_answered_at_the_terminal_of_the_run(bench: Emulated) -> None:
    options = ("--cell", str(bench.cell), "--search", "none", "--speed", SPEED)
    asking = ("--param", "confirm_each=true", "--param", "instrument=file")
    with at_a_terminal(bench, "run", "validation-path", *options, *asking) as terminal:
        terminal.shows("the arm moves: type move, or no) > ")
        terminal.type("yes\n")
        terminal.shows("the arm moves after this: type move, or no")
        terminal.type("move\n")
        terminal.shows("answer to")
        terminal.shows("type move, or no) > ")
        terminal.type("\x03")
        terminal.type("move\n")
        terminal.shows("HELD: h hold · g go on")
        terminal.type("g\n")
        terminal.shows("type move, or no) > ")
        terminal.type("/s\n")
        seen = terminal.shows("run stopped: ")
        assert terminal.process.wait(HANG_S) == 130
        line = seen.rpartition("run stopped: ")[2]
        # The end of the line may have come with its beginning.
        line += "" if "\n" in line else terminal.shows("\n")
        run = bench.cell.parent / line.split()[0]
    answers = [(prompt["answer"], prompt["who"]) for prompt in show_json(bench, run)["prompts"]]
    assert answers == [("yes", getpass.getuser())] * 2 + [(None, None)]
