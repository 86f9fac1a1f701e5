"""What two measurements of one arm have in common: errors that are the same in both are none of their difference.

The arm's own errors come again, and that of the laser's wavelength where both results name the same interferometer.
What else is `common` in a budget is common to one measurement: months later air and set-up err anew, and nothing says
how much of it is the same.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from catseye.app.cell.scara.uncertainty import WAVELENGTH
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Contributor
from catseye.calibration.scara.identification import IdentifiedArm


@dataclass(frozen=True)
class SharedErrors:
    """Errors of both arms that come from the same sources.

    Attributes:
        names: of the contributors.
        taken_up: what each of them has moved the parameters of both arms by, mm and rad, a column a source.
    """

    names: tuple[str, ...]
    taken_up: tuple[tuple[Floats, Floats], ...]

    @classmethod
    def of(cls, arms: tuple[IdentifiedArm, IdentifiedArm], *, same_laser: bool = False) -> Self:
        """Return what two results of one arm share: contributors that stand in both error budgets alike.

        Args:
            same_laser: both were measured with one interferometer.
        """
        first, second = ({_stated(one): moved for one, moved in arm.taken_up.items()} for arm in arms)
        both = [
            one
            for one in first
            if one in second
            and first[one].shape[1] == second[one].shape[1]
            and (same_laser or not is_of_laser(one))
        ]
        return cls(tuple(one.name for one in both), tuple((first[one], second[one]) for one in both))

    def covariance(self, first: Floats, second: Floats) -> Floats:
        """Return the covariance of linear functions of both arms' parameters.

        Args:
            first: what each parameter of the first arm contributes, shape (…, p).
            second: likewise of the second arm, shape (…, q).
        """
        found = np.zeros(first.shape[:-1])
        for one, other in self.taken_up:
            found += np.sum((first @ one) * (second @ other), axis=-1)
        return found


NOTHING_SHARED = SharedErrors((), ())


def is_of_laser(contributor: Contributor) -> bool:
    """Return whether a contributor is the error of a laser's own wavelength."""
    return (contributor.name, contributor.kind, contributor.correlation) == (WAVELENGTH, "scale", "common")


def _stated(contributor: Contributor) -> Contributor:
    """Return a contributor as it was stated: what distances have shown of it is each measurement's own affair."""
    return replace(contributor, spectrum=())
