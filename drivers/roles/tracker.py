"""An independent instrument that locates targets on the arm: a laser tracker, or an optical CMM."""

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import ClassVar, Final, Literal, Protocol

from catseye.drivers.roles.device import Device, DriverClass, Role
from catseye.drivers.roles.errors import HiddenTargetError, RefusedError

Place = tuple[float, float, float]
"""x, y, z, mm."""

_LEAST_SINE: Final = 0.05
"""Of the angle at the first of three places that make a frame: three degrees."""

Face = Literal[1, 2]
"""Of a tracker: turned about its standing axis by half a turn and over, its face errors change their sign."""


@dataclass(frozen=True)
class Position:
    """A measured position in a plane, in the instrument's own frame.

    Attributes:
        x_mm: along x.
        y_mm: along y.
        u_mm: standard uncertainty of each coordinate.
    """

    x_mm: float
    y_mm: float
    u_mm: float


@dataclass(frozen=True)
class TargetPoint:
    """A measured target, in the instrument's own frame.

    Attributes:
        place_mm: x, y, z.
        u_mm: standard uncertainty of x, y and z, as the instrument states or scatters it; None where it says nothing.
        covariance_mm2: of x with y, x with z and y with z; None where it states none, which does not mean zero.
    """

    place_mm: Place
    u_mm: Place | None = None
    covariance_mm2: Place | None = None


@dataclass(frozen=True)
class TargetPose:
    """A measured frame, in the instrument's own frame.

    Attributes:
        place_mm: x, y, z of its origin.
        turn_deg: rx, ry, rz with R = Rz · Ry · Rx.
        visible: how many marks were seen; None where the instrument does not say.
        base_visible: likewise of the marks on the base, whose frame the pose is in.
        u_mm: standard uncertainty of x, y and z; None where it says nothing.
        u_deg: standard uncertainty of the rotations; None where it says nothing.
    """

    place_mm: Place
    turn_deg: Place
    visible: int | None = None
    u_mm: Place | None = None
    u_deg: Place | None = None
    base_visible: int | None = None


def require_near(where: str, target: str, place_mm: Place, near_mm: Place, radius_mm: float) -> None:
    """Check that a target is the one that was asked for, by its place.

    Args:
        where: device and endpoint, for the text.
        near_mm: where it was expected.
        radius_mm: how far it may be from there; a setting called search_radius_mm.

    Raises:
        HiddenTargetError: it is another one.
    """
    off_mm = math.dist(place_mm, near_mm)
    if off_mm > radius_mm:
        raise HiddenTargetError(
            f"{where}: {target} was expected at {place_text(near_mm)} mm and a target {off_mm:.1f} mm away from "
            f"there is seen, at {place_text(place_mm)} mm: another one, or search_radius_mm is too small"
        )


def place_text(place_mm: Place) -> str:
    """Return a place for a text."""
    return ", ".join(f"{value:.2f}" for value in place_mm)


def on_a_line(one: Sequence[float], other: Sequence[float], third: Sequence[float]) -> bool:
    """Return whether three places make no frame, or one that turns with the noise."""
    sides = [[b - a for a, b in zip(one, place, strict=True)] for place in (other, third)]
    across = math.hypot(
        *(sides[0][k - 2] * sides[1][k - 1] - sides[0][k - 1] * sides[1][k - 2] for k in range(3))
    )
    return across <= _LEAST_SINE * math.hypot(*sides[0]) * math.hypot(*sides[1])


@dataclass(frozen=True)
class TrackerAbilities:
    """What a tracker's driver is able to do; a class attribute of the driver.

    Attributes:
        points: `point` measures a target in three coordinates.
        poses: `pose` measures a frame.
        finds: it turns to a target by itself, given roughly where that is.
        two_faces: `point` measures in the second face, too.
    """

    points: bool = False
    poses: bool = False
    finds: bool = False
    two_faces: bool = False

    def named(self) -> tuple[str, ...]:
        """Return the names of what it is able to do."""
        return tuple(each.name for each in fields(self) if getattr(self, each.name))


class Tracker(Device, Protocol):
    """An independent instrument, such as a laser tracker.

    Attributes:
        has_hands: its endpoint is the control port of an emulated bench, which does what operators are asked for.
    """

    role: ClassVar[Role] = "tracker"
    has_hands: ClassVar[bool] = False

    @property
    @abstractmethod
    def abilities(self) -> TrackerAbilities:
        """What the driver is able to do; driver classes declare it as a class attribute."""
        ...

    async def locate(self) -> Position:
        """Return the position of the target in the horizontal plane, in which a SCARA moves.

        Raises:
            DeviceError: it cannot be measured.
        """
        raise RefusedError("this tracker's driver locates nothing in a plane", 0)

    async def point(
        self, target: str, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Measure a target that stands still.

        Only for drivers whose abilities say so.

        Args:
            target: its name.
            dwell_s: time over which the instrument averages.
            near_mm: roughly where it is, in the instrument's frame; None where nobody knows, or it is aimed at.
            face: in which.

        Raises:
            HiddenTargetError: the target is not seen there; it can be tried again.
            DeviceError: the instrument failed.
        """
        raise RefusedError(
            f"this tracker's driver measures no points: {target} at {near_mm} is not measured in face {face} over "
            f"{dwell_s:g} s",
            0,
        )

    async def pose(self, target: str, dwell_s: float) -> TargetPose:
        """Measure a frame that stands still; as `point` else."""
        raise RefusedError(
            f"this tracker's driver measures no poses: {target} is not measured over {dwell_s:g} s", 0
        )


class TrackerClass(DriverClass, Protocol):
    """A tracker's driver as it is registered.

    Attributes:
        abilities: what the driver is able to do.
    """

    abilities: ClassVar[TrackerAbilities]
