"""Everything that describes one emulated bench. Plain data; the cell file is read elsewhere."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

from catseye.calibration.air import HE_NE_RELATIVE_U
from catseye.simulators.survey import Place, SurveyConfig

Joints = tuple[float, ...]
"""One value a joint of the arm: deg for a rotary joint, mm for a linear one."""

Range = tuple[float, float]
"""Lowest and highest permitted value."""


@dataclass(frozen=True)
class ReflectorPlace:
    """A cat's eye as the cell file knows it.

    Attributes:
        name: its name.
        x_mm: rough place in the robot's frame, mm.
        y_mm: rough place in the robot's frame, mm.
        facing_deg: world direction of the axis of its field; None: towards the first axis of the arm.
    """

    name: str
    x_mm: float
    y_mm: float
    facing_deg: float | None = None


STEEL_PER_K: Final = 11.7e-6
"""Thermal expansion of the links, 1/K."""


@dataclass(frozen=True)
class ErrorBudget:
    """What makes two measurements of one place differ. Zero switches a contribution off.

    The figures are those of the SCARA paper's Table 2 where it has them (repeatability, radial error
    motions, correction, environment); the laser is any helium-neon laser; the others are assumptions of this
    emulation.

    Attributes:
        repeatability_um: robot repeatability, standard deviation of x and of y at each arrival.
        radial_um: radial error motion of each rotary axis from the base outwards, rms of x and of y in the frame of
            the link that carries the axis.
        wavelength_um: accuracy of the wavelength, as an error at 0.7 m; acts as a scale.
        correction_um: accuracy of an instrument's own correction for the air, as an error at 0.7 m; acts as a scale.
        environment_um: rms of the slow drift of the reading with bench time.
        counter_noise_um: standard deviation of one reading.
        counter_resolution_um: step of the reading.
        air_temperature_k: accuracy of the air sensors' temperature, one draw a bench; so are the next two.
        air_pressure_hpa: of their pressure.
        air_humidity_percent: of their relative humidity.
        white_um: plain white noise of the length, one draw an arrival.
        thermal_k: warming of the links above their state at the start after hours of motion at full speed; less duty
            and speed heat less, see `catseye.simulators.world.warming`.
        thermal_time_s: time constant of that warming, and of cooling.
        vibration_um: amplitude of the arm's ringing after a motion of a millimetre or more.
        vibration_hz: its frequency.
        vibration_decay_s: its time constant.
    """

    repeatability_um: float = 10.0
    radial_um: tuple[float, ...] = (5.0, 5.0, 10.0)
    wavelength_um: float = 0.7e6 * HE_NE_RELATIVE_U
    correction_um: float = 0.19
    environment_um: float = 0.09
    counter_noise_um: float = 0.1
    counter_resolution_um: float = 0.01
    air_temperature_k: float = 0.1
    air_pressure_hpa: float = 0.15
    air_humidity_percent: float = 1.0
    white_um: float = 0.0
    thermal_k: float = 6.0
    thermal_time_s: float = 3600.0
    vibration_um: float = 20.0
    vibration_hz: float = 15.0
    vibration_decay_s: float = 0.08

    @classmethod
    def none(cls) -> "ErrorBudget":
        """Return a bench without any error but those of the arm's links, maps and play."""
        return cls(
            repeatability_um=0.0,
            radial_um=(0.0, 0.0, 0.0),
            wavelength_um=0.0,
            correction_um=0.0,
            environment_um=0.0,
            counter_noise_um=0.0,
            counter_resolution_um=0.0,
            air_temperature_k=0.0,
            air_pressure_hpa=0.0,
            air_humidity_percent=0.0,
            thermal_k=0.0,
            vibration_um=0.0,
        )


@dataclass(frozen=True)
class ArmDynamics:
    """How fast the arm moves; none of these figures is confirmed by a catalogue.

    Attributes:
        max_speed: largest speed of each joint at 100 % override, deg/s or mm/s (melfa sheet, section 5.1, marked
            unverified there).
        max_acceleration: of each joint, deg/s² or mm/s²; an assumption; the override does not lower it.
        reversal_travel_deg: smallest command travel over which a joint changes from one flank to the other.
        servo_delay_s: bench time from "servo on" until the drives hold.
    """

    max_speed: Joints = (420.0, 720.0, 1100.0, 3000.0)
    max_acceleration: Joints = (2000.0, 4000.0, 8000.0, 15000.0)
    reversal_travel_deg: float = 0.05
    servo_delay_s: float = 1.0


