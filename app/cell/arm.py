"""Descriptions of arms, `catseye-arm/1`: joints with their ranges, and bodies for the collision check."""

import tomllib
from functools import lru_cache
from importlib.resources import files
from typing import Annotated, Literal

from pydantic import Field

from catseye.app.cell.section import Finite, Positive, Section
from catseye.drivers.roles.pose import Range, Unit

_SHIPPED = files("catseye.app.cell") / "arms"

Triple = Annotated[list[Finite], Field(min_length=3, max_length=3)]


class _Joint(Section):
    """[[joint]]: modified Denavit–Hartenberg, T = Rx(α) Tx(a) Rz(θ) Tz(d)."""

    name: str
    alpha_deg: Finite
    a_mm: Finite
    theta_offset_deg: Finite
    d_mm: Finite
    sign: Literal[1, -1]


class RevoluteJoint(_Joint):
    """[[joint]] that turns."""

    type: Literal["revolute"]
    low_deg: Finite
    high_deg: Finite
    speed_deg_s: Positive
    acceleration_deg_s2: Positive | None = None

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
    body: list[Body] = Field(default_factory=list)


def shipped_arms() -> list[str]:
    """Return the names of the arms that are described."""
    return sorted(
        entry.name.removesuffix(".toml") for entry in _SHIPPED.iterdir() if entry.name.endswith(".toml")
    )


@lru_cache
def shipped_arm(name: str) -> ArmDescription:
    """Return the description of an arm.

    Raises:
        ValueError: there is no such arm.
    """
    if name not in shipped_arms():
        raise ValueError(f"there is no description of an arm {name}; there are {', '.join(shipped_arms())}")
    text = (_SHIPPED / f"{name}.toml").read_text(encoding="utf-8")
    return ArmDescription.model_validate(tomllib.loads(text))
