"""What an ideal instrument on an ideal arm sees: rehearsals measure with it."""

from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from catseye.drivers.roles.pose import Pose

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Hit:
    """A target that returns the beam.

    Attributes:
        target: its name.
        length_mm: length of the beam.
    """

    target: str
    length_mm: float


@dataclass(frozen=True)
class Watched:
    """How well a beam was kept on its target over a way.

    Attributes:
        kept: it returned everywhere.
        miss_mm: largest distance of the target from the beam; None where the way did not try to keep it.
    """

    kept: bool
    miss_mm: float | None


class IdealBeam(Protocol):
    """The beam of an instrument on the arm.

    Attributes:
        max_miss_mm: largest miss that plans allow themselves along their ways.
        acceptance_mm: largest miss at which the beam returns.
    """

    @property
    def max_miss_mm(self) -> float: ...  # noqa: D102  # said above
    @property
    def acceptance_mm(self) -> float: ...  # noqa: D102  # said above

    def hit(self, pose: Pose) -> Hit | None:
        """Return the nearest target that returns the beam at a pose."""
        ...

    def watch(self, poses: Floats, target: str) -> Watched:
        """Return how well the beam keeps to a target over poses, shape (n, axes)."""
        ...


class SteadyBeam(IdealBeam):
    """Optics that are set up where the arm stands: their beam returns as long as the plan keeps them in range."""

    max_miss_mm: Final = 0.0
    acceptance_mm: Final = 0.0

    def hit(self, pose: Pose) -> Hit | None:
        """Return the retroreflector; its displacement is not modelled."""
        del pose
        return Hit("retroreflector", 0.0)

    def watch(self, poses: Floats, target: str) -> Watched:
        """Return that the beam is kept."""
        del poses, target
        return Watched(kept=True, miss_mm=None)


class NoBeam(IdealBeam):
    """An arm without a beam."""

    max_miss_mm: Final = 0.0
    acceptance_mm: Final = 0.0

    def hit(self, pose: Pose) -> Hit | None:
        """Return None: there is no target."""
        del pose
        return None

    def watch(self, poses: Floats, target: str) -> Watched:
        """Refuse: nothing was ever hit."""
        del poses
        raise KeyError(target)
