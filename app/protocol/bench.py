"""The bench as a client that watches sees it."""

from typing import Literal

from pydantic import Field

from catseye.app.protocol.message import Message, absent
from catseye.app.protocol.posture import Posture
from catseye.app.protocol.scara.layout import Layout

LinkState = Literal["connecting", "ok", "lost", "closed", "raw"]


class Identity(Message):
    """Who answers behind an endpoint."""

    model: str
    firmware: str
    serial: str
    simulated: bool


class DeviceStatus(Message):
    """A device of the cell file and how its link fares.

    Attributes:
        name: in the cell file.
        endpoint: where it is.
        driver: that talks to it.
        moves_arm: bytes that are sent to it may move an arm; its driver declares that.
        link: "raw" is taken from its driver by hand.
        identity: who answered last; None before anybody did.
        error: why the link was lost, until the device answers.
        age_s: of the last answer when this was sent, s.
    """

    name: str
    endpoint: str
    driver: str
    moves_arm: bool = False
    link: LinkState
    identity: Identity | None
    error: str | None
    age_s: float | None


class AxisName(Message):
    """An axis of the arm: its name, and the unit of its values."""

    name: str
    unit: Literal["deg", "mm"]

    def text(self, value: float) -> str:
        """Return a value with name and unit: A1 10.00°, or 12.5 mm."""
        return f"{self.name} {value:z.2f}°" if self.unit == "deg" else f"{self.name} {value:z.1f} mm"


class AxisRange(AxisName):
    """An axis with the range within which it is driven, in its unit.

    Attributes:
        low: smallest value.
        high: largest value.
        speed: fastest at 100 % override, in its unit per s; None from programs that did not send it.
    """

    low: float
    high: float
    speed: float | None = Field(default=None, exclude_if=absent)


class RobotStatus(Message):
    """The controller.

    Attributes:
        joints: in the order of the axes; None where they are not known.
        servo_on: the drives are on.
        override_percent: now; None for what is no number.
        override_cap_percent: of the cell.
        alarm_number: 0 for none.
        alarm_text: with its remedy.
        emergency_stop: it is pressed.
        teach_mode: the key stands on TEACH.
        machine_locked: the controller carries out motions without the arm.
        moving: the arm moves.
        jogs: a joint may be kept moving while a key is held; without that the arm is moved by hand in steps only.
        resets_alarms: the program can reset an alarm; otherwise it is confirmed at the pendant.
        torques_nm: of the motors; None where they are not known, or were read long ago.
        age_s: of the oldest part but the torques, s.
    """

    joints: tuple[float | None, ...] | None
    servo_on: bool
    override_percent: float | None
    override_cap_percent: float
    alarm_number: int
    alarm_text: str
    emergency_stop: bool
    teach_mode: bool
    machine_locked: bool = Field(default=False, exclude_if=lambda locked: not locked)
    moving: bool
    jogs: bool
    resets_alarms: bool = Field(default=False, exclude_if=lambda resets: not resets)
    torques_nm: tuple[float | None, ...] | None = Field(default=None, exclude_if=absent)
    age_s: float

    @property
    def known_joints(self) -> tuple[float, ...] | None:
        """The joints where every one is known, in the order of the axes."""
        if self.joints is None:
            return None
        known = tuple(value for value in self.joints if value is not None)
        return known if len(known) == len(self.joints) else None


class BeamStatus(Message):
    """The interferometer.

    Attributes:
        signal: level of the returning beam, 0…1.
        signal_native: the same as the instrument says it.
        beam_ok: it returns.
        beam_lost: it was lost since the zero.
        overspeed: the length changed faster than the counter counts.
        laser_ready: the laser is locked.
        displacement_mm: since the last zero.
        mean_mm: of the last second.
        spread_um: standard deviation of the last second.
        age_s: of the oldest part, s.
    """

    signal: float | None
    signal_native: str
    beam_ok: bool
    beam_lost: bool
    overspeed: bool
    laser_ready: bool
    displacement_mm: float | None
    mean_mm: float | None
    spread_um: float | None
    age_s: float


