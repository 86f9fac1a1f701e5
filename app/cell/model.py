"""Shape of the cell file, version 1. The unit is part of every key; unknown keys are refused."""

from typing import Annotated, Any, Final, Literal, Self

from pydantic import Field, StringConstraints, ValidationInfo, field_validator, model_validator

from catseye.app.cell.arm import Body, arm_description
from catseye.app.cell.endpoints import checked_endpoint
from catseye.app.cell.scara.sections import (
    Alignment,
    Measurement,
    Optics,
    Plausibility,
    Reflector,
    ScaraRobot,
)
from catseye.app.cell.scara.uncertainty import Uncertainty
from catseye.app.cell.section import RECORD, Name, NotNegative, Positive, Range, Section, require_own_names
from catseye.app.cell.tool import ToolDescription, tool_description
from catseye.app.cell.tracker import Ballbar, Tracker
from catseye.app.cell.workspace import Workspace
from catseye.app.errors import ConfigError
from catseye.calibration.air import HE_NE_VACUUM_NM, Formula
from catseye.drivers.roles.device import Role

Settings = dict[str, Any]
"""Settings of a driver, as that driver's own `Settings` model describes them; they are checked there."""


CAP_WITHOUT_REASON_PERCENT: Final = 30.0
"""A higher speed override needs a reason in the file."""

RESERVED_NAMES = ("robot", "interferometer", "environment", "io", "tracker", "control")
"""Names of the devices that have sections of their own."""


def _checked_further(text: str | None) -> str | None:
    return None if text is None else checked_endpoint(text)


_DEFAULT_ARM: Final = ScaraRobot.model_fields["arm"].default


class Robot(ScaraRobot):
    """[robot]: controller and nominal arm; the driver chooses how the arm follows a path."""

    driver: str = "melfa-r3"
    endpoint: str
    datalink_endpoint: str | None = None
    mxt_endpoint: str | None = None
    settings: Settings = Field(default_factory=dict)
    # Description of what the flange carries, by its path: a run keeps it, whatever becomes of the file.
    tool: str | ToolDescription | None = None
    expected_model: str = "RH-3FRH5515"
    override_cap_percent: Annotated[float, Field(ge=1.0, le=100.0, allow_inf_nan=False)] = 20.0
    override_cap_reason: str = ""
    # Only where set points are streamed: the fastest joint on the way from node to node.
    follow_speed_deg_s: Positive = 20.0
    follow_acceleration_deg_s2: Positive = 200.0
    # After a run that a front end started; a headless one switches them off at its end.
    drives_off_after_s: Positive = 300.0

    @property
    def further_endpoints(self) -> dict[str, str]:
        """Endpoints of connections for paths, by their keys."""
        given = {"datalink_endpoint": self.datalink_endpoint, "mxt_endpoint": self.mxt_endpoint}
        return {key: endpoint for key, endpoint in given.items() if endpoint is not None}

    @property
    def carried(self) -> ToolDescription | None:
        """Description of what the flange carries; None where the cell file names none."""
        return None if self.tool is None else tool_description(self.tool)

    @field_validator("tool")
    @classmethod
    def _read(cls, value: str | ToolDescription | None) -> str | ToolDescription | None:
        try:
            return None if value is None else tool_description(value)
        except ConfigError as error:
            raise ValueError(str(error)) from error

    @model_validator(mode="before")
    @classmethod
    def _model_of_another_arm(cls, data: Any) -> Any:
        """How a controller calls itself is known of the default's arm only; of others any name will do."""
        if isinstance(data, dict) and data.get("arm", _DEFAULT_ARM) != _DEFAULT_ARM:
            return {"expected_model": "", **data}
        return data

    _endpoint = field_validator("endpoint")(checked_endpoint)
    _further = field_validator("datalink_endpoint", "mxt_endpoint")(_checked_further)

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


class Interferometer(Section):
    """[interferometer]: the length counter."""

    driver: str = "line-counter"
    profile: str | None = None
    endpoint: str
    settings: Settings = Field(default_factory=dict)

    _endpoint = field_validator("endpoint")(checked_endpoint)


class Environment(Section):
    """[environment]: the air sensor."""

    driver: str = "modbus-air"
    endpoint: str
    map: str | None = None
    pressure_register: Annotated[int, Field(ge=0, le=65535)] | None = None
    settings: Settings = Field(default_factory=dict)

    _endpoint = field_validator("endpoint")(checked_endpoint)


class Air(Section):
    """[air]: how the program corrects lengths for the air where the interferometer does not."""

    formula: Formula = "ciddor"
    co2_ppm: Annotated[float, Field(ge=0.0, le=50_000.0, allow_inf_nan=False)] = 450.0
    vacuum_wavelength_nm: Annotated[float, Field(ge=200.0, le=3000.0, allow_inf_nan=False)] = HE_NE_VACUUM_NM
    max_age_s: Positive = 2.0  # of a sample of the air, s of the clock


