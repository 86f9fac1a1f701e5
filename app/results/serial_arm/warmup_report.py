"""The drift of a serial arm while it warms up, against its limit, from a run of tracker-warmup."""

import numpy as np

from catseye.app.results.model import Cell, Column, Section, Table, section
from catseye.app.results.numbers import fixed
from catseye.app.results.warmup_drift import DriftCurve, drift_figure, drift_verdict
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of, numbers_of
from catseye.procedures.serial_arm.tracker_warmup import (
    VISIT,
    TrackerWarmup,
    WarmupParams,
    begins_anew,
    drift_of,
)

_COLUMNS = (
    Column("visit", "visit"),
    Column("elapsed_min", "time", "min", fixed(1)),
    Column("moved_um", "moved since the first", "µm", fixed(1)),
    Column("drift_um_per_10min", "drift", "µm/10 min", fixed(1)),
)


def warmup_section(reader: RunReader) -> Section:
    """Return the drift at each visit of a warm-up, its curve with the limit; nothing of another run."""
    if reader.meta.get("procedure") != TrackerWarmup.name:
        return section("warm-up", "Warm-up", [])
    params = WarmupParams.model_validate(reader.meta["params"])
    visits = _last_stretch([step.result for step in reader.steps() if step.step_id.startswith(VISIT)])
    if not visits:
        return section("warm-up", "Warm-up", [])
    time_s = np.array([number_of(row, "clock_s") for row in visits])
    places = np.array([numbers_of(row, "place_mm") for row in visits])
    window_s = 60.0 * params.window_min
    drifts = [drift_of(time_s[:n], places[:n], window_s) for n in range(1, len(visits) + 1)]
    minutes = (time_s - time_s[0]) / 60.0
    moved_um = 1e3 * np.linalg.norm(places - places[0], axis=1)
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (f"{number}", float(minute), float(moved), drift)
        for number, (minute, moved, drift) in enumerate(zip(minutes, moved_um, drifts, strict=True), 1)
    )
    known = np.array([np.nan if drift is None else drift for drift in drifts])
    curve = DriftCurve(minutes, moved_um, known)
    figure = drift_figure([curve], params.limit_um_per_10min, "What the target has moved")
    table = Table("warm-up", "Visits of the reference pose", _COLUMNS, rows)
    return section(
        "warm-up", "Warm-up", [drift_verdict(reader.result("verdict"), _drift), table, figure], brief=True
    )


def _last_stretch(visits: list[Row]) -> list[Row]:
    """Return the visits at which the target was seen, since the clock began anew in the last process."""
    found: list[Row] = []
    for row in visits:
        if found and begins_anew(row, number_of(found[-1], "clock_s")):
            found = []
        if row["place_mm"] is not None:
            found.append(row)
    return found


def _drift(row: Row) -> str:
    return f"the drift is {number_of(row, 'drift_um_per_10min'):.1f}"
