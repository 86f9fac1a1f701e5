"""What the application asks of a SCARA's bench: the beam, the ways and the steps by hand."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.pointing import beam_miss
from catseye.drivers.roles.pose import Axes, Pose
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.system import System
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.ideal import ScaraBeam
from catseye.procedures.scara.manual_steps import PLACES, step_target
from catseye.procedures.scara.motion.entry import way_in

_AIMED_AT_MM: Final = 25.0
"""A beam that passes a reflector's place nearer than this is meant for it; rough places are no better known."""

_HEIGHT_ROUNDING_MM: Final = 0.1
"""J3 is not moved by hand; a controller reports it in steps of 0.01 mm."""


class ScaraSystem(System):
    """A SCARA that carries an interferometer."""

    def __init__(self, bench: ScaraBench) -> None:
        super().__init__(bench)
        self._scara = bench
        self._beam = ScaraBeam(bench)

    @property
    def rest(self) -> Pose:
        """Stretched out, at the height at which everything is measured."""
        return (0.0, 0.0, self._scara.j3_mm, 0.0)

    @property
    def manual_axes(self) -> Axes:
        """The arm's axes; J3, which is not moved by hand, has to stand at the cell's height."""
        one, two, height, four = self._scara.arm.axes
        low, high = height.low - _HEIGHT_ROUNDING_MM, height.high + _HEIGHT_ROUNDING_MM
        return (one, two, replace(height, low=low, high=high), four)

    @property
    def jog_names(self) -> tuple[str, ...]:
        """What is stepped by hand; "beam" turns J4."""
        return (*PLACES, "beam")

    def ideal_beam(self) -> ScaraBeam:
        """Return the beam of an ideal interferometer."""
        return self._beam

    def tool_mm(self, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where the J4 axis is in the plane, mm, shape (n, 2)."""
        return self._beam.tool_mm(poses)

    def way_in(self, here: Pose, target: Pose) -> tuple[Pose, ...]:
        """Return the targets that lead to a pose; see `entry.way_in`."""
        return way_in(here, target, self._scara)

    def step_target(self, here: Pose, name: str, by: float, aim: str | None = None) -> Pose:
        """Return the pose at the end of a step by hand; see `manual_steps.step_target`."""
        return step_target(self._scara, here, name, by, aim)

    def turned(self, turned_deg: float) -> "ScaraSystem":
        """Return the system with the interferometer mounted turned about the J4 axis, deg."""
        return ScaraSystem(self._scara.mounted(turned_deg))

    def aimed_at(self, pose: Pose) -> str | None:
        """Return the reflector that the beam is meant for; None when it passes all of them."""
        bench = self._scara
        theta1, theta2, _, theta4 = np.radians(pose)
        place_mm = forward(theta1, theta2, bench.link1_mm, bench.link2_mm)
        places_mm = np.array([[reflector.x_mm, reflector.y_mm] for reflector in bench.reflectors])
        world_rad = theta1 + theta2 + theta4 + math.radians(bench.optics.theta40_deg)
        miss_mm = beam_miss(place_mm, world_rad, places_mm)
        nearest = int(np.argmin(miss_mm))
        return bench.reflectors[nearest].name if miss_mm[nearest] <= _AIMED_AT_MM else None

    def aim_facts(self) -> dict[str, Json]:
        """Return places of the reflectors and direction of the beam."""
        places: dict[str, Json] = {one.name: [one.x_mm, one.y_mm] for one in self._scara.reflectors}
        return {"reflectors": places, "theta40_deg": self._scara.optics.theta40_deg}

    def aimed(self, facts: Mapping[str, Any]) -> ScaraBench:
        """Return the bench with places and direction that a run has stored."""
        places = {name: (float(x_mm), float(y_mm)) for name, (x_mm, y_mm) in facts["reflectors"].items()}
        return self._scara.aimed(places, float(facts["theta40_deg"]))