@dataclass(frozen=True)
class Scara:
    """A SCARA as its catalogue has it.

    Attributes:
        link1_mm: nominal length of link 1, mm.
        link2_mm: nominal length of link 2, mm.
        j4_backlash_mdeg: width of J4's play; an assumption within its repeatability of 4 mdeg.
    """

    link1_mm: float = 325.0
    link2_mm: float = 225.0
    j4_backlash_mdeg: float = 3.0


@dataclass(frozen=True)
class SerialJoint:
    """One joint of a serial arm: modified Denavit–Hartenberg, T = Rx(α) Tx(a) Rz(θ) Tz(d), θ = sign · q + offset.

    Attributes:
        name: as the arm's maker numbers it.
        prismatic: it slides; then q is added to d, in mm, and θ is the offset.
        alpha_deg: α, deg.
        a_mm: a, mm.
        theta_offset_deg: offset of θ, deg.
        d_mm: d, mm.
        beta_deg: tilt about y after the twist, T = Rx(α) Ry(β) Tx(a) …; drawings have none.
        sign: +1 or −1.
        low: smallest value, deg or mm.
        high: largest value, deg or mm.
        speed: largest speed at 100 % override, deg/s or mm/s.
        acceleration: deg/s² or mm/s²; an assumption where the description has none.
        gear_ratio: turns of the motor in one of the joint; None where nobody knows.
        encoder_bits: bits of one turn of the motor; None where nobody knows.
    """

    name: str
    prismatic: bool
    alpha_deg: float
    a_mm: float
    theta_offset_deg: float
    d_mm: float
    sign: int
    low: float
    high: float
    speed: float
    acceleration: float = 500.0
    gear_ratio: float | None = None
    encoder_bits: int | None = None
    beta_deg: float = 0.0


@dataclass(frozen=True)
class SerialLoad:
    """A mass that moves with a joint.

    Attributes:
        frame: number of the joint in whose frame the centre stands, from 1; 0 is the base.
        mass_kg: mass, kg.
        centre_mm: centre of gravity in that frame, mm.
    """

    frame: int
    mass_kg: float
    centre_mm: tuple[float, float, float]


@dataclass(frozen=True)
class SerialBody:
    """A capsule of the arm: what may stand between an instrument and a target.

    Attributes:
        frame: number of the joint in whose frame it stands, from 1; 0 is the base.
        from_mm: one end of its axis.
        to_mm: the other one.
        radius_mm: around it.
    """

    frame: int
    from_mm: Place
    to_mm: Place
    radius_mm: float


@dataclass(frozen=True)
class SerialArm:
    """A serial arm as its description has it: what its controller believes, and what the true one is drawn around.

    Attributes:
        name: of the arm.
        joints: from the base outwards.
        loads: masses of its links.
        bodies: what its links hide.
    """

    name: str
    joints: tuple[SerialJoint, ...]
    loads: tuple[SerialLoad, ...] = ()
    bodies: tuple[SerialBody, ...] = ()


@dataclass(frozen=True)
class Screws:
    """What the screws of the interferometer's mount do; clockwise is positive.

    Attributes:
        stage_mm_per_turn: how far a turn moves the beam to its left; negative: to its right.
        level_mrad_per_turn: how far a turn tilts the beam upwards; negative: downwards.
        level_lever_mm: distance of the tilt's pivot behind the last axis: a tilted beam is a little higher there.
        setting_turns: standard deviation with which a hand sets a turn.
        play_turns: what is lost when the sense of turning changes.
    """

    stage_mm_per_turn: float = 0.5
    level_mrad_per_turn: float = 2.0
    level_lever_mm: float = 40.0
    setting_turns: float = 0.02
    play_turns: float = 0.02

    def reversed(self) -> "Screws":
        """Return screws that act the other way round, as on a mount turned by half a turn."""
        return replace(
            self,
            stage_mm_per_turn=-self.stage_mm_per_turn,
            level_mrad_per_turn=-self.level_mrad_per_turn,
        )


@dataclass(frozen=True)
class AirState:
    """Mean state of the air and the amplitude of its slow drift.

    Attributes:
        temperature_c: mean temperature, °C.
        pressure_hpa: mean pressure, hPa.
        humidity_percent: mean relative humidity, %.
        drift_k: amplitude of the temperature's drift, K.
        drift_hpa: amplitude of the pressure's drift, hPa.
        drift_percent: amplitude of the humidity's drift, %.
    """

    temperature_c: float = 20.0
    pressure_hpa: float = 1013.25
    humidity_percent: float = 50.0
    drift_k: float = 0.1
    drift_hpa: float = 0.5
    drift_percent: float = 1.0


