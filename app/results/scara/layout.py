"""What the layout figure draws, from the bench or, without one, from a result alone."""

from dataclasses import dataclass

import numpy as np

from catseye.app.results.scara.identified_arm import nominal_of
from catseye.app.results.scara.result import Residuals, Result
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.pointing import visible
from catseye.procedures.scara.bench import Reflector, ScaraBench


@dataclass(frozen=True)
class Target:
    """A reflector in the scene.

    Attributes:
        name: its name.
        xy_mm: place, shape (2,).
        facing_deg: direction of its axis, None when it is not known.
        blind_mm: command positions from which it cannot be seen, shape (k, 2).
    """

    name: str
    xy_mm: Floats
    facing_deg: float | None
    blind_mm: Floats


@dataclass(frozen=True)
class Scene:
    """The bench from above.

    Attributes:
        link1_mm: nominal.
        link2_mm: nominal.
        theta_rad: distinct commands, shape (n, 2).
        targets: reflectors.
        column_radius_mm: of the base, None when it is not known.
        field_half_angle_deg: of the reflectors, None when it is not known.
        path_mm: validation path, shape (m, 2).
    """

    link1_mm: float
    link2_mm: float
    theta_rad: Floats
    targets: tuple[Target, ...]
    column_radius_mm: float | None
    field_half_angle_deg: float | None
    path_mm: Floats | None

    @property
    def commands_mm(self) -> Floats:
        """Command positions, shape (n, 2)."""
        return forward(self.theta_rad[:, 0], self.theta_rad[:, 1], self.link1_mm, self.link2_mm)

    @property
    def pose_rad(self) -> tuple[float, float]:
        """The command nearest to the middle of all."""
        scale = np.maximum(np.ptp(self.theta_rad, axis=0), 1e-12)
        away = np.sum(((self.theta_rad - np.median(self.theta_rad, axis=0)) / scale) ** 2, axis=1)
        theta1, theta2 = self.theta_rad[np.argmin(away)]
        return float(theta1), float(theta2)


def scene_of(bench: ScaraBench | None, result: Result | None, path_mm: Floats | None) -> Scene | None:
    """Return the scene, None when neither a bench nor a result with its commands is there.

    Args:
        result: where there is no bench.
        path_mm: validation path, shape (m, 2).
    """
    if bench is not None:
        return _of_bench(bench, path_mm)
    if result is None or result.residuals is None or not result.residuals.theta1_deg:
        return None
    return _of_result(result, result.residuals, path_mm)


def _of_bench(bench: ScaraBench, path_mm: Floats | None) -> Scene:
    grid = np.meshgrid(np.deg2rad(bench.nodes1_deg), np.deg2rad(bench.nodes2_deg), indexing="ij")
    theta = np.column_stack([angles.ravel() for angles in grid])
    positions = forward(theta[:, 0], theta[:, 1], bench.link1_mm, bench.link2_mm)
    return Scene(
        bench.link1_mm,
        bench.link2_mm,
        theta,
        tuple(
            Target(
                reflector.name,
                reflector.xy_mm,
                reflector.facing_deg,
                positions[~sees(bench, reflector, positions)],
            )
            for reflector in bench.reflectors
        ),
        bench.optics.column_radius_mm,
        bench.optics.field_half_angle_deg,
        path_mm,
    )


def sees(bench: ScaraBench, reflector: Reflector, positions_mm: Floats) -> Bools:
    """Return from which positions, shape (n, 2), a reflector is seen, shape (n,)."""
    optics = bench.optics
    return visible(
        positions_mm,
        reflector.xy_mm,
        float(np.deg2rad(reflector.facing_deg)),
        optics.column_radius_mm + optics.column_margin_mm,
        float(np.deg2rad(optics.field_half_angle_deg)),
        (optics.beam_min_mm, optics.beam_max_mm),
    )


def _of_result(result: Result, residuals: Residuals, path_mm: Floats | None) -> Scene:
    commands = np.unique(np.column_stack([residuals.theta1_deg, residuals.theta2_deg]), axis=0)
    nowhere = np.zeros((0, 2))
    return Scene(
        *nominal_of(result)[0],
        np.deg2rad(commands),
        tuple(
            Target(place.name, np.array([place.x_mm.value, place.y_mm.value]), None, nowhere)
            for place in result.reflectors
        ),
        None,
        None,
        path_mm,
    )
