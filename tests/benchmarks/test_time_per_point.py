"""Software time per measured point over the emulator: everything but motion, settling and dwell, at real speed.

Its peer asks the same questions of the same emulator, one after the other over bare sockets, and does nothing else.
"""

import json
import socket
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.engine.request import RunOutcome
from catseye.app.protocol.procedures import load_procedure, parse_params
from catseye.app.service.running import carry_out, plan_run
from catseye.app.store.reader import RunReader
from tests.system.command import Emulated, emulated

FEW_NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-60.0, -40.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [20.0, 40.0, 60.0]",
}

MIDDLE = 10
ROUNDS = 50


async def searched(bench: Emulated, root: Path) -> float:
    """Search quickly, then let the bench run at real speed; return its time."""
    search = load_procedure("reflector-search")
    bench.ask(op="speed", value=400.0)
    planned = plan_run(load_cell(bench.cell), search, parse_params(search.params_type, []), root, "none")
    assert (await carry_out(planned, root, lambda _event: None, speed=400.0)).exit_code == 0
    bench.ask(op="speed", value=1.0)
    return float(bench.ask(op="state")["time_s"])


async def measured_slice(bench: Emulated, root: Path) -> RunOutcome:
    """Run a slice of the paper's measurement at real speed, aimed by the search before it."""
    loaded, measure = load_cell(bench.cell), load_procedure("open-loop")
    params = parse_params(measure.params_type, ['reflectors=["P2"]'])
    planned = plan_run(loaded, measure, params, root, "auto")
    return await carry_out(planned, root, lambda _event: None)


@dataclass(frozen=True)
class Said:
    """What passed on a wire.

    Attributes:
        asked: sent by the program.
    """

    at: datetime
    device: str
    asked: bool
    data: bytes


def transcript(run: Path) -> list[Said]:
    """Return what passed on all wires, in order."""
    rows = [json.loads(line) for line in (run / "wire.log").read_text().splitlines()]
    return [
        Said(
            datetime.fromisoformat(row["t"]),
            row["device"],
            row["direction"] == "tx",
            bytes.fromhex(row["hex"]),
        )
        for row in rows
    ]


def motions(said: list[Said]) -> list[tuple[datetime, float]]:
    """Return when each motion ended and how long it took, s: from its command to the controller's answer."""
    found: list[tuple[datetime, float]] = []
    sent: datetime | None = None
    for row in said:
        if row.device != "robot":
            continue
        if b"EXEC2=" in row.data:
            sent = row.at
        elif sent is not None and row.data.strip() == b"QoK":
            # Looks at the moving arm, on a connection of their own, stand between.
            found.append((row.at, (row.at - sent).total_seconds()))
            sent = None
    return found


def questions(said: list[Said], start: datetime, done: datetime) -> list[Said]:
    """Return what a point asks outside of its motions and between its first and last reading."""
    within = [row for row in said if start <= row.at <= done and row.asked]
    readings = [row.at for row in within if row.data.startswith(b"R")]
    return [
        row
        for row in within
        if row.device in ("robot", "interferometer")
        and b"EXEC2=" not in row.data
        and not min(readings) < row.at < max(readings)
    ]


def software_ms(outcome: RunOutcome) -> list[float]:
    """Return what each point took beyond motion, settling and dwell; the first point's way is not one of them."""
    ended = motions(transcript(outcome.path))
    times = {time.step_id: time.total_s for time in outcome.step_times}
    rest_s = 0.5 + 0.5
    found = []
    for step in RunReader(outcome.path).steps()[1:]:
        start, done = datetime.fromisoformat(step.started_utc), datetime.fromisoformat(step.done_utc)
        moving_s = sum(duration for at, duration in ended if start <= at <= done)
        found.append(1e3 * (times[step.step_id] - moving_s - rest_s))
    return found


@contextmanager
def asking(bench: Emulated) -> Iterator[dict[str, socket.socket]]:
    """Connect bare sockets to robot and interferometer."""
    cell = load_cell(bench.cell).cell
    assert cell.interferometer is not None
    endpoints = {"robot": cell.robot.endpoint, "interferometer": cell.interferometer.endpoint}
    found: dict[str, socket.socket] = {}
    try:
        for device, endpoint in endpoints.items():
            host, port = endpoint.removeprefix("tcp://").split(":")
            found[device] = socket.create_connection((host, int(port)))
            found[device].setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for command in (b"1;1;OPEN=PEER\r", b"1;1;CNTLON\r"):
            found["robot"].sendall(command)
            assert found["robot"].recv(4096)
        yield found
    finally:
        for connection in found.values():
            connection.close()


def bare_ms(bench: Emulated, asked: list[Said]) -> float:
    """Return how long the same questions take when nothing else is done."""
    took_ms = []
    with asking(bench) as wires:
        for _ in range(ROUNDS):
            start_s = time.perf_counter()
            for question in asked:
                wires[question.device].sendall(question.data)
                assert wires[question.device].recv(4096)
            took_ms.append(1e3 * (time.perf_counter() - start_s))
    return statistics.median(took_ms)


async def test_software_time_of_a_point(tmp_path: Path) -> None:
    with emulated(tmp_path, edit=FEW_NODES) as bench:
        await searched(bench, tmp_path / "runs")
        outcome = await measured_slice(bench, tmp_path / "runs")
        assert outcome.exit_code == 0
        step = RunReader(outcome.path).steps()[MIDDLE]
        asked = questions(
            transcript(outcome.path),
            datetime.fromisoformat(step.started_utc),
            datetime.fromisoformat(step.done_utc),
        )
        peer = bare_ms(bench, asked)
    # The engine's own account: everything outside of the robot's moves, settling and dwell.
    plain = [1e3 * time.software_s for time in outcome.step_times[1:]]
    # With the questions around each of the four to five sub-steps of a point, which the account leaves to the moves.
    strict = software_ms(outcome)
    one, two = statistics.median(plain), statistics.median(strict)
    figure = (
        f"software time per point: median {one:.1f} ms, {two:.1f} ms with the questions around each sub-step"
    )
    share = f"{two / peer:.1f} times what its {len(asked)} questions take over bare sockets ({peer:.1f} ms)"
    print(f"\n{figure}, of {len(plain)} points (target 5 ms); {share}")  # noqa: T201  # the figure
    # The first point has the way in.
    assert len(plain) == len(strict) == len(outcome.step_times) - 1
