"""What a design of reflectors and commands is judged by, as a user sees it."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.design import criteria

_MDEG = 1e3 * 180.0 / np.pi


@dataclass(frozen=True)
class Criterion(criteria.Criterion):
    """A criterion whose free directions are in rad and whose combinations are x and y on a path, mm."""

    @property
    def unit(self) -> str:
        """Unit of what a value is shown as."""
        return "µm" if self.name == "path" else "mdeg"

    @property
    def meaning(self) -> str:
        """What a value is shown as."""
        return {
            "A": "rms uncertainty of maps and links",
            "D": "geometric mean of the uncertainties of all principal combinations",
            "E": "uncertainty of the worst combination",
            "path": "largest uncertainty of x or y on the path",
        }[self.name]

    def shown(self, value: float) -> float:
        """Return a value as the standard uncertainty that it stands for, in `unit`."""
        return (1e3 if self.name == "path" else _MDEG) * self.standard_uncertainty(value)
