"""Readings that the indicator's own program has recorded: a file of one cycle, in the order of driving."""

from collections.abc import Sequence
from functools import partial
from typing import Final

import numpy as np

from catseye.procedures.kit.asked_file import asked_file
from catseye.procedures.kit.columns import ColumnRule, Columns, TableRule
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import TableFileError

_ANGLE: Final = ColumnRule("angle_deg", unit="deg", largest=720.0, hint="state it in deg")

READINGS: Final = TableRule(
    "readings",
    "the angle of the joint and what the indicator read there",
    (
        (
            _ANGLE,
            ColumnRule(
                "reading_mm", unit="mm", largest=2.0, hint="if it is in µm, call the column reading_um"
            ),
        ),
        (
            _ANGLE,
            ColumnRule("reading_um", unit="µm", largest=2000.0, hint="if it is in nm, convert it to µm"),
        ),
    ),
    mixed="readings in µm and in mm stand in one file: keep one of reading_um and reading_mm",
    source="the indicator's program, as angle_deg,reading_um or angle_deg,reading_mm",
)
"""More where the artefact is nearer, as readings that are typed."""

_UM_PER_MM: Final = 1000.0

_NEAR: Final = 0.25
"""Of a step: so far from its place an angle may be stated."""


async def recorded_um(ctx: Context, prompt: Prompt, due_deg: Sequence[float], step_deg: float) -> list[float]:
    """Ask for the file of a cycle until it can be used; return its readings, µm.

    Args:
        due_deg: angles at which the joint has stood, in order.
        step_deg: between two places.

    Raises:
        TableFileError: too many files could not be used.
    """
    matched = partial(matched_um, due_deg=due_deg, step_deg=step_deg)
    return (await asked_file(ctx, prompt, READINGS, _ideal(due_deg), matched))[1]


def matched_um(file: str, table: Columns, due_deg: Sequence[float], step_deg: float) -> list[float]:
    """Return the reading at each place, µm.

    Raises:
        TableFileError: there are more or fewer of them than places, or one stands at another angle.
    """
    angles = table["angle_deg"]
    for place, (angle_deg, wanted_deg) in enumerate(zip(angles, due_deg, strict=False)):
        if abs(angle_deg - wanted_deg) > _NEAR * step_deg:
            raise TableFileError(
                f"{file}:{table.lines[place]}: {angle_deg:g}° where {wanted_deg:g}° is due: give "
                "the readings in the order in which the joint stood still, upwards and then downwards, with the "
                "angles that the question before has named"
            )
    if len(table) != len(due_deg):
        raise TableFileError(
            f"{file} holds {len(table)} readings, and the joint stood still {len(due_deg)} times, from "
            f"{due_deg[0]:g}° to {max(due_deg, key=lambda each: abs(each - due_deg[0])):g}° and back: give one "
            "reading for each, of this cycle alone"
        )
    in_mm = table.get("reading_mm")
    return [float(value) for value in (table["reading_um"] if in_mm is None else _UM_PER_MM * in_mm)]


def _ideal(due_deg: Sequence[float]) -> Columns:
    """Return what is read of an axis without error."""
    count = len(due_deg)
    values = {"angle_deg": np.array(due_deg), "reading_um": np.zeros(count)}
    return Columns(values, np.arange(count) + 2)
