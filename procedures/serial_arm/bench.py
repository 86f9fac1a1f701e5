"""The bench of a serial arm whose tool carries targets, and the instrument that measures them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.gravity import Load
from catseye.calibration.kinematics.rotations import inverted, pose_of
from catseye.drivers.roles.tracker import Place, TrackerAbilities
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.errors import PlanError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ToolTarget:
    """A target on the tool.

    Attributes:
        place_mm: in the frame of the flange.
        normal: into which it looks, in that frame; None where it is seen from everywhere.
    """

    name: str
    place_mm: Place
    normal: Place | None = None


@dataclass(frozen=True)
class FixedNest:
    """A nest that stays where it is; three of them make the world frame.

    Attributes:
        place_mm: roughly, in the instrument's frame.
    """

    name: str
    place_mm: Place


@dataclass(frozen=True)
class Instrument:
    """A laser tracker or an optical CMM on its stand.

    Attributes:
        abilities: of its driver.
        base_mm: place of the arm's base in the instrument's frame, roughly.
        base_deg: its rotation there, R = Rz · Ry · Rx.
        cone_deg: largest angle between the normal of a nest and the line of sight.
        face_deg: largest angle between the normal of a face of marks and the line of sight of an optical CMM.
        nests: that make the world frame.
    """

    abilities: TrackerAbilities
    base_mm: Place
    base_deg: Place
    cone_deg: float = 30.0
    face_deg: float = 15.0
    nests: tuple[FixedNest, ...] = ()

    @cached_property
    def base(self) -> Floats:
        """The arm's base in the instrument's frame, shape (4, 4)."""
        return pose_of(np.array(self.base_mm), np.array(self.base_deg))

    @cached_property
    def station_mm(self) -> Floats:
        """Where the instrument stands in the frame of the arm's base, shape (3,)."""
        return inverted(self.base)[:3, 3]


@dataclass(frozen=True)
class Ballbar:
    """A telescopic ballbar.

    Attributes:
        length_mm: in the middle of its range.
        range_mm: that it lengthens and shortens by.
        u_length_mm: standard uncertainty of a length.
        centre_mm: of the fixed cup, in the frame of the arm's base, roughly.
        radius_mm: of its body.
    """

    length_mm: float
    range_mm: float
    u_length_mm: float
    centre_mm: Place
    radius_mm: float = 15.0


@dataclass(frozen=True, kw_only=True)
class SerialBench(Bench):
    """A serial arm with targets.

    Attributes:
        instrument: that sees them.
        targets: on the tool.
        loads: masses of the links, and of the tool as the last.
        ballbar: None where the cell has none.
    """

    instrument: Instrument
    targets: tuple[ToolTarget, ...]
    loads: tuple[Load, ...] = ()
    ballbar: Ballbar | None = None

    def target(self, name: str) -> ToolTarget:
        """Return a target by its name.

        Raises:
            PlanError: the tool has no such target.
        """
        found = next((one for one in self.targets if one.name == name), None)
        if found is None:
            names = ", ".join(one.name for one in self.targets) or "none"
            raise PlanError(
                f"the tool has no target {name}: choose among {names}, or add [[target]] to its file"
            )
        return found

    def chosen(self, names: list[str]) -> tuple[ToolTarget, ...]:
        """Return targets by their names; all when there are no names.

        Raises:
            PlanError: the tool has no such target, or none at all.
        """
        found = tuple(map(self.target, names)) or self.targets
        if not found:
            raise PlanError("the tool has no targets: add [[target]] to its file")
        return found


def ballbar_of(bench: SerialBench) -> Ballbar:
    """Return the ballbar of a bench.

    Raises:
        PlanError: its cell file has none.
    """
    if bench.ballbar is None:
        raise PlanError(f"[ballbar] is missing: add it with centre_mm to the cell file {bench.name}")
    return bench.ballbar
