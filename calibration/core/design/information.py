"""What rows say about some of the parameters: one small matrix for each set of rows, additive over sets.

The parameters that only one set depends on are its nuisances. Projecting its rows on what is orthogonal to them (the
Schur complement of the normal equations) leaves the information about the others alone, so that sets add up.
"""

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from catseye.calibration.core.types import Bools, Floats


@dataclass(frozen=True)
class Information:
    """What a set of rows says about the wanted free directions.

    Attributes:
        matrix: information about them, shape (f, f).
        effects: shared errors seen through the fit, shape (f, m); the covariance that they add is
            (C effects)(C effects)ᵀ with C the inverse of the matrix.
    """

    matrix: Floats
    effects: Floats

    def __add__(self, other: "Information") -> "Information":
        """Return what both say together; shared sources are common to both."""
        return Information(self.matrix + other.matrix, self.effects + other.effects)

    def times(self, repeats: int) -> "Information":
        """Return what so many repeats say: white errors average out, shared ones do not."""
        return Information(repeats * self.matrix, repeats * self.effects)


@dataclass(frozen=True)
class Rows:
    """A set of weighted rows, zero where there is none.

    Attributes:
        wanted: derivatives by the wanted free directions, shape (n, f).
        nuisance: derivatives by parameters that only this set depends on (sign aside), shape (n, k).
        effects: of shared errors, shape (n, m).
    """

    wanted: Floats
    nuisance: Floats
    effects: Floats

    def of(self, kept: Bools) -> "Rows":
        """Return the rows that are kept; flags of shape (n,)."""
        flags = kept[:, None]
        return Rows(self.wanted * flags, self.nuisance * flags, self.effects * flags)

    def information(self) -> Information:
        """Eliminate the nuisances."""
        norms = np.linalg.norm(self.nuisance, axis=0)
        taken = linalg.orth(self.nuisance / np.where(norms > 0.0, norms, 1.0), rcond=1e-10)
        wanted = self.wanted - taken @ (taken.T @ self.wanted)
        return Information(wanted.T @ wanted, wanted.T @ self.effects)
