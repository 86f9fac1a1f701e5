"""Sections and keys of a cell file that only a SCARA and its open-loop tracking have."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Final, Literal, Self

from pydantic import (
    AfterValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    field_serializer,
    field_validator,
    model_validator,
)

from catseye.app.cell.arm import ArmDescription, arm_description
from catseye.app.cell.described import is_path
from catseye.app.cell.scara.uncertainty import Uncertainty
from catseye.app.cell.section import RECORD, Finite, Name, NotNegative, Positive, Range, Section
from catseye.app.errors import ConfigError
from catseye.procedures.scara.tool_zero import ToolZero

Triple = Annotated[list[Positive], Field(min_length=3, max_length=3)]


def _none_or_some(value: list[float]) -> list[float]:
    # A run stores the empty list of a cell without nodes, and is read again.
    if len(value) == 1:
        raise ValueError(
            "a joint needs at least 2 nodes; leave the key out where nothing is measured at nodes"
        )
    return value


Nodes = Annotated[list[Finite], AfterValidator(_none_or_some), Field(json_schema_extra={"minItems": 2})]


def _ordered(value: list[float]) -> list[float]:
    if not value[0] < value[1]:
        raise ValueError(f"the lower limit {value[0]:g} has to be below the upper limit {value[1]:g}")
    return value


Limit = Annotated[Range, AfterValidator(_ordered)]


TIMES: Final = ("speed_deg_s", "j3_speed_mm_s", "acceleration_deg_s2")
"""Keys of [robot] that serve estimates of time and say nothing about where anything stands."""


class Limits(Section):
    """[robot.limits_deg]: where the joints may go, cables included; any joint of the arm, in lower case."""

    model_config = ConfigDict(frozen=True, extra="allow", strict=True)
    __pydantic_extra__: dict[str, Limit]

    j1: Limit = Field(default=[-170.0, 170.0])
    j2: Limit = Field(default=[-145.0, 145.0])
    j4: Limit = Field(default=[-360.0, 360.0])


Order = Annotated[int, Field(ge=1, le=2000)]


class GearOrders(Section):
    """[robot.gear_orders]: known periods, in a turn of the joint, of what its gear does between the nodes."""

    j1: list[Order] = Field(default_factory=list)
    j2: list[Order] = Field(default_factory=list)


class ScaraRobot(Section):
    """Keys of [robot] about the arm: a SCARA's, and the ranges of any arm's axes."""

    arm: str | ArmDescription = "rh-3frh5515"
    link1_mm: Positive | None = None
    link2_mm: Positive | None = None
    j3_mm: Finite = 0.0
    j3_range_mm: Range | None = None
    # The sheet gives the speeds of J1, J2, J4 from memory of a catalogue: they serve estimates of time, and of the
    # way that a joint needs to stop as long as a jog by hand has not shown its speed.
    speed_deg_s: Triple = Field(default=[420.0, 720.0, 3000.0])
    j3_speed_mm_s: Positive = 1100.0
    acceleration_deg_s2: Triple = Field(default=[2000.0, 4000.0, 15000.0])
    # How path files count: their height at J3 = 0, and their orientation where J1, J2 and J4 are 0.
    z_zero_mm: Finite = 0.0
    c_zero_deg: Finite = 0.0
    limits_deg: Limits = Limits()
    gear_orders: GearOrders = GearOrders()

    @property
    def links_mm(self) -> tuple[float, float]:
        """Nominal lengths of both links.

        Raises:
            ValueError: the cell file does not state them.
        """
        if self.link1_mm is None or self.link2_mm is None:
            raise ValueError("link1_mm and link2_mm are not stated")
        return self.link1_mm, self.link2_mm

    @property
    def tool_zero(self) -> ToolZero:
        """How height and orientation of path files are counted; J3 and J4 turn as the arm's description says."""
        signs = {joint.name: joint.sign for joint in arm_description(self.arm).joint}
        return ToolZero(self.z_zero_mm, self.c_zero_deg, signs.get("J3", 1), signs.get("J4", 1))

    @property
    def nominal_a_mm(self) -> Mapping[str, float]:
        """Distances of the axes that replace those of the arm's description, by joint."""
        stated = {"J2": self.link1_mm, "J3": self.link2_mm}
        return {joint: length_mm for joint, length_mm in stated.items() if length_mm is not None}

    @field_serializer("limits_deg")
    def _of_every_joint(self, limits: Limits) -> dict[str, list[float]]:
        """Return the range of each joint that this arm turns, and of no other: what a run stores is read again."""
        stated = limits.model_dump(exclude_unset=True)
        turning = {
            joint.name.lower(): joint for joint in arm_description(self.arm).joint if joint.unit == "deg"
        }
        return {name: stated.get(name, list(joint.range)) for name, joint in turning.items()}

    @field_validator("arm")
    @classmethod
    def _described(cls, value: str | ArmDescription) -> str | ArmDescription:
        """Read a description of one's own at once: a run keeps it, whatever becomes of the file."""
        try:
            description = arm_description(value)
        except ConfigError as error:
            raise ValueError(str(error)) from error
        return description if isinstance(value, str) and is_path(value) else value

    @model_validator(mode="after")
    def _within_the_arm(self, info: ValidationInfo) -> Self:
        """A cell only narrows the ranges of its arm."""
        if info.context != RECORD:
            arm = arm_description(self.arm)
            for key, joint, (low, high) in self._asked():
                _require_within(arm, key, joint, low, high)
        return self

    @model_validator(mode="after")
    def _height_in_range(self) -> Self:
        if self.j3_range_mm is not None and not self.j3_range_mm[0] <= self.j3_mm <= self.j3_range_mm[1]:
            low, high = self.j3_range_mm
            raise ValueError(f"j3_mm = {self.j3_mm:g} is outside j3_range_mm = [{low:g}, {high:g}]")
        return self

    def _asked(self) -> list[tuple[str, str, Sequence[float]]]:
        """Return the ranges that are stated: key, joint, lowest and highest."""
        stated = self.limits_deg.model_dump(exclude_unset=True)
        asked: list[tuple[str, str, Sequence[float]]] = [
            (f"limits_deg.{name}", name.upper(), limits) for name, limits in stated.items()
        ]
        if "J3" in (joint.name for joint in arm_description(self.arm).joint if joint.unit == "mm"):
            asked.append(("j3_mm", "J3", [self.j3_mm, self.j3_mm]))
            asked += [] if self.j3_range_mm is None else [("j3_range_mm", "J3", self.j3_range_mm)]
        return asked


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
    # Not every counter reports a level; those that do not read 1 while the beam returns.
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


