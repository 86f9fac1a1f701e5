"""A measurement on links of which each spoils one answer in so many."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from tests.system import forked
from tests.system.blocking import misfits_um, still_truth
from tests.system.command import emulated, environment, last_run

SOON = {"[robot.limits_deg]": "[robot.settings]\nanswer_timeout_s = 0.5\n\n[robot.limits_deg]"}
"""A lost answer costs this time: the default of two seconds would make the run four times as long."""

DEVICES = ("robot", "interferometer", "environment")
PLACES = {"P1": (650.0, -400.0), "P2": (680.0, 0.0), "P3": (640.0, 380.0)}


@dataclass(frozen=True)
class Measured:
    """What came of a run.

    Attributes:
        record: of the run.
        misfit_um: largest deviation of a point from the true arm.
        motions: commands of motion that went over the wire.
    """

    record: RunReader
    misfit_um: float
    motions: int


def measured(
    folder: Path,
    speed: str,
    share: float,
    seed: int,
    *words: str,
    edit: dict[str, str] | None = None,
    limit_s: float = 110.0,
) -> Measured:
    """Run the measurement to its end, without a person, on an arm without noise."""
    edit = {**SOON, **(edit or {})}
    truth = still_truth(folder, PLACES)
    options = ("--speed", speed, "--truth", str(truth))
    with emulated(folder, *options, module="tests.system.still_bench", edit=edit) as bench:
        for number, device in enumerate(DEVICES):
            bench.ask(op="fault", name="lossy", device=device, share=share, seed=100 * seed + 10 * number)
        command: tuple[str | Path, ...] = (
            "run",
            "open-loop",
            "--cell",
            bench.cell,
            "--speed",
            speed,
            "--search",
            "none",
            *words,
        )
        run = forked.run("catseye", command, cwd=folder, env=environment(), limit_s=limit_s)
        assert run.returncode == 0, f"seed {seed}: {run.stderr}"
        arm = bench.ask(op="truth")["truth"]
        log = bench.ask(op="log", device="robot")
    record = RunReader(resolve_run(folder / "catseye-runs", last_run(folder, "open-loop")))
    assert not [prompt for prompt in record.prompts() if str(prompt["id"]).startswith("beam/")]
    off = np.abs(misfits_um(record.rows("points"), arm))
    return Measured(record, float(off.max()), json.dumps(log).count("EXEC2=MOV"))
