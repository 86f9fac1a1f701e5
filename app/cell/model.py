"""Shape of the cell file, version 1. The unit is part of every key; unknown keys are refused."""

from itertools import pairwise
from typing import Annotated, Any, Final, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from catseye.app.cell.arm import Body, shipped_arm
from catseye.app.cell.section import Finite, Name, NotNegative, Positive, Section
from catseye.app.cell.uncertainty import Uncertainty
from catseye.app.cell.workspace import Workspace
from catseye.drivers.links.endpoint import parse_endpoint

Triple = Annotated[list[Positive], Field(min_length=3, max_length=3)]
Range = Annotated[list[Finite], Field(min_length=2, max_length=2)]
Settings = dict[str, Any]
"""Settings of a driver, as that driver's own `Settings` model describes them; they are checked there."""


RECORD: Final = {"record": True}
"""Context for reading the cell of a stored run: nothing is driven with it, so what it may drive is not judged."""

CAP_WITHOUT_REASON_PERCENT: Final = 30.0
"""A higher speed override needs a reason in the file."""

RESERVED_NAMES = ("robot", "interferometer", "environment", "io", "tracker", "control")
"""Names of the devices that have sections of their own."""


def _checked_endpoint(text: str) -> str:
    # Port 0 asks an emulator for a free port; as a place to connect to it means nothing.
    parse_endpoint(
        text[:-2] + ":1" if text.startswith(("tcp://", "udp://")) and text.endswith(":0") else text
    )
    return text


def _checked_further(text: str | None) -> str | None:
    return None if text is None else _checked_endpoint(text)


class Limits(Section):
    """[robot.limits_deg]: where the joints may go, cables included."""

    j1: Range = Field(default=[-170.0, 170.0])
    j2: Range = Field(default=[-145.0, 145.0])
    j4: Range = Field(default=[-360.0, 360.0])

    @field_validator("j1", "j2", "j4")
    @classmethod
    def _ordered(cls, value: list[float]) -> list[float]:
        if not value[0] < value[1]:
            raise ValueError(f"the lower limit {value[0]:g} has to be below the upper limit {value[1]:g}")
        return value


class Robot(Section):
    """[robot]: controller and nominal arm; the driver chooses how the arm follows the reflector."""

    driver: str = "melfa-r3"
    endpoint: str
    datalink_endpoint: str | None = None
    mxt_endpoint: str | None = None
    settings: Settings = Field(default_factory=dict)
    arm: str = "rh-3frh5515"
    expected_model: str = "RH-3FRH5515"
    link1_mm: Positive
    link2_mm: Positive
    j3_mm: Finite = 0.0
    j3_range_mm: Range | None = None
    override_cap_percent: Annotated[float, Field(ge=1.0, le=100.0, allow_inf_nan=False)] = 20.0
    override_cap_reason: str = ""
    # The sheet gives the speeds of J1, J2, J4 from memory of a catalogue: they serve estimates of time, and of the
    # way that a joint needs to stop as long as a jog by hand has not shown its speed.
    speed_deg_s: Triple = Field(default=[420.0, 720.0, 3000.0])
    j3_speed_mm_s: Positive = 1100.0
    acceleration_deg_s2: Triple = Field(default=[2000.0, 4000.0, 15000.0])
    # Only where set points are streamed: the fastest joint on the way from node to node.
    follow_speed_deg_s: Positive = 20.0
    follow_acceleration_deg_s2: Positive = 200.0
    limits_deg: Limits = Limits()
    # After a run that a front end started; a headless one switches them off at its end.
    drives_off_after_s: Positive = 300.0

    _endpoint = field_validator("endpoint")(_checked_endpoint)
    _further = field_validator("datalink_endpoint", "mxt_endpoint")(_checked_further)

    @field_validator("arm")
    @classmethod
    def _described(cls, value: str) -> str:
        shipped_arm(value)
        return value

    @model_validator(mode="after")
    def _cap_has_a_reason(self, info: ValidationInfo) -> Self:
        cap = self.override_cap_percent
        if (
            info.context != RECORD
            and cap > CAP_WITHOUT_REASON_PERCENT
            and not self.override_cap_reason.strip()
        ):
            raise ValueError(
                f"override_cap_percent = {cap:g} is above {CAP_WITHOUT_REASON_PERCENT:g}: say why in "
                'override_cap_reason = "…", or lower it'
            )
        return self

    @model_validator(mode="after")
    def _within_the_arm(self, info: ValidationInfo) -> Self:
        """A cell only narrows the ranges of its arm."""
        if info.context == RECORD:
            return self
        arm, limits = shipped_arm(self.arm), self.limits_deg
        asked = [("limits_deg.j1", "J1", limits.j1), ("limits_deg.j2", "J2", limits.j2)]
        asked += [("limits_deg.j4", "J4", limits.j4), ("j3_mm", "J3", [self.j3_mm, self.j3_mm])]
        asked += [] if self.j3_range_mm is None else [("j3_range_mm", "J3", self.j3_range_mm)]
        for key, joint, (low, high) in asked:
            least, most = arm.range_of(joint)
            if not least <= low <= high <= most:
                told = f"{low:g}" if low == high else f"[{low:g}, {high:g}]"
                unit = "mm" if joint == "J3" else "deg"
                raise ValueError(
                    f"{key} = {told} goes beyond the range of {joint} of the {arm.name}, {least:g}…{most:g} {unit}: "
                    "a cell only narrows it"
                )
        return self

    @model_validator(mode="after")
    def _height_in_range(self) -> Self:
        if self.j3_range_mm is not None and not self.j3_range_mm[0] <= self.j3_mm <= self.j3_range_mm[1]:
            low, high = self.j3_range_mm
            raise ValueError(f"j3_mm = {self.j3_mm:g} is outside j3_range_mm = [{low:g}, {high:g}]")
        return self