class Reflector(Section):
    """[[reflector]]: a cat's eye at its rough place."""

    name: Name
    x_mm: Finite
    y_mm: Finite
    facing_deg: Finite | None = None


class Measurement(Section):
    """[measurement]: nodes and timing."""

    theta1_deg: Nodes = Field(default_factory=list)
    theta2_deg: Nodes = Field(default_factory=list)
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


class Plausibility(Section):
    """[plausibility]: how far an identified arm may be from what was known of it before."""

    deviation_mdeg: Positive = 1000.0
    link_mm: Positive = 2.0
    place_mm: Positive = 100.0


@dataclass(frozen=True)
class ScaraSections:
    """What open-loop tracking takes from a cell file; everything that it needs is there."""

    robot: ScaraRobot
    optics: Optics
    alignment: Alignment
    reflectors: Sequence[Reflector]
    measurement: Measurement
    uncertainty: Uncertainty
    plausibility: Plausibility

    @property
    def missing(self) -> list[str]:
        """Sections and keys that the cell file does not have and open-loop tracking needs."""
        found = {
            "[robot] link1_mm": self.robot.link1_mm,
            "[robot] link2_mm": self.robot.link2_mm,
            "[[reflector]]": self.reflectors,
            "[measurement] theta1_deg": self.measurement.theta1_deg,
            "[measurement] theta2_deg": self.measurement.theta2_deg,
        }
        return [key for key, value in found.items() if not value]


def open_loop_keys() -> tuple[str, ...]:
    """Return the sections of a cell file, and the keys of [robot], that nothing but open-loop tracking reads."""
    of_any_arm = {"arm", "limits_deg"}
    of_robot = (f"robot.{name}" for name in ScaraRobot.model_fields if name not in of_any_arm)
    return (*of_robot, "optics", "alignment", "reflector", "measurement", "uncertainty", "plausibility")


def _require_within(arm: ArmDescription, key: str, joint: str, low: float, high: float) -> None:
    axis = next((one for one in arm.joint if one.name == joint), None)
    if axis is None or (key.startswith("limits_deg") and axis.unit != "deg"):
        names = ", ".join(one.name.lower() for one in arm.joint if one.unit == "deg")
        raise ValueError(f"{key}: the {arm.name} turns no joint {joint}; it turns {names}")
    least, most = axis.range
    if not least <= low <= high <= most:
        stated = f"{low:g}" if low == high else f"[{low:g}, {high:g}]"
        raise ValueError(
            f"{key} = {stated} goes beyond the range of {joint} of the {arm.name}, {least:g}…{most:g} {axis.unit}: "
            "a cell only narrows it"
        )
