"""What instruments tell, in the units of the house."""

from dataclasses import dataclass

from catseye.drivers.roles.text import DeviceText

Joints = tuple[float, float, float, float]
"""J1 deg, J2 deg, J3 mm, J4 deg."""


@dataclass(frozen=True)
class Identity(DeviceText):
    """Who answers behind an endpoint.

    Attributes:
        model: what the instrument calls itself.
        firmware: version text, empty when unknown.
        serial: serial number text, empty when unknown.
        simulated: True when the instrument says that it is an emulator.
    """

    model: str
    firmware: str
    serial: str
    simulated: bool


@dataclass(frozen=True)
class RobotStatus(DeviceText):
    """State of a robot controller.

    Attributes:
        servo_on: drives are powered.
        running: a motion or a program is under way.
        operation_enabled: this connection holds the right to move the robot.
        teach_mode: the key switch is at TEACH; motion commands are refused.
        emergency_stop: the emergency stop circuit is open.
        override_percent: speed override, read back.
        alarm_number: 0 when there is none.
        alarm_text: what the alarm means and what to do; empty when there is none.
        program: name of the program that is selected on the controller; empty when none is, or it is not told.
    """

    servo_on: bool
    running: bool
    operation_enabled: bool
    teach_mode: bool
    emergency_stop: bool
    override_percent: float
    alarm_number: int
    alarm_text: str
    program: str = ""


@dataclass(frozen=True)
class CounterReading(DeviceText):
    """One reading of a length counter.

    Attributes:
        displacement_mm: displacement since the last zero, growing with the beam's length.
        raw: the instrument's own text or number, as it came.
        time_s: arrival, on the driver's clock, s.
        zero_id: number of the zero that it counts from; 0 before the first one.
        device_time_s: the instrument's own time of the value, s; None when it tells none.
    """

    displacement_mm: float
    raw: str
    time_s: float
    zero_id: int = 0
    device_time_s: float | None = None


@dataclass(frozen=True)
class CounterStatus(DeviceText):
    """State of a length counter.

    Attributes:
        beam_ok: the beam returns now.
        beam_lost: latched since the last zero: the count is no longer valid even if the beam is back.
        overspeed: latched since the last zero.
        laser_ready: the laser is stable.
        signal: level of the returning beam, 0...1.
        signal_native: the level as the instrument tells it, with its unit; empty when it tells none.
        values_lost: latched since the last zero: values of a stream did not arrive. The count itself holds.
        zero_id: number of the last zero; 0 before the first one.
    """

    beam_ok: bool
    beam_lost: bool
    overspeed: bool
    laser_ready: bool
    signal: float
    signal_native: str = ""
    values_lost: bool = False
    zero_id: int = 0


@dataclass(frozen=True)
class AirSample:
    """State of the air. A quantity that the sensor does not give is None.

    Attributes:
        temperature_c: temperature, °C.
        pressure_hpa: pressure, hPa.
        humidity_percent: relative humidity, %.
        time_s: arrival, on the driver's clock, s.
    """

    temperature_c: float | None
    pressure_hpa: float | None
    humidity_percent: float | None
    time_s: float
