"""Software time per measured point over the emulator: everything but motion, settling and dwell, at real speed."""

import json
import statistics
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


def motions(run: Path) -> list[tuple[datetime, float]]:
    """Return when each motion ended and how long it took, s: from its command to the controller's answer."""
    found: list[tuple[datetime, float]] = []
    sent: datetime | None = None
    for line in (run / "wire.log").read_text().splitlines():
        row = json.loads(line)
        if row["device"] != "robot":
            continue
        at = datetime.fromisoformat(row["t"])
        if "EXEC2=" in row["text"]:
            sent = at
        elif sent is not None and row["text"].strip() == "QoK":
            # Looks at the moving arm, on a connection of their own, stand between.
            found.append((at, (at - sent).total_seconds()))
            sent = None
    return found


def software_ms(outcome: RunOutcome) -> list[float]:
    """Return what each point took beyond motion, settling and dwell; the first point's way is not one of them."""
    ended = motions(outcome.path)
    times = {time.step_id: time.total_s for time in outcome.step_times}
    rest_s = 0.5 + 0.5
    found = []
    for step in RunReader(outcome.path).steps()[1:]:
        start, done = datetime.fromisoformat(step.started_utc), datetime.fromisoformat(step.done_utc)
        moving_s = sum(duration for at, duration in ended if start <= at <= done)
        found.append(1e3 * (times[step.step_id] - moving_s - rest_s))
    return found


async def test_software_time_of_a_point(tmp_path: Path) -> None:
    with emulated(tmp_path, edit=FEW_NODES) as bench:
        await searched(bench, tmp_path / "runs")
        outcome = await measured_slice(bench, tmp_path / "runs")
    assert outcome.exit_code == 0
    # The engine's own account: everything outside of the robot's moves, settling and dwell.
    plain = [1e3 * time.software_s for time in outcome.step_times[1:]]
    # With the questions around each of the four to five sub-steps of a point, which the account leaves to the moves.
    strict = software_ms(outcome)
    one, two = statistics.median(plain), statistics.median(strict)
    figure = (
        f"software time per point: median {one:.1f} ms, {two:.1f} ms with the questions around each sub-step"
    )
    print(f"\n{figure}, of {len(plain)} points (target 10 ms)")  # noqa: T201  # the figure
    # 24 points and two closures; the first has the way in.
    assert len(plain) == len(strict) == 25