@dataclass(frozen=True)
class Remounting:
    """How well a hand repeats a mounting of the interferometer, standard deviations; assumptions of this emulation.

    Attributes:
        turn_deg: of the angle about the last axis.
        offset_mm: of the beam's lateral offset from that axis.
        pitch_mrad: of the beam's angle above the XY plane: a seat that is not square to the axis tilts it anew.
        height_mm: of its height.
        ahead_mm: of the place along the beam from which its length counts.
    """

    turn_deg: float = 1.0
    offset_mm: float = 0.5
    pitch_mrad: float = 0.8
    height_mm: float = 0.9
    ahead_mm: float = 0.5


@dataclass(frozen=True)
class AxisGaugeQuality:
    """A precision ball for the axes of joints, its indicators, and hands that handle them.

    All figures are assumptions of this emulation.

    Attributes:
        off_centre_um: standard deviation of the ball's place beside the axis in x and in y, as a hand mounts it.
        tap_share: standard deviation of what a hand taps the ball by, as a share of the way asked for.
        tap_um: the part of it that does not depend on the way.
        form_um: deviation of the ball from roundness, norm of the amplitudes of orders 2 to 6.
        gain: standard deviation of the indicators' gain about 1.
        noise_um: standard deviation of one reading.
        resolution_um: step of a reading; 0 for none.
        range_um: largest reading to either side.
        drift_um: rms of what the stand drifts by.
        drift_period_s: of that drift.
        asynchronous_um: standard deviation, in x and in y, of what the axis does otherwise at each arrival.
    """

    off_centre_um: float = 60.0
    tap_share: float = 0.1
    tap_um: float = 2.0
    form_um: float = 0.2
    gain: float = 0.003
    noise_um: float = 0.2
    resolution_um: float = 1.0
    range_um: float = 500.0
    drift_um: float = 0.5
    drift_period_s: float = 3600.0
    asynchronous_um: float = 0.4


@dataclass(frozen=True)
class ArmOptics:
    """An interferometer on a tripod beside a serial arm, and the retroreflectors that hands fasten to the arm.

    Where the resolution paper states no figure (sections 2.2, 3.2) it is an assumption of this emulation.

    Attributes:
        spacing_mm: nominal distance of the two prisms of the angular retroreflector.
        u_spacing_mm: standard deviation of the true distance.
        target_mm: place of the linear retroreflector in the frame of the flange.
        distance_mm: from interferometer to retroreflector when it is mounted: the dead path.
        angle_limit_deg: rotation of a well placed retroreflector at which the signal is lost.
        shift_limit_mm: shift of a retroreflector across the beam at which it is.
        tilt_limit_mrad: misalignment of the beam at which it is.
        hand_tilt_mrad: largest misalignment that a mounting leaves, of each of two directions.
        mrad_per_turn: what a turn of a screw of the stage tilts the beam by.
        tripod_urad: rms of the slow tilt of the tripods against each other.
        tripod_um: rms of their slow displacement.
        turbulence_nm: rms of what the air's turbulence adds to a length.
        noise_nm: standard deviation of one reading.
        resolution_nm: step of the reading.
    """

    spacing_mm: float = 30.0
    u_spacing_mm: float = 0.01
    target_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    distance_mm: float = 250.0
    angle_limit_deg: float = 10.0
    shift_limit_mm: float = 3.0
    tilt_limit_mrad: float = 4.0
    hand_tilt_mrad: float = 2.0
    mrad_per_turn: float = 1.0
    tripod_urad: float = 0.3
    tripod_um: float = 0.1
    turbulence_nm: float = 5.0
    noise_nm: float = 2.0
    resolution_nm: float = 1.0


Option = str | int | float | bool | list[dict[str, Any]]
"""Value of an option of an emulated device: a plain one, or a list of tables."""

_ANY_FREE = "tcp://127.0.0.1:0"


@dataclass(frozen=True)
class EmulatedDevice:
    """One endpoint of one device.

    Attributes:
        name: of the device; a device with several endpoints, like the robot, stands here several times.
        protocol: what it speaks, see `catseye.simulators.emulator.emulator_names`.
        endpoint: where it listens: `tcp://host:port` or `udp://host:port` (port 0 takes a free one), or
            `serial:///path?baud=…` (a pseudo-terminal under that path; /dev/ptmx takes a free one).
    """

    name: str
    protocol: str
    endpoint: str = _ANY_FREE
    options: Mapping[str, Option] = field(default_factory=dict)


