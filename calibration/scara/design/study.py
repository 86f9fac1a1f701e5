"""What distances to a reflector say about the arm; its coordinates and its dead paths are nuisances of its own."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import linalg

from catseye.calibration.core.design.information import Information, Rows
from catseye.calibration.core.errors import BudgetError
from catseye.calibration.core.rank import require_identifiable
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening
from catseye.calibration.scara.arm import ArmDesign, arm_design
from catseye.calibration.scara.budget import Budget
from catseye.calibration.scara.budget_effects import (
    Geometry,
    combined_white_mm,
    seen_along,
    systematic_effects,
)
from catseye.calibration.scara.design.sight import Sight
from catseye.calibration.scara.identification import IdentifiedArm
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.planar import require_links
from catseye.calibration.scara.points import Commands, Points


@dataclass(frozen=True)
class Study:
    """The arm and the commands that a design is made for.

    The free directions are those of the gauge, with links divided by the arm's reach: an uncertainty of a link counts
    as the angle that it looks like at full reach. All of them are in rad then.

    Attributes:
        layout: parameters of the arm, without reflectors.
        link1_mm: nominal length of link 1.
        link2_mm: nominal length of link 2.
        commands: where the arm is sent, n rows.
        budget: contributors to the uncertainty of a distance.
        mount_rad: by how much the interferometer is turned on J4's flange, shape (n,); None for 0.
    """

    layout: Layout
    link1_mm: float
    link2_mm: float
    commands: Commands
    budget: Budget
    mount_rad: Floats | None = None

    def __post_init__(self) -> None:
        require_links(self.link1_mm, self.link2_mm)

    @property
    def reach_mm(self) -> float:
        """Both links stretched out, mm."""
        return self.link1_mm + self.link2_mm

    @property
    def parameters(self) -> Floats:
        """The nominal arm as parameters, shape (p,)."""
        return np.concatenate([[self.link1_mm, self.link2_mm], np.zeros(self.layout.arm_size - 2)])

    @cached_property
    def basis(self) -> Floats:
        """Steps of the arm's parameters for unit steps in the free directions, shape (p, f)."""
        basis = self.layout.gauge_basis().copy()
        basis[:2] *= self.reach_mm
        return basis

    @cached_property
    def _prepared(self) -> tuple[ArmDesign, Floats, Floats]:
        """The commands, their positions, shape (n, 2), and gradients of these, shape (n, 2, f)."""
        design = arm_design(self.layout, self.commands)
        return design, design.positions(self.parameters), self.gradient(design)

    @cached_property
    def _local(self) -> Floats:
        """Derivatives of the positions by L1, L2, θ1 and θ2, shape (n, 2, 4)."""
        return self._prepared[0].local_jacobian(self.parameters)

    def gradient(self, design: ArmDesign) -> Floats:
        """Return the derivatives of positions by the free directions, shape (n, 2, f), mm/rad."""
        local = design.local_jacobian(self.parameters)
        return np.stack([design.spread(local[:, axis]) @ self.basis for axis in range(2)], axis=1)

    def rows(self, sight: Sight) -> Rows:
        """Return the weighted rows of the distances to a reflector, in measuring order.

        Rows of a reflector are made independent of what passes; they keep what they share otherwise.

        Raises:
            BudgetError: the budget has no white contributor, so that a distance would be exact.
        """
        geometry, weight = self._seen(sight)
        # When a reflector will be measured is open: what passes is another for each of them.
        own = Whitening(np.ones(len(weight)), weight * systematic_effects(self.budget.passing, geometry))
        return Rows(
            own.again(weight * np.einsum("ni,nif->nf", geometry.unit, self._prepared[2])),
            own.again(_nuisance(sight, geometry, weight)),
            own.again(weight * systematic_effects(self.budget.lasting, geometry)),
        )

    def _seen(self, sight: Sight) -> tuple[Geometry, Floats]:
        """Return how the distances to a reflector answer to the arm, and their weights, 1/mm, shape (n, 1)."""
        positions = self._prepared[1]
        beam = positions - sight.xy_mm
        length = np.hypot(beam[:, 0], beam[:, 1])
        # A place that the J4 axis passes over has no beam there; it is not seen from there either.
        unit = beam / np.where(length > 0.0, length, 1.0)[:, None]
        nothing = np.zeros(len(self.commands), dtype=np.int64)
        # A remounted interferometer begins a segment, whatever breaks the beam.
        mounts = nothing if self.mount_rad is None else self.mount_rad
        series = np.unique(np.column_stack([sight.segment, mounts]), axis=0, return_inverse=True)[1].ravel()
        paths = tuple(("", number) for number in range(int(series.max()) + 1))
        points = Points(self.commands, nothing, series, length, None, ("",), paths, mount_rad=self.mount_rad)
        turn = np.einsum("ni,nij->nj", unit, self._local[:, :, 2:])
        geometry = seen_along(points, positions, (unit, length), turn, self.layout)
        sigma = combined_white_mm(self.budget, geometry)
        if not sigma.all():
            raise BudgetError("a distance without white uncertainty would be exact; state one in the budget")
        return geometry, np.where(sight.seen, 1.0 / sigma, 0.0)[:, None]

    def require_determined(self, sights: Sequence[Sight]) -> None:
        """Refuse a layout that leaves parameters undetermined.

        Raises:
            UnidentifiableError: names the parameters of each null direction and what to measure.
        """
        named = [(f"P{k}", sight) for k, sight in enumerate(sights, 1)]
        layout = replace(
            self.layout,
            reflector_names=tuple(name for name, _ in named),
            dead_paths=tuple((name, part) for name, sight in named for part in range(sight.segments)),
        )
        nuisances = [_nuisance(sight, *self._seen(sight)) for sight in sights]
        places = linalg.block_diag(*(one[:, :2] for one in nuisances))
        dead_paths = linalg.block_diag(*(one[:, 2:] for one in nuisances))
        # All parameters, not the free directions: a value that no command touches is known by its column of zeros.
        design, _, _ = self._prepared
        arm = [design.spread(np.einsum("ni,nij->nj", one[:, :2], self._local)) for one in nuisances]
        jacobian = np.hstack([np.vstack(arm), places, dead_paths])
        require_identifiable(layout.parameters(), jacobian)

    def covariance(self, information: Information, *, systematic: bool) -> Floats:
        """Return the covariance in the free directions, shape (f, f).

        Args:
            information: of a layout; regular.
            systematic: with what does not average out.
        """
        return np.asarray(np.linalg.inv(information.counted(systematic=systematic)), dtype=np.float64)

    def arm(self, covariance: Floats) -> IdentifiedArm:
        """Return the nominal arm with a covariance in the free directions, as if it had been identified."""
        return IdentifiedArm(self.layout, self.parameters, self.basis @ covariance @ self.basis.T)


def _nuisance(sight: Sight, geometry: Geometry, weight: Floats) -> Floats:
    """Return the weighted derivatives by a reflector's place and dead paths, shape (n, 2 + segments)."""
    segments = sight.segment[:, None] == np.arange(sight.segments)
    return np.asarray(weight * np.hstack([geometry.unit, segments]))
