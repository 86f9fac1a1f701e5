"""Values of a cell file that are possible and hardly meant: a slip of a unit or of a digit, as a rule."""

import math
from collections.abc import Iterator

from catseye.app.cell.arm import arm_description
from catseye.app.cell.bench import stated_scara_sections
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.plausible import implausible_sections
from catseye.calibration.air import HE_NE_RELATIVE_U, HE_NE_VACUUM_NM

_LONGEST_WAIT_S = 30.0
_LARGEST_SPREAD_UM = 1000.0


def implausible(cell: Cell) -> list[str]:
    """Return what is hardly meant, each with the key, the value and what would be usual."""
    scara, description = stated_scara_sections(cell), arm_description(cell.robot.arm)
    doubts = [] if scara.missing else implausible_sections(scara, description, cell.body)
    return [*_timing(cell), *_scale(cell), *doubts]


def _timing(cell: Cell) -> Iterator[str]:
    timing = cell.measurement
    for key in ("settle_time_s", "dwell_time_s"):
        value_s = getattr(timing, key)
        if value_s > _LONGEST_WAIT_S:
            yield f"measurement.{key} = {value_s:g}: seconds at each point; usual are 0.2 … 5"
    if timing.spread_limit_um > _LARGEST_SPREAD_UM:
        yield f"measurement.spread_limit_um = {timing.spread_limit_um:g}: readings that scatter by a mm; usual are 5"


def _scale(cell: Cell) -> Iterator[str]:
    if cell.interferometer is None or cell.air.vacuum_wavelength_nm != HE_NE_VACUUM_NM:
        return
    scales = (one for one in cell.uncertainty.budget.systematic if one.kind == "scale")
    stated_ppm, any_laser_ppm = 1e6 * math.hypot(*(one.u for one in scales)), 1e6 * HE_NE_RELATIVE_U
    if stated_ppm < 0.99 * any_laser_ppm:
        yield (
            f"air.vacuum_wavelength_nm = {HE_NE_VACUUM_NM:g}: is that of any helium-neon laser, good to "
            f"{any_laser_ppm:g} ppm, and the common scale errors of the budget are {stated_ppm:.2g} ppm: write the "
            f"wavelength of the laser's certificate, or {any_laser_ppm:g} ppm into the contributor wavelength"
        )
