"""The drift of a distance while the arm warms up, against its limit, from a run of warmup."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from catseye.app.results.model import Cell, Column, Section, Statement, Table, section
from catseye.app.results.numbers import EXPANDED, fixed, number
from catseye.app.results.warmup_drift import DriftCurve, drift_figure, drift_verdict
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats
from catseye.procedures.kit.expanded import expanded_text
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import integer, number_of
from catseye.procedures.scara.warming.warmup import VISIT, Warmup, WarmupParams
from catseye.procedures.scara.warming.warmup_watch import rate_over

_COLUMNS = (
    Column("visit", "visit"),
    Column("elapsed_min", "time", "min", fixed(1)),
    Column("moved_um", "longer since the first", "µm", fixed(1, signed=True)),
    Column("drift_um_per_10min", "drift at most", "µm/10 min", fixed(1)),
)


def warmup_section(reader: RunReader) -> Section:
    """Return the distance at each visit of a warm-up, its drift and the limit; nothing of another run."""
    if reader.meta.get("procedure") != Warmup.name:
        return section("warm-up", "Warm-up", [])
    visits = [step.result for step in reader.steps() if step.step_id.startswith(VISIT)]
    measured = [row for row in visits if row["measured"]]
    if not measured:
        return section("warm-up", "Warm-up", [])
    params = WarmupParams.model_validate(reader.meta["params"])
    began_s = number_of(measured[0], "clock_s")
    # A new zero of the beam, as after an interruption, begins a new series.
    series = [list(rows) for _, rows in groupby(measured, key=lambda row: integer(row["segment"]))]
    curves = [_curve(rows, began_s, 60.0 * params.window_min) for rows in series]
    table = Table("warm-up", "Visits of the reference pose", _COLUMNS, _rows(curves))
    figure = drift_figure(curves, params.limit_um_per_10min, "What the distance has grown by")
    verdict = _verdict(reader.result("analyse"))
    return section("warm-up", "Warm-up", [verdict, table, figure], brief=True)


def _verdict(row: Row | None) -> Statement:
    verdict = drift_verdict(row, _drift)
    if row is None or row["drift_um_per_10min"] is None:
        return verdict
    drift, u = number_of(row, "drift_um_per_10min"), number_of(row, "u_drift_um_per_10min")
    rate = f"{number(drift, fixed(1, signed=True))} µm, U = {EXPANDED * u:.1f} µm"
    limit = f"the limit is {number_of(row, 'limit_um_per_10min'):g} µm"
    stated = f"{verdict.short}: drift in 10 min {rate}; {limit}"
    return replace(verdict, expanded=stated)


def _curve(rows: Sequence[Row], began_s: float, window_s: float) -> DriftCurve:
    time_s = np.array([number_of(row, "clock_s") for row in rows])
    length_mm = np.array([number_of(row, "displacement_mm") for row in rows])
    bounds: Floats = np.full(time_s.size, np.nan)
    for n in range(1, time_s.size + 1):
        rate = rate_over(time_s[:n], length_mm[:n], window_s)
        bounds[n - 1] = np.nan if rate is None else rate.bound_um_per_10min
    return DriftCurve((time_s - began_s) / 60.0, 1e3 * (length_mm - length_mm[0]), bounds)


def _rows(curves: Sequence[DriftCurve]) -> tuple[tuple[Cell, ...], ...]:
    visits = [
        visit
        for one in curves
        for visit in zip(one.minutes, one.moved_um, one.drift_um_per_10min, strict=True)
    ]
    return tuple(
        (f"{number}", float(minute), float(moved), float(drift) if np.isfinite(drift) else None)
        for number, (minute, moved, drift) in enumerate(visits, 1)
    )


def _drift(row: Row) -> str:
    drift, u = number_of(row, "drift_um_per_10min"), number_of(row, "u_drift_um_per_10min")
    known = expanded_text(drift, u, 1, signed=True)
    return f"the distance to {row['reflector']} drifts by {known} µm in 10 min (k = 2)"
