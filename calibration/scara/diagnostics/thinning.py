"""Fewer distances of a long table, where all of them would say the same and take long."""

from dataclasses import replace

import numpy as np

from catseye.calibration.scara.identification import Identification

MOST_ROWS = 10_000
"""Distances beyond which evenly spread ones serve."""


def thinned(identified: Identification) -> Identification:
    """Return an identification with each so many-th distance of each segment, so that none loses all."""
    points = identified.points
    every = -(-len(points) // MOST_ROWS)
    if every == 1:
        return identified
    order = np.argsort(points.dead_path, kind="stable")
    counts = np.bincount(points.dead_path, minlength=len(points.dead_paths))
    place = np.empty(len(points), dtype=np.int64)
    place[order] = np.arange(len(points)) - np.repeat(np.cumsum(counts) - counts, counts)
    kept = np.flatnonzero(place % every == 0)
    return replace(identified, points=points.rows(kept), residuals_mm=identified.residuals_mm[kept])