class Interferometer(Section):
    """[interferometer]: the length counter."""

    driver: str = "line-counter"
    profile: str | None = None
    endpoint: str
    settings: Settings = Field(default_factory=dict)

    _endpoint = field_validator("endpoint")(_checked_endpoint)


class Environment(Section):
    """[environment]: the air sensor."""

    driver: str = "modbus-air"
    endpoint: str
    map: str | None = None
    pressure_register: Annotated[int, Field(ge=0, le=65535)] | None = None
    settings: Settings = Field(default_factory=dict)

    _endpoint = field_validator("endpoint")(_checked_endpoint)


class Air(Section):
    """[air]: how the program corrects lengths for the air where the interferometer does not."""

    formula: Literal["ciddor", "edlen"] = "ciddor"
    co2_ppm: Annotated[float, Field(ge=0.0, le=50_000.0, allow_inf_nan=False)] = 450.0
    vacuum_wavelength_nm: Annotated[float, Field(ge=200.0, le=3000.0, allow_inf_nan=False)] = 632.9908
    max_age_s: Positive = 2.0


class Io(Section):
    """[io]: door interlock and stack light on a block of remote inputs and outputs."""

    driver: str = "modbus-io"
    endpoint: str
    settings: Settings = Field(default_factory=dict)

    _endpoint = field_validator("endpoint")(_checked_endpoint)


class Material(Section):
    """[material]: temperature and expansion of the links; the result then tells them at 20 °C too."""

    sensor: Name
    cte_per_k: Annotated[float, Field(ge=-1e-4, le=1e-4, allow_inf_nan=False)]
    u_cte_per_k: Annotated[float, Field(ge=0.0, le=1e-4, allow_inf_nan=False)] = 1e-6
    u_temperature_k: NotNegative = 0.2


class FurtherDevice(Section):
    """[[device]]: an instrument beyond the three that a measurement needs; doctor, terminal and emulate know it."""

    name: Name
    driver: str
    endpoint: str
    settings: Settings = Field(default_factory=dict)

    _endpoint = field_validator("endpoint")(_checked_endpoint)


class Tracker(Section):
    """[tracker]: an independent instrument for validation paths; so far the one of the emulated bench."""

    driver: str = "bench-tracker"
    endpoint: str

    _endpoint = field_validator("endpoint")(_checked_endpoint)


class Optics(Section):
    """[optics]: the beam and what stands in its way."""

    acceptance_mm: Positive = 1.0
    max_miss_mm: Positive = 0.2
    field_half_angle_deg: Annotated[float, Field(gt=0.0, le=90.0, allow_inf_nan=False)] = 80.0
    column_radius_mm: NotNegative = 110.0
    column_margin_mm: NotNegative = 5.0
    beam_min_mm: Positive = 50.0
    beam_max_mm: Positive = 5000.0
    theta40_deg: Finite = 0.0
    # Not every counter tells a level; those that do not read 1 while the beam returns.
    signal_min: Annotated[float, Field(ge=0.0, lt=1.0, allow_inf_nan=False)] = 0.0
    one_reflector: bool = False

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.max_miss_mm >= self.acceptance_mm:
            raise ValueError(
                f"max_miss_mm = {self.max_miss_mm:g} has to be below acceptance_mm = {self.acceptance_mm:g}: "
                "the aim itself is not perfect"
            )
        if self.beam_min_mm >= self.beam_max_mm:
            raise ValueError("beam_min_mm has to be below beam_max_mm")
        return self


