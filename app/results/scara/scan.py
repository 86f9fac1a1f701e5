"""From a points file of any length to an identified arm."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from catseye.app.files.parquet_columns import parquet_rows
from catseye.app.results.scara.identify import identified_result, with_what_speaks_against
from catseye.app.results.scara.plausible import failures_explained, require_plausible
from catseye.app.results.scara.result import Result, ScanPart, ScanSegments
from catseye.app.results.scara.spooled_points import spooled_points
from catseye.app.results.scara.stated_budget import StatedBudget
from catseye.app.results.scara.table_budget import SeenTable
from catseye.calibration.core.blockwise.residual_sums import ResidualSums
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.scans.scan_identification import identify_scan
from catseye.procedures.scara.bench import ScaraBench

SCAN_ROWS = 100_000
"""Points files with more rows are streamed."""

_SHORTEST_LINE_BYTES = 20
_CHUNK_BYTES = 1_000_000


def is_scan(points: Path) -> bool:
    """Return whether a points file is streamed, which has more than SCAN_ROWS rows or lines.

    A CSV file that cannot be read is none; whoever reads it then says why.

    Raises:
        UsageError: a Parquet file cannot be read.
        ConfigError: Parquet needs a package that is not installed.
    """
    if points.suffix == ".parquet":
        return parquet_rows(points) > SCAN_ROWS
    try:
        if points.stat().st_size < SCAN_ROWS * _SHORTEST_LINE_BYTES:
            return False
        lines = 0
        with points.open("rb") as stream:
            while lines <= SCAN_ROWS and (chunk := stream.read(_CHUNK_BYTES)):
                lines += chunk.count(b"\n")
    except OSError:
        return False
    return lines > SCAN_ROWS


def identify_scan_file(
    points: Path,
    bench: ScaraBench,
    model: ModelName,
    stated: Callable[[SeenTable], StatedBudget],
    terms: tuple[Term, ...] = (),
    reading: Callable[[float], None] | None = None,
    solving: Callable[[int, int], None] | None = None,
    accept_implausible: str | None = None,
) -> Result:
    """Identify an arm from a points file, block by block.

    Args:
        points: the file, CSV or Parquet.
        stated: returns the error budget that counts for what the file shows.
        reading: is called with the share of the file that is read.
        solving: is called with the rows done and the rows expected of all passes.
        accept_implausible: why an implausible arm is kept; None refuses it.

    Raises:
        UsageError: the file is wrong; names file and line.
        CalibrationError: the points cannot determine the model; the text names what is missing.
        ImplausibleError: the arm cannot be the one that was measured.
    """
    places = {reflector.name: (reflector.x_mm, reflector.y_mm) for reflector in bench.reflectors}
    nodes = np.deg2rad(bench.nodes1_deg), np.deg2rad(bench.nodes2_deg)
    links = bench.link1_mm, bench.link2_mm
    with spooled_points(points, list(places), reading) as source:
        rough, counted = np.array(list(places.values())), stated(source.seen)
        taken = replace(source, with_sigma=counted.counts_sigma)
        first = Problem(next(taken.blocks()), model, *nodes, *links, rough, counted.budget, terms)
        with failures_explained(first, bench.plausibility):
            found = identify_scan(
                taken,
                model,
                *nodes,
                *links,
                rough,
                counted.budget,
                terms,
                solving,
            )
    identified = found.identified
    sample = replace(first, points=identified.points)
    implausible = require_plausible(sample, identified, bench.plausibility, accept_implausible)
    part = _scan_part(found.residuals, identified.layout.dead_paths, len(identified.points))
    result = identified_result(identified, bench, [points.name], counted.part, counted.simulated)
    return with_what_speaks_against(result, counted.unverified).model_copy(
        update={"scan": part, "implausible": implausible}
    )


def _scan_part(residuals: ResidualSums, dead_paths: tuple[tuple[str, int], ...], n_sample: int) -> ScanPart:
    """Return summed residuals as a result file states them."""
    return ScanPart(
        n_points=residuals.rows,
        n_sample=n_sample,
        segments=ScanSegments(
            reflector=[name for name, _ in dead_paths],
            segment=[segment for _, segment in dead_paths],
            n_points=residuals.count.tolist(),
            mean_um=(1e3 * residuals.total_mm / residuals.count).tolist(),
            rms_um=(1e3 * (residuals.square_mm2 / residuals.count) ** 0.5).tolist(),
            largest_um=(1e3 * residuals.largest_mm).tolist(),
        ),
        histogram_from_um=-1e3 * residuals.half_width_mm,
        histogram_to_um=1e3 * residuals.half_width_mm,
        histogram=residuals.histogram.tolist(),
    )
