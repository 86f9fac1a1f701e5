"""The latest value of every quantity of a bench, with the time at which it came."""

import math
from dataclasses import dataclass
from typing import Generic, TypeVar

from catseye.app.protocol.bench import LinkState
from catseye.app.service.watching.columns import Columns
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotStatus

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


@dataclass(frozen=True)
class Stamped(Generic[T_co]):
    """A value and when it came.

    Attributes:
        value: as it was reported.
        time_s: on the clock of the latest, s.
    """

    value: T_co
    time_s: float


@dataclass
class LinkValues:
    """What is known of one device's link.

    Attributes:
        state: "raw" is taken from its driver by hand.
        identity: who answered last.
        error: why the link was lost; None once the device answers.
        heard_s: when the device answered last.
    """

    state: LinkState = "closed"
    identity: Identity | None = None
    error: str | None = None
    heard_s: float | None = None


class LatestValues:
    """Keeps what devices report, whoever asked them.

    Args:
        clock: real time.

    Attributes:
        links: by name of the device in the cell file.
        status: of the controller.
        joints: as reported.
        torques_nm: of the motors.
        beam: state of the beam.
        displacement_mm: of the beam, since the last zero.
        air: state of the air.
        door_closed: as the interlock says.
        columns: the beam's displacement over time, mm.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.clear()

    def clear(self) -> None:
        """Forget everything: another cell is looked at."""
        self.links: dict[str, LinkValues] = {}
        self.status: Stamped[RobotStatus] | None = None
        self.joints: Stamped[Pose] | None = None
        self.torques_nm: Stamped[tuple[float, ...]] | None = None
        self.beam: Stamped[BeamStatus] | None = None
        self.displacement_mm: Stamped[float] | None = None
        self.air: Stamped[AirSample] | None = None
        self.door_closed: Stamped[bool] | None = None
        self.columns = Columns()

    def link(self, device: str) -> LinkValues:
        """Return what is known of a device's link."""
        return self.links.setdefault(device, LinkValues())

    def wanted(self, device: str) -> None:
        """A device will be connected; how it was lost before is forgotten."""
        self.links[device] = LinkValues("connecting", self.link(device).identity)

    def connecting(self, device: str) -> None:
        """A device is being connected."""
        self.link(device).state = "connecting"

    def connected(self, device: str, identity: Identity) -> None:
        """A device answers and says who it is."""
        self.links[device] = LinkValues("ok", identity, None, self._clock.monotonic_s())

    def answered(self, device: str) -> None:
        """A device has answered, be it with a refusal."""
        gauge = self.link(device)
        gauge.state, gauge.error, gauge.heard_s = "ok", None, self._clock.monotonic_s()

    def lost(self, device: str, why: str) -> None:
        """A device does not answer, or not what it should."""
        gauge = self.link(device)
        gauge.state, gauge.error = "lost", why

    def closed(self, device: str) -> None:
        """A link was let go; one that is lost stays so, with its reason."""
        gauge = self.link(device)
        if gauge.state != "lost":
            gauge.state = "closed"

    def taken(self, device: str) -> None:
        """A link was taken from its driver by hand."""
        self.links[device] = LinkValues("raw", self.link(device).identity)

    def take_status(self, status: RobotStatus) -> None:
        """Take the controller's state."""
        self.status = self._now(status)

    def take_joints(self, joints: Pose) -> None:
        """Take the reported joints."""
        self.joints = self._now(joints)

    def take_torques(self, torques_nm: tuple[float, ...]) -> None:
        """Take the torques of the motors, N m."""
        self.torques_nm = self._now(torques_nm)

    def take_beam(self, beam: BeamStatus) -> None:
        """Take the state of the beam."""
        self.beam = self._now(beam)

    def take_displacement(self, displacement_mm: float) -> None:
        """Take a length of the beam, mm since its zero; what is no number is no length."""
        if not math.isfinite(displacement_mm):
            return
        self.displacement_mm = stamped = self._now(displacement_mm)
        self.columns.add(displacement_mm, stamped.time_s)

    def take_air(self, air: AirSample) -> None:
        """Take the state of the air."""
        self.air = self._now(air)

    def take_door(self, closed: bool) -> None:
        """Take the state of the door."""
        self.door_closed = self._now(closed)

    def age_s(self, time_s: float) -> float:
        """Return how long ago a time was, s."""
        return self._clock.monotonic_s() - time_s

    def _now(self, value: T) -> Stamped[T]:
        return Stamped(value, self._clock.monotonic_s())
