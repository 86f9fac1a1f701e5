"""What rows say about some of the parameters: one small matrix for each set of rows, additive over sets.

The parameters that only one set depends on are its nuisances. Projecting its rows on what is orthogonal to them (the
Schur complement of the normal equations) leaves the information about the others alone, so that sets add up.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.core.whitening import through_sources


@dataclass(frozen=True)
class Information:
    """What a set of rows says about the wanted free directions, and about the sources of errors that rows share.

    Attributes:
        matrix: information about the directions from white errors alone, shape (..., f, f).
        effects: of the sources on them, shape (..., f, m).
        sources: information about the sources, shape (..., m, m).
    """

    matrix: Floats
    effects: Floats
    sources: Floats

    @classmethod
    def none(cls, free: int, sources: int) -> "Information":
        """Return what no row says."""
        return cls(np.zeros((free, free)), np.zeros((free, sources)), np.zeros((sources, sources)))

    @classmethod
    def stacked(cls, parts: Sequence["Information"]) -> "Information":
        """Return what each part says, along a first axis."""
        return cls(
            np.stack([one.matrix for one in parts]),
            np.stack([one.effects for one in parts]),
            np.stack([one.sources for one in parts]),
        )

    def __add__(self, other: "Information") -> "Information":
        """Return what both say together; shared sources are common to both."""
        return Information(
            self.matrix + other.matrix, self.effects + other.effects, self.sources + other.sources
        )

    def __getitem__(self, places: Ints | int | slice) -> "Information":
        """Return chosen parts of what is stacked."""
        return Information(self.matrix[places], self.effects[places], self.sources[places])

    def total(self) -> "Information":
        """Return what all that is stacked says together."""
        return Information(self.matrix.sum(axis=0), self.effects.sum(axis=0), self.sources.sum(axis=0))

    def times(self, repeats: int) -> "Information":
        """Return what so many repeats say: white errors average out, shared ones do not."""
        return Information(repeats * self.matrix, repeats * self.effects, repeats * self.sources)

    def counted(self, *, systematic: bool) -> Floats:
        """Return the information about the directions, shape (..., f, f).

        Args:
            systematic: with the sources as unknowns of unit variance; otherwise as if there were none.
        """
        return through_sources(self.matrix, self.effects, self.sources) if systematic else self.matrix


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
        effects = self.effects - taken @ (taken.T @ self.effects)
        return Information(wanted.T @ wanted, wanted.T @ effects, effects.T @ effects)
