"""What speaks against an identified arm: bounds that it breaks, mistakes that explain it, other solutions."""

import math
from dataclasses import dataclass
from typing import Literal

Joint = Literal[1, 2]


@dataclass(frozen=True)
class LinkOff:
    """A link is not as long as its nominal length, mm."""

    link: Joint
    found_mm: float
    nominal_mm: float
    bound_mm: float

    @property
    def share(self) -> float:
        """Share of the bound."""
        return abs(self.found_mm - self.nominal_mm) / self.bound_mm


@dataclass(frozen=True)
class DeviationOff:
    """The angle of a joint deviates from its command; the largest deviation stands for all, rad."""

    joint: Joint
    found_rad: float
    bound_rad: float

    @property
    def share(self) -> float:
        """Share of the bound."""
        return abs(self.found_rad) / self.bound_rad


@dataclass(frozen=True)
class PlaceOff:
    """A reflector is not at its rough place, mm."""

    reflector: str
    found_mm: tuple[float, float]
    rough_mm: tuple[float, float]
    bound_mm: float

    @property
    def off_mm(self) -> float:
        """How far it is from there."""
        return math.dist(self.found_mm, self.rough_mm)

    @property
    def share(self) -> float:
        """Share of the bound."""
        return self.off_mm / self.bound_mm


Offset = LinkOff | DeviationOff | PlaceOff


@dataclass(frozen=True)
class AngleSignReversed:
    """The commands of these joints have the wrong sign."""

    joints: tuple[Joint, ...]


@dataclass(frozen=True)
class DisplacementSignReversed:
    """Displacements fall where the beam grows longer."""


@dataclass(frozen=True)
class AnglesInRadians:
    """The commands of these joints are numbers in rad where deg were stated."""

    joints: tuple[Joint, ...]


@dataclass(frozen=True)
class DisplacementScaled:
    """Displacements have to be multiplied by a factor to be mm."""

    factor: float


@dataclass(frozen=True)
class LinksExchanged:
    """The nominal lengths of links 1 and 2 are exchanged."""


@dataclass(frozen=True)
class OtherLinks:
    """The distances are those of an arm with other links, mm."""

    link1_mm: float
    link2_mm: float


@dataclass(frozen=True)
class RowsShifted:
    """Displacements stand so many rows below the commands that they were measured at; above if negative."""

    rows: int


@dataclass(frozen=True)
class NamesExchanged:
    """Two reflectors carry each other's name."""

    first: str
    second: str


Mirror = Literal["y", "x", "both", "exchanged"]
"""Sign of y, of x, of both; or x and y exchanged."""


@dataclass(frozen=True)
class PlacesMirrored:
    """The rough places are mirrored or turned."""

    mirror: Mirror


@dataclass(frozen=True)
class ZeroLost:
    """The count jumped inside a segment: after one row and before another, from 0, of the distances given."""

    reflector: str
    segment: int
    after: int
    row: int
    jump_mm: float


@dataclass(frozen=True)
class ReflectorMoved:
    """A reflector stood somewhere else from a row on, counted from 0 among the distances given."""

    reflector: str
    row: int
    by_mm: tuple[float, float]


@dataclass(frozen=True)
class MountingForgotten:
    """The interferometer was turned by half a turn on J4's flange before a row, from 0, and nothing states it."""

    reflector: str
    segment: int
    row: int


@dataclass(frozen=True)
class MountingInRadians:
    """The turn of the interferometer on J4's flange is a number in rad where deg are stated, from a row on, from 0.

    Attributes:
        turned_rad: that number.
    """

    reflector: str
    segment: int
    row: int
    turned_rad: float


@dataclass(frozen=True)
class MountingOff:
    """The interferometer was turned by another angle on J4's flange than is stated, from a row on, from 0.

    Attributes:
        stated_rad: by the table.
        found_rad: about what the distances suggest.
    """

    reflector: str
    segment: int
    row: int
    stated_rad: float
    found_rad: float


Mistake = (
    AngleSignReversed
    | DisplacementSignReversed
    | AnglesInRadians
    | DisplacementScaled
    | LinksExchanged
    | OtherLinks
    | RowsShifted
    | NamesExchanged
    | PlacesMirrored
    | ZeroLost
    | ReflectorMoved
    | MountingForgotten
    | MountingInRadians
    | MountingOff
)


@dataclass(frozen=True)
class OtherSolution:
    """Another arm, reached from another start, that the distances fit as well or better.

    Attributes:
        links_mm: of that arm.
        places_mm: of its reflectors, by name.
        rms_mm: its residuals.
        own_rms_mm: residuals of the arm that was identified, fitted in the same way.
    """

    links_mm: tuple[float, float]
    places_mm: tuple[tuple[str, float, float], ...]
    rms_mm: float
    own_rms_mm: float


@dataclass(frozen=True)
class VagueLink:
    """The distances leave the length of a link open by more than its bound, mm."""

    link: Joint
    u_mm: float
    bound_mm: float


@dataclass(frozen=True)
class Verdict:
    """What speaks against an identified arm.

    Attributes:
        breaks: what is beyond its bound.
        mistakes: each alone explains the distances; none where nothing that was tried does.
        others: solutions that the distances do not distinguish from it.
        vague: links that the distances do not determine well enough to be judged.
        rms_mm: residuals that an error map leaves of the distances as they are; infinite where it has no solution.
    """

    breaks: tuple[Offset, ...] = ()
    mistakes: tuple[Mistake, ...] = ()
    others: tuple[OtherSolution, ...] = ()
    vague: tuple[VagueLink, ...] = ()
    rms_mm: float = math.inf

    @property
    def implausible(self) -> bool:
        """The arm should not be used."""
        return bool(self.breaks or self.mistakes or self.others or self.vague)
