"""What two measurements of one arm have in common: errors that are the same in both are none of their difference.

Only the arm's own errors come again. `common` in a budget is common to one measurement: months later laser, air and
set-up err anew, and nothing says how much of it is the same.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

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
    def of(cls, arms: tuple[IdentifiedArm, IdentifiedArm]) -> Self:
        """Return what two results of one arm share: contributors that stand in both error budgets alike."""
        first, second = ({_stated(one): moved for one, moved in arm.taken_up.items()} for arm in arms)
        both = [one for one in first if one in second and first[one].shape[1] == second[one].shape[1]]
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


def _stated(contributor: Contributor) -> Contributor:
    """Return a contributor as it was stated: what distances have shown of it is each measurement's own affair."""
    return replace(contributor, spectrum=())