class Alignment(Section):
    """[alignment]: the screws that move the beam, and how well it has to be aligned."""

    stage_mm_per_turn: Positive = 0.5
    stage_clockwise: Literal["+y", "-y"] = "+y"
    offset_tolerance_mm: Positive = 0.1
    level_mrad_per_turn: Positive = 2.0
    level_clockwise: Literal["up", "down"] = "up"
    level_tolerance_mrad: Positive = 0.2


class Conditions(Section):
    """[conditions]: the air in which a measurement goes on; outside of it the run is suspended."""

    temperature_c: Range | None = None
    pressure_hpa: Range | None = None
    humidity_percent: Range | None = None

    @field_validator("temperature_c", "pressure_hpa", "humidity_percent")
    @classmethod
    def _ordered(cls, value: list[float] | None) -> list[float] | None:
        if value is not None and not value[0] < value[1]:
            raise ValueError(f"the lower limit {value[0]:g} has to be below the upper limit {value[1]:g}")
        return value


class Engine(Section):
    """[engine]: what becomes of a run whose front end dies."""

    on_client_lost: Literal["continue", "hold", "stop"] = "hold"


class Reflector(Section):
    """[[reflector]]: a cat's eye at its rough place."""

    name: Name
    x_mm: Finite
    y_mm: Finite
    facing_deg: Finite | None = None


class Measurement(Section):
    """[measurement]: nodes and timing."""

    theta1_deg: Annotated[list[Finite], Field(min_length=2)]
    theta2_deg: Annotated[list[Finite], Field(min_length=2)]
    settle_time_s: NotNegative = 0.5
    dwell_time_s: NotNegative = 0.5
    readings: Annotated[int, Field(ge=1, le=10000)] = 10
    take_up_deg: Positive = 1.0
    spread_limit_um: Positive = 5.0

    @field_validator("theta1_deg", "theta2_deg")
    @classmethod
    def _increasing(cls, value: list[float]) -> list[float]:
        for low, high in pairwise(value):
            if not low < high:
                raise ValueError(f"nodes have to increase strictly; {high:g} follows {low:g}")
        return value


class Cell(Section):
    """A whole cell file."""

    format: Literal["catseye-cell/1"]
    name: Name
    robot: Robot
    interferometer: Interferometer
    environment: Environment
    air: Air = Air()
    io: Io | None = None
    material: Material | None = None
    tracker: Tracker | None = None
    device: list[FurtherDevice] = Field(default_factory=list)
    optics: Optics = Optics()
    alignment: Alignment = Alignment()
    conditions: Conditions = Conditions()
    engine: Engine = Engine()
    reflector: Annotated[list[Reflector], Field(min_length=1)]
    measurement: Measurement
    uncertainty: Uncertainty = Uncertainty()
    workspace: Workspace = Workspace()
    body: list[Body] = Field(default_factory=list)

    @model_validator(mode="after")
    def _bodies_of_the_arm(self) -> Self:
        arm = shipped_arm(self.robot.arm)
        joints = ["base", *(joint.name for joint in arm.joint)]
        own = {body.name: body.joint for body in arm.body}
        names = [body.name for body in self.body]
        for body in self.body:
            if body.joint not in joints:
                raise ValueError(
                    f"[[body]] {body.name}: joint = {body.joint!r} is none of {', '.join(joints)}"
                )
            if body.joint != own.get(body.name, body.joint):
                raise ValueError(
                    f"[[body]] {body.name}: joint = {body.joint!r}, and the arm's own body of that name, which it "
                    f"replaces, rides on {own[body.name]}: give this one another name, or that joint"
                )
            if names.count(body.name) > 1:
                raise ValueError(f"two [[body]] are called {body.name}; give each a name of its own")
        return self

    @model_validator(mode="after")
    def _material_sensor(self) -> Self:
        names = [device.name for device in self.device]
        if self.material is not None and self.material.sensor not in names:
            raise ValueError(
                f"[material] sensor = {self.material.sensor!r} is no [[device]]: add one whose temperature is "
                f"that of the links; there are {', '.join(names) or 'none'}"
            )
        return self

    @model_validator(mode="after")
    def _unique_reflectors(self) -> Self:
        names = [reflector.name for reflector in self.reflector]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"two reflectors are called {name}; give each a name of its own")
        return self

    @model_validator(mode="after")
    def _unique_devices(self) -> Self:
        names = [*RESERVED_NAMES, *(device.name for device in self.device)]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"[[device]] name = {name!r} is taken; give each device a name of its own")
        return self
