"""The counter while it is measured with: its sign and scale show in the first distances."""

from typing import Final

import numpy as np

from catseye.calibration.scara.plausibility.counter import SCALE_BOUND, CounterScale, counter_scale
from catseye.calibration.scara.plausibility.units import unit_of
from catseye.calibration.scara.points import Commands, Points
from catseye.procedures.kit.errors import CounterError
from catseye.procedures.scara.bench import ScaraBench

_LOOKED_AT: Final = 20
"""Distances of a run whose counts are compared with the arm's geometry."""


_SHOWN: Final = 0.05
"""What is off by so much has to be recognised where a scale is said to have been looked at."""

_CONFUSED: Final = {
    "m": "m were read as mm, or mm as µm",
    "µm": "µm were read as mm, or nm as µm",
    "mm that were taken for inches": "mm were read as inches",
}
"""What makes numbers as large as those of a unit: a profile may state another one than mm."""


class CounterWatch:
    """Compares the first counts of a run with the way of the arm.

    Args:
        bench: nominal links, and the reflectors as they are aimed at.
        u_place_mm: standard uncertainty of the coordinates of their places.
    """

    def __init__(self, bench: ScaraBench, u_place_mm: float = 20.0) -> None:
        self._u_place_mm = u_place_mm
        self._bench = bench
        self._names = tuple(reflector.name for reflector in bench.reflectors)
        self._rows: list[tuple[float, float, int, int, float]] = []

    def take(
        self, reflector: str, segment: int, theta1_deg: float, theta2_deg: float, displacement_mm: float
    ) -> None:
        """Take a count in.

        Raises:
            CounterError: the counts so far cannot be those of a counter in mm that rises with the beam.
        """
        if len(self._rows) >= _LOOKED_AT:
            return
        row = theta1_deg, theta2_deg, self._names.index(reflector), segment, displacement_mm
        self._rows.append(row)
        scale = self.scale
        if scale is not None and scale.wrong:
            raise CounterError(_text(scale, len(self._rows)))

    @property
    def scale(self) -> CounterScale | None:
        """What the counts so far are worth; None while they do not show it."""
        if not self._rows:
            return None
        bench = self._bench
        places = np.array([one.xy_mm for one in bench.reflectors])
        return counter_scale(self._points(), (bench.link1_mm, bench.link2_mm), places, self._u_place_mm)

    @property
    def shows_scale(self) -> bool:
        """A scale that is off by 5 % would be called wrong."""
        return self.scale is not None and self.scale.shows(_SHOWN)

    def _points(self) -> Points:
        one, two, reflector, segment, displacement = zip(*self._rows, strict=True)
        keys = list(dict.fromkeys(zip(reflector, segment, strict=True)))
        number = [keys.index(key) for key in zip(reflector, segment, strict=True)]
        state = np.ones(len(number), dtype=np.int64)
        return Points(
            Commands(np.deg2rad(one), np.deg2rad(two), state, state),
            np.array(reflector, dtype=np.int64),
            np.array(number, dtype=np.int64),
            np.array(displacement, dtype=np.float64),
            None,
            self._names,
            tuple((self._names[place], segment) for place, segment in keys),
        )


def _text(scale: CounterScale, count: int) -> str:
    factor = abs(scale.mm_per_unit)
    faults = []
    if abs(factor - 1.0) > SCALE_BOUND:
        unit = unit_of(factor)
        like = (
            ", unless link1_mm and link2_mm of the cell are those of another arm"
            if unit is None
            else f", as if {_CONFUSED.get(unit, f'{unit} were read as mm')}"
        )
        faults.append(f"gives {1.0 / factor:.4g} mm where the beam changes by 1 mm{like}")
    if scale.mm_per_unit < 0.0:
        faults.append("falls where the beam grows longer: its sign is reversed")
    return (
        f"the counter {' and '.join(faults)} (from {count} distances and the way of the arm): correct sign, unit "
        "and scale in the profile or the settings of [interferometer], and start again; nothing counted so far "
        "can be used"
    )
