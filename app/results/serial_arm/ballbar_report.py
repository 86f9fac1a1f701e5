"""What a ballbar says of compensated commands: Tables XII and XIII and Figures 13 to 16 of the six-axis paper."""

import numpy as np

from catseye.app.results.model import Block, Bullets, Cell, Column, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, counted, fixed, number
from catseye.app.results.serial_arm.figures import signed_by_target
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats
from catseye.procedures.kit.stored import number_of
from catseye.procedures.serial_arm.ballbar_run import BallbarReading
from catseye.procedures.serial_arm.length_scatter import scatter_of

_SIGNED = fixed(3, signed=True)
_MM = fixed(3)

_ABOUT = (
    "Error: length that was read less the nominal one, which every command of the calibrated arm is to keep. The "
    "place of the cup is part of it: it is as well known as the calibrated arm led to it.",
)


def ballbar_section(reader: RunReader) -> Section:
    """Return the errors of length of a run with a ballbar, by nest; nothing of a run without readings."""
    rows = reader.rows(BallbarReading.table)
    nests = [str(row["nest"]) for row in rows]
    errors_mm = np.array([number_of(row, "error_mm") for row in rows])
    if not rows:
        return section("ballbar", "Ballbar", [])
    of_nest = {nest: errors_mm[[one == nest for one in nests]] for nest in dict.fromkeys(nests)}
    figure = signed_by_target(
        "ballbar", "Length errors of the ballbar", [("compensated", errors_mm)], nests, "error / mm"
    )
    blocks: list[Block] = [_said(errors_mm), _table(of_nest), Bullets("", _ABOUT), figure]
    return section("ballbar", "Ballbar", blocks, brief=True)


def _said(errors_mm: Floats) -> Statement:
    most = number(float(np.abs(errors_mm).max()), _MM)
    read = counted(len(errors_mm), "length")
    text = f"{read}, off by {most} mm at most, {number(float(errors_mm.mean()), _SIGNED)} mm on average."
    return Statement(Sign.NEUTRAL, text, f"lengths off ≤ {most} mm")


def _table(of_nest: dict[str, Floats]) -> Table:
    columns = (
        Column("nest", "nest"),
        Column("n", "readings", "", COUNT),
        Column("mean_mm", "mean error", "mm", _SIGNED),
        Column("std_mm", "standard deviation", "mm", _MM),
        Column("max_mm", "largest", "mm", _MM),
    )
    rows: list[tuple[Cell, ...]] = [
        (nest, len(errors), float(errors.mean()), scatter_of(errors), float(np.abs(errors).max()))
        for nest, errors in of_nest.items()
    ]
    return Table("ballbar", "Errors of length at compensated commands", columns, tuple(rows))
