"""Descriptions of arms, `catseye-arm/1`: joints with their ranges, masses, bodies for collision checks."""

from importlib.resources import files
from typing import Annotated, Final, Literal, Self

from pydantic import Field, model_validator

from catseye.app.cell.described import Shipped
from catseye.app.cell.section import Finite, NotNegative, Positive, Section
from catseye.drivers.roles.pose import Range, Unit

Triple = Annotated[list[Finite], Field(min_length=3, max_length=3)]


class _Joint(Section):
    """[[joint]]: modified Denavit–Hartenberg, T = Rx(α) Tx(a) Rz(θ) Tz(d)."""

    name: str
    alpha_deg: Finite
    a_mm: Finite
    theta_offset_deg: Finite
    d_mm: Finite
    sign: Literal[1, -1]
    gear_ratio: Positive | None = None
    encoder_bits: Annotated[int, Field(ge=1, le=64)] | None = None


class RevoluteJoint(_Joint):
    """[[joint]] that turns."""

    type: Literal["revolute"]
    low_deg: Finite
    high_deg: Finite
    speed_deg_s: Positive
    acceleration_deg_s2: Positive | None = None
    # Where the joint's motion resolution is tested.
    test_places_deg: Annotated[list[Finite], Field(min_length=1)] | None = None

    @property
    def unit(self) -> Unit:
        """Of its values."""
        return "deg"

    @property
    def range(self) -> Range:
        """Lowest and highest angle, deg."""
        return self.low_deg, self.high_deg

    @property
    def speed(self) -> float:
        """Fastest, deg/s."""
        return self.speed_deg_s

    @property
    def acceleration(self) -> float | None:
        """Largest, deg/s²; None where nobody knows."""
        return self.acceleration_deg_s2


class PrismaticJoint(_Joint):
    """[[joint]] that slides."""

    type: Literal["prismatic"]
    low_mm: Finite
    high_mm: Finite
    speed_mm_s: Positive
    acceleration_mm_s2: Positive | None = None

    @property
    def unit(self) -> Unit:
        """Of its values."""
        return "mm"

    @property
    def range(self) -> Range:
        """Lowest and highest place, mm."""
        return self.low_mm, self.high_mm

    @property
    def speed(self) -> float:
        """Fastest, mm/s."""
        return self.speed_mm_s

    @property
    def acceleration(self) -> float | None:
        """Largest, mm/s²; None where nobody knows."""
        return self.acceleration_mm_s2


Joint = Annotated[RevoluteJoint | PrismaticJoint, Field(discriminator="type")]


class Link(Section):
    """[[link]]: what moves with a joint, in the frame of that joint; motors and gears are part of it."""

    joint: str | None = None
    mass_kg: NotNegative
    centre_mm: Triple
    confirmed: bool = False


class Body(Section):
    """[[body]]: a capsule in the frame of its joint, or of the base."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.+ -]{1,40}$")]
    joint: str
    from_mm: Triple
    to_mm: Triple
    radius_mm: Positive
    confirmed: bool = False


class ArmDescription(Section):
    """A whole description."""

    format: Literal["catseye-arm/1"]
    name: str
    convention: Literal["modified-dh"]
    joint: Annotated[list[Joint], Field(min_length=1)]
    link: list[Link] = Field(default_factory=list)
    body: list[Body] = Field(default_factory=list)

    @model_validator(mode="after")
    def _joints_are_known(self) -> Self:
        names = [joint.name for joint in self.joint]
        if len(set(names)) < len(names):
            raise ValueError(f"two [[joint]] have one name; they are called {', '.join(names)}")
        for joint in self.joint:
            low, high = joint.range
            if not low < high:
                raise ValueError(f"[[joint]] {joint.name}: its range {low:g}…{high:g} {joint.unit} is empty")
        for kind, parts in (("link", self.link), ("body", self.body)):
            for part in parts:
                if part.joint not in (None, "base", *names):
                    raise ValueError(f"[[{kind}]] joint = {part.joint!r} is none of base, {', '.join(names)}")
        return self

    @model_validator(mode="after")
    def _links_have_joints(self) -> Self:
        """Links without a joint's name are those of all joints, in their order."""
        nameless = sum(link.joint is None for link in self.link)
        if nameless and (nameless < len(self.link) or nameless != len(self.joint)):
            raise ValueError(
                f"[[link]]: {nameless} of {len(self.link)} say no joint: write joint = NAME into each, or one "
                f"[[link]] for each of the {len(self.joint)} joints, in their order"
            )
        return self


_SHIPPED: Final = Shipped(ArmDescription, "an arm", files("catseye.app.cell") / "arms")


def shipped_arms() -> list[str]:
    """Return the names of the arms that are described."""
    return _SHIPPED.names()


def shipped_arm(name: str) -> ArmDescription:
    """Return the description of a shipped arm.

    Raises:
        ValueError: there is no such arm.
    """
    return _SHIPPED.named(name)


def arm_description(arm: str | ArmDescription) -> ArmDescription:
    """Return the description of an arm.

    Args:
        arm: name of a shipped arm, or path of a file; a description is returned as it is.

    Raises:
        ConfigError: the file cannot be read or is no description; the fault is named with its key.
        ValueError: there is no such arm.
    """
    return _SHIPPED.of(arm)