CLASSIC_DEVICES = (
    EmulatedDevice("robot", "melfa-r3"),
    EmulatedDevice("interferometer", "line-counter"),
    EmulatedDevice("environment", "modbus-air"),
)
"""Controller, counter and air sensor on free TCP ports."""


@dataclass(frozen=True)
class TruthText:
    """Document of a true arm, as somebody read it.

    Attributes:
        raw: JSON in the result format.
        source: file that it comes from, for texts.
    """

    raw: bytes
    source: str


@dataclass(frozen=True)
class EmulationConfig:
    """One emulated bench with its servers.

    Attributes:
        reflectors: cat's eyes at their rough places; the true ones differ by some millimetres; a SCARA needs one.
        scara: the arm, unless there is a serial one.
        serial: a serial arm; a bench with one has no reflectors and none of what belongs to an open-loop tracker.
        start_joints: joints at bench time 0.
        beam_height_mm: height of the arm at which the beam, where it starts, lies in the plane of the reflectors;
            None: that at start_joints.
        acceptance_mm: largest beam miss from which a reflector returns the beam.
        field_half_angle_deg: half angle of the cat's eye's field.
        column_radius_mm: radius of the base column around the first axis.
        beam_offset_mm: lateral offset of the beam from the last axis, positive to the left of the beam; None: drawn.
        beam_pitch_mrad: angle of the beam above the XY plane; None: drawn.
        unaligned: offset, pitch and height are drawn as of a beam that nobody has aligned yet.
        screws: what moves the beam on its mount.
        remounting: how far another mounting of the interferometer is off.
        one_reflector: one cat's eye is carried from nest to nest; at the start it stands in the first one.
        nest_um: standard deviation of x and of y with which a cat's eye is put into its nest.
        speed_limit_mm_s: largest displacement rate that the counter follows.
        devices: endpoints of all devices.
        control: endpoint of the control port, `tcp://host:port`.
        speed: bench seconds in one real second.
        seed: seed of everything random.
        truth: document of the true arm; None draws one.
        budget: what makes measurements scatter.
        dynamics: how fast the arm moves.
        air: state of the air.
        axis_pattern: axes in position answers: 4 (native), 6 or 8 (what some clients demand).
        answer_suffix: what the controller appends to an answer: nothing, CR or CR LF.
        arm_optics: the interferometer beside a serial arm.
        survey: what else measures a serial arm.
        axis_gauge: ball and indicators for the axes of a SCARA.
    """

    reflectors: tuple[ReflectorPlace, ...] = ()
    scara: Scara = field(default_factory=Scara)
    serial: SerialArm | None = None
    limits: tuple[Range, ...] = ((-170.0, 170.0), (-145.0, 145.0), (0.0, 150.0), (-360.0, 360.0))
    start_joints: Joints = (0.0, 0.0, 0.0, 0.0)
    beam_height_mm: float | None = None
    acceptance_mm: float = 1.0
    field_half_angle_deg: float = 80.0
    column_radius_mm: float = 110.0
    beam_offset_mm: float | None = None
    beam_pitch_mrad: float | None = None
    unaligned: bool = False
    screws: Screws = field(default_factory=Screws)
    remounting: Remounting = field(default_factory=Remounting)
    one_reflector: bool = False
    nest_um: float = 2.0
    speed_limit_mm_s: float = 2000.0
    devices: tuple[EmulatedDevice, ...] = CLASSIC_DEVICES
    control: str = _ANY_FREE
    speed: float = 1.0
    seed: int = 0
    truth: TruthText | None = None
    budget: ErrorBudget = field(default_factory=ErrorBudget)
    dynamics: ArmDynamics = field(default_factory=ArmDynamics)
    air: AirState = field(default_factory=AirState)
    axis_pattern: int = 4
    answer_suffix: str = ""
    arm_optics: ArmOptics = field(default_factory=ArmOptics)
    survey: SurveyConfig = field(default_factory=SurveyConfig)
    axis_gauge: AxisGaugeQuality = field(default_factory=AxisGaugeQuality)

    def growing(self, ppm: float) -> "EmulationConfig":
        """Return the bench whose links grow by so much after hours of motion at full speed, whatever arm it has."""
        budget = replace(self.budget, thermal_k=1e-6 * ppm / STEEL_PER_K)
        return replace(self, budget=budget, survey=replace(self.survey, growth_ppm=ppm))