class Io(Section):
    """[io]: door interlock and stack light on a block of remote inputs and outputs."""

    driver: str = "modbus-io"
    endpoint: str
    settings: Settings = Field(default_factory=dict)

    _endpoint = field_validator("endpoint")(checked_endpoint)


class Material(Section):
    """[material]: temperature and expansion of the links; the result then gives them at 20 °C too."""

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

    _endpoint = field_validator("endpoint")(checked_endpoint)


class AngularOptics(Section):
    """[angular_optics]: angular interferometer and retroreflector, for the motion resolution of joints."""

    # Distance of the retroreflector's two prisms: the baseline of the angle.
    spacing_mm: Positive
    u_spacing_mm: NotNegative = 0.01
    distance_mm: Positive = 250.0
    signal_min: Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)] = 0.5


class LinearOptics(Section):
    """[linear_optics]: linear interferometer and retroreflector, for the Cartesian resolution."""

    distance_mm: Positive = 250.0
    signal_min: Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)] = 0.5


class Conditions(Section):
    """[conditions]: the air in which a measurement goes on; outside of it the run is suspended."""

    temperature_c: Range | None = None
    pressure_hpa: Range | None = None
    humidity_percent: Range | None = None

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest value by the name of the quantity in an air sample."""
        return {name: (low, high) for name, (low, high) in self.model_dump(exclude_none=True).items()}

    @field_validator("temperature_c", "pressure_hpa", "humidity_percent")
    @classmethod
    def _ordered(cls, value: list[float] | None) -> list[float] | None:
        if value is not None and not value[0] < value[1]:
            raise ValueError(f"the lower limit {value[0]:g} has to be below the upper limit {value[1]:g}")
        return value


class Engine(Section):
    """[engine]: what becomes of a run whose front end dies, or that nobody lets go on."""

    on_client_lost: Literal["continue", "hold", "stop"] = "hold"
    # Whoever reads what a run says; without it go-on where that is a pipe or a file, hold at a terminal.
    on_output_lost: Literal["go-on", "hold", "stop"] | None = None
    hold_limit_s: Positive = 900.0


class StoredRuns(Section):
    """[runs]: how runs are stored.

    Attributes:
        mode: rights of folders of runs, octal as chmod takes them; files have them without x. Empty for what the
            umask gives.
    """

    mode: Annotated[str, StringConstraints(pattern=r"^([0-7]{3,4})?$")] = ""

    @property
    def umask(self) -> int | None:
        """The umask that gives these rights; None to leave it as it is."""
        return 0o777 & ~int(self.mode, 8) if self.mode else None


class Cell(Section):
    """A whole cell file; whoever needs a section that not every bench has asks for it."""

    format: Literal["catseye-cell/1"]
    name: Name
    robot: Robot
    interferometer: Interferometer | None = None
    environment: Environment | None = None
    air: Air = Air()
    io: Io | None = None
    material: Material | None = None
    tracker: Tracker | None = None
    ballbar: Ballbar | None = None
    angular_optics: AngularOptics | None = None
    linear_optics: LinearOptics | None = None
    device: list[FurtherDevice] = Field(default_factory=list)
    optics: Optics = Optics()
    alignment: Alignment = Alignment()
    conditions: Conditions = Conditions()
    engine: Engine = Engine()
    runs: StoredRuns = StoredRuns()
    reflector: list[Reflector] = Field(default_factory=list)
    measurement: Measurement = Measurement()
    uncertainty: Uncertainty = Uncertainty()
    plausibility: Plausibility = Plausibility()
    workspace: Workspace = Workspace()
    body: list[Body] = Field(default_factory=list)

    @property
    def instruments(self) -> dict[Role, Robot | Interferometer | Environment | Io | Tracker]:
        """The sections of devices by their roles, as far as the file has them."""
        sections: dict[Role, Robot | Interferometer | Environment | Io | Tracker | None] = {
            "robot": self.robot,
            "interferometer": self.interferometer,
            "environment": self.environment,
            "io": self.io,
            "tracker": self.tracker,
        }
        return {role: section for role, section in sections.items() if section is not None}

    @model_validator(mode="after")
    def _sensor_of_the_conditions(self) -> Self:
        if self.environment is None and self.conditions != Conditions():
            raise ValueError(
                "[conditions] are those of the air: add the sensor, [environment], or leave them out"
            )
        return self

    @model_validator(mode="after")
    def _bodies_of_the_arm(self) -> Self:
        arm = arm_description(self.robot.arm)
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
                f"[material] sensor = {self.material.sensor!r} is not a [[device]]: add one whose temperature is "
                f"that of the links; there are {', '.join(names) or 'none'}"
            )
        return self

    @model_validator(mode="after")
    def _unique_reflectors(self) -> Self:
        require_own_names("reflectors", [reflector.name for reflector in self.reflector])
        return self

    @model_validator(mode="after")
    def _unique_devices(self) -> Self:
        names = [*RESERVED_NAMES, *(device.name for device in self.device)]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"[[device]] name = {name!r} is taken; give each device a name of its own")
        return self