class OpticsStatus(Message):
    """Optics that the cell file has beside the arm; which of them stand there, nobody knows between runs.

    Attributes:
        spacing_mm: of the retroreflector's two prisms; None without angular optics.
        linear: there are linear optics.
    """

    spacing_mm: float | None
    linear: bool


class InstrumentStatus(Message):
    """A laser tracker or an optical CMM beside a serial arm, as the cell file has it.

    Attributes:
        measures: points, poses, or both.
        nests: names of the fixed ones, which make the world frame.
        targets: names of those on the tool.
        base_mm: place of the arm's base in the instrument's frame, roughly.
        base_deg: its rotation there, R = Rz · Ry · Rx.
    """

    measures: tuple[str, ...]
    nests: tuple[str, ...]
    targets: tuple[str, ...]
    base_mm: tuple[float, float, float]
    base_deg: tuple[float, float, float]


class AirStatus(Message):
    """The air, and the refractive index that follows from it by a formula."""

    temperature_c: float | None
    pressure_hpa: float | None
    humidity_percent: float | None
    refractive_index: float | None
    formula: str
    age_s: float


class BenchStatus(Message):
    """The bench. What nobody knows yet is None.

    Attributes:
        cell: name of the cell.
        simulated: all devices that are known are emulated; None when none is known.
        disk_free_bytes: of the disk that runs are stored on.
        devices: all of the cell file, in its order.
        robot: the controller.
        beam: the interferometer.
        air: the air.
        door_closed: as the interlock says.
        layout: a SCARA's bench from above; None of any other.
        posture: how the arm stands; None where the layout shows it, or while its joints are not known.
        optics: beside the arm; None where the arm carries the interferometer.
        instrument: that measures targets of a serial arm; None without one.
        axes: of the arm, from the base outwards.
        missed: messages of this kind that this one replaced for a slow client.
    """

    cell: str
    simulated: bool | None
    disk_free_bytes: int | None
    devices: tuple[DeviceStatus, ...]
    robot: RobotStatus | None
    beam: BeamStatus | None
    air: AirStatus | None
    door_closed: bool | None
    layout: Layout | None
    posture: Posture | None = None
    optics: OpticsStatus | None = Field(default=None, exclude_if=absent)
    instrument: InstrumentStatus | None = Field(default=None, exclude_if=absent)
    axes: tuple[AxisRange, ...] = ()
    missed: int = 0

    @property
    def is_without_beam(self) -> bool:
        """The cell has an instrument that measures targets, and no interferometer."""
        return self.instrument is not None and self.device("interferometer") is None

    def device(self, name: str) -> DeviceStatus | None:
        """Return a device by its name; None where there is none."""
        return next((device for device in self.devices if device.name == name), None)


class Samples(Message):
    """Samples folded into columns of equal duration, oldest first; None where a column has no sample.

    Attributes:
        quantity: what was sampled.
        period_s: duration of a column.
        low: smallest sample of each column.
        high: largest sample of each column.
        count: samples of each column.
        missed: older columns that are left out.
    """

    quantity: str
    period_s: float
    low: tuple[float | None, ...]
    high: tuple[float | None, ...]
    count: tuple[int, ...]
    missed: int


class WireLine(Message):
    """What passed a link at once.

    Attributes:
        t: ISO 8601 UTC time.
        device: its name in the cell file.
        dir: "tx" is sent, "rx" is received; "heal" is why the link is healed, as text.
        hex: the bytes, the first 256 of them.
        bytes: how many they were, where they are more than those.
    """

    t: str
    device: str
    dir: Literal["tx", "rx", "heal"]
    hex: str
    bytes: int | None = Field(default=None, exclude_if=absent)
