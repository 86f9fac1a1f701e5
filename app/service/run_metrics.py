"""The file of metrics of a run, whichever process hosts it."""

from functools import partial
from pathlib import Path

from catseye.app.service.metrics import MetricsFile, Surroundings
from catseye.app.service.running import PlannedRun
from catseye.app.service.watching.telemetry import Telemetry, free_bytes
from catseye.drivers.links.healing import HEALS
from catseye.drivers.roles.clock import SystemClock


def metrics_of(
    path: Path | None, planned: PlannedRun, root: Path, telemetry: Telemetry
) -> MetricsFile | None:
    """Return what keeps a file of metrics of a run; None without a file.

    Args:
        path: file that is replaced; None for none.
        root: folder of the runs, whose disk is looked at.
        telemetry: of the bench.
    """
    if path is None:
        return None
    latest = telemetry.latest
    surroundings = Surroundings(
        air=lambda: None if latest.air is None else latest.air.value,
        heals=lambda: dict(HEALS),
        free_bytes=partial(free_bytes, root),
    )
    labels = {"cell": planned.loaded.cell.name, "procedure": planned.procedure.name}
    return MetricsFile(path, labels, surroundings, SystemClock())
