"""Where the poses of a run lie: those to come, those that were measured, and those whose targets were hidden."""

from collections import defaultdict
from typing import Final

import numpy as np

from catseye.app.cell.arm import arm_description
from catseye.app.cell.serial_arm import chain_of
from catseye.app.results.figures import Axis, Figure, Panel, Points, Role
from catseye.app.results.runs.run_source import cell_of_run
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Bools, Floats
from catseye.procedures.serial_arm.records import PLANNED, VISITS

_VIEWS: Final = (("from above", 0, 1), ("from the side", 0, 2))


def places_figure(reader: RunReader) -> Figure | None:
    """Return the poses of a run that measures targets at poses; None of another run, and of older programs'."""
    planned = reader.data_of(PLANNED)
    if not planned:
        return None
    poses = np.array(planned[-1]["poses"], dtype=np.float64)
    places = chain_of(arm_description(cell_of_run(reader).robot.arm)).flange(poses)[:, :3, 3]
    measured, hidden = _visited(reader, len(poses))
    shown = (
        ("to come", ~measured & ~hidden, Role.MUTED, "o", True),
        ("measured", measured, Role.QUANTILE, "o", False),
        ("hidden", hidden, Role.ABOVE, "x", False),
    )
    panels = tuple(
        Panel(
            title,
            Axis(f"{'xyz'[i]} / mm"),
            Axis(f"{'xyz'[j]} / mm"),
            tuple(
                _points(places[those], (i, j), f"{label}: {those.sum()}", ink, marker, hollow=hollow)
                for label, those, ink, marker, hollow in shown
                if those.any()
            ),
            equal=True,
        )
        for title, i, j in _VIEWS
    )
    caption = (
        "The flange at each pose, in the frame of the base. Hidden: none of its targets was seen; a pose that is "
        "measured again at the end may still change to measured."
    )
    return Figure("pose-places", "Poses of the run", caption, (panels,))


def _points(
    places: Floats, view: tuple[int, int], label: str, ink: Role, marker: str, *, hollow: bool
) -> Points:
    i, j = view
    return Points(places[:, i], places[:, j], ink, label, marker=marker, hollow=hollow)


def _visited(reader: RunReader, count: int) -> tuple[Bools, Bools]:
    """Return which poses have a measured target, and which were visited without one, shape (count,) each."""
    seen: dict[int, bool] = defaultdict(bool)
    for step in reader.steps():
        visit, _, number = step.step_id.partition("/")
        if visit in VISITS:
            seen[int(number)] |= bool(step.result.get("measured"))
    measured = np.array([seen.get(number, False) for number in range(count)])
    visited = np.array([number in seen for number in range(count)])
    return measured, visited & ~measured
