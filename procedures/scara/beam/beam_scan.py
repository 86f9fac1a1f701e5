"""Finding the beam's return by turning J4 or lifting J3, and the middle of its window (Remark 1); how wide it is."""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.scara.planar import forward, wrap_rad
from catseye.calibration.scara.pointing import beam_direction
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.live import Live
from catseye.procedures.scara.bench import Reflector, ScaraBench

LOOK_AROUND_DEG = 0.5
"""How far J4 is turned to either side to find a beam again."""

_J3, _J4 = 2, 3

_EDGE_RESOLUTION = {_J3: 0.01, _J4: 0.002}
"""An edge of the window is bisected to this, mm and deg; the controller resolves 0.001."""

_BESIDE = 0.25
"""So far outside of an edge, in half widths of the window, nothing may return."""

_TRIES = 3
"""Something that passes through the beam while an edge is looked for feigns an edge: both are looked for again."""

_WIDTHS = (1.0, 0.4)
"""Of the return window, as shares of the full one: a beam at the wrong height has a narrower one."""

_NAMES: dict[int, tuple[str, str]] = {_J3: ("J3", "mm"), _J4: ("J4", "deg")}


@dataclass(frozen=True)
class ReturnWindow:
    """The J4 angles between which the beam returns.

    Attributes:
        lower_deg: lower edge.
        upper_deg: upper edge.
        signal: level at the middle, 0...1.
    """

    lower_deg: float
    upper_deg: float
    signal: float

    @property
    def centre_deg(self) -> float:
        """Middle of the window: the beam passes the reflector's centre."""
        return 0.5 * (self.lower_deg + self.upper_deg)


@dataclass(frozen=True)
class HeightWindow:
    """The heights of J3 between which the beam returns.

    Attributes:
        lower_mm: lower edge.
        upper_mm: upper edge.
        signal: level at the middle, 0...1.
    """

    lower_mm: float
    upper_mm: float
    signal: float

    @property
    def centre_mm(self) -> float:
        """Middle of the window: the beam passes the reflector's centre at its height."""
        return 0.5 * (self.lower_mm + self.upper_mm)


Looks = list[tuple[float, float]]
"""Where the joint stood, mm or deg, and the signal there, in order."""


def half_window_deg(acceptance_mm: float, beam_mm: float) -> float:
    """Return half the width of the return window expected from geometry, deg."""
    return math.degrees(math.asin(min(1.0, acceptance_mm / beam_mm)))


def beam_mm(joints: Pose, bench: ScaraBench, reflector: Reflector) -> float:
    """Return the length of the beam from a pose to a reflector, mm."""
    return float(np.hypot(*(reflector.xy_mm - _position_mm(joints, bench))))


def window_deg(joints: Pose, bench: ScaraBench, reflector: Reflector) -> float:
    """Return half the width of the return window from a pose, deg."""
    return half_window_deg(bench.optics.acceptance_mm, beam_mm(joints, bench, reflector))


def look_around_deg(joints: Pose, bench: ScaraBench, reflector: Reflector) -> float:
    """Return how far J4 may turn from a pose without meeting another reflector, deg.

    The distance to that one would be taken for this one's.
    """
    if bench.optics.one_reflector:
        return LOOK_AROUND_DEG
    here = _position_mm(joints, bench)
    own = beam_direction(here, reflector.xy_mm)
    margin_deg = 2.0 * window_deg(joints, bench, reflector)
    off_deg = [
        float(np.rad2deg(np.abs(wrap_rad(beam_direction(here, other.xy_mm) - own)))) - margin_deg
        for other in bench.reflectors
        if other != reflector
    ]
    return max(0.0, min(LOOK_AROUND_DEG, *off_deg)) if off_deg else LOOK_AROUND_DEG


def scan_offsets_deg(half_range_deg: float, step_deg: float) -> list[float]:
    """Return offsets that cover ±half_range from the middle outwards: 0, +s, −s, +2s and so on."""
    count = math.ceil(half_range_deg / step_deg)
    return [0.0] + [sign * k * step_deg for k in range(1, count + 1) for sign in (1.0, -1.0)]


async def find_return(
    ctx: Context,
    pose: Pose,
    half_range_deg: float,
    half_window: float,
    j4_limits_deg: tuple[float, float],
    signal_min: float = 0.0,
    looks: Looks | None = None,
) -> ReturnWindow | None:
    """Turn J4 about a pose until the beam returns, then centre it.

    Args:
        half_window: expected half width of the return window, deg.
        j4_limits_deg: limits of J4; offsets beyond them are left out.
        signal_min: lower end of the signal's band that is shown, 0...1.
        looks: is given every look, found or not; None where nobody keeps them.

    Returns:
        The window, with J4 at its middle; or None when the beam does not return anywhere in the range, or when
        a limit of J4 cuts the window off, so that its middle cannot be known.
    """
    scan = _Scan(ctx, pose, _J4, j4_limits_deg, half_window, signal_min, [] if looks is None else looks)
    window = await scan.search(half_range_deg)
    return None if window is None else ReturnWindow(*window)


async def find_narrow_return(
    ctx: Context, pose: Pose, half_range_deg: float, beam_mm: float, bench: ScaraBench
) -> ReturnWindow | None:
    """Do the same for a beam that may be as far too high or low as the acceptance allows."""
    optics, limits = bench.optics, bench.j4_limits_deg
    half_window = half_window_deg(optics.acceptance_mm, beam_mm)
    for width in _WIDTHS:
        window = await find_return(ctx, pose, half_range_deg, width * half_window, limits, optics.signal_min)
        if window is not None:
            return window
    return None


async def find_at_heights(
    ctx: Context,
    pose: Pose,
    half_range_deg: float,
    beam_mm: float,
    bench: ScaraBench,
    j3_range_mm: tuple[float, float],
) -> Pose | None:
    """Turn J4 about a pose at its height and, outwards from there, at others until the beam returns.

    Returns:
        The pose with J4 in the middle of the window; None when the beam does not return at any height of the range.
    """
    optics, (low, high) = bench.optics, j3_range_mm
    half_window = half_window_deg(optics.acceptance_mm, beam_mm)
    for offset in scan_offsets_deg(high - low, 1.4 * optics.acceptance_mm):
        start = with_joint(pose, _J3, pose[_J3] + offset)
        if not low <= start[_J3] <= high:
            continue
        window = await find_return(
            ctx, start, half_range_deg, half_window, bench.j4_limits_deg, optics.signal_min
        )
        if window is not None:
            return with_joint(start, _J4, window.centre_deg)
    return None


async def find_height(
    ctx: Context,
    pose: Pose,
    half_range_mm: float,
    half_window_mm: float,
    j3_range_mm: tuple[float, float],
    signal_min: float = 0.0,
) -> HeightWindow | Literal["lower", "upper"] | None:
    """Lift J3 about a pose until the beam returns, then centre it.

    Args:
        half_window_mm: expected half height of the return window, mm.
        j3_range_mm: range of J3; heights beyond it are left out.
        signal_min: lower end of the signal's band that is shown, 0...1.

    Returns:
        The window, with J3 at its middle; "lower" or "upper" when that end of J3's range cuts it off; None when the
        beam does not return anywhere.
    """
    scan = _Scan(ctx, pose, _J3, j3_range_mm, half_window_mm, signal_min)
    window = await scan.search(half_range_mm)
    if window is not None:
        return HeightWindow(*window)
    return scan.cut_off


@dataclass(eq=False)
class _Scan:
    """One joint is moved, the others stay; lengths in the unit of the joint, mm or deg."""

    ctx: Context
    pose: Pose
    joint: int
    limits: tuple[float, float]
    half_window: float
    signal_min: float
    looks: Looks = field(default_factory=list)
    signal: float = field(default=0.0, init=False)
    cut_off: Literal["lower", "upper"] | None = field(default=None, init=False)
    """Which end of the joint's range cut the window off, if one did."""

    async def search(self, half_range: float) -> tuple[float, float, float] | None:
        """Return both edges and the signal in the middle."""
        low, high = self.limits
        for offset in scan_offsets_deg(half_range, 1.4 * self.half_window):
            value = self.pose[self.joint] + offset
            if low <= value <= high and await self._returns_at(value):
                return await self._centre(value)
        return None

    async def _centre(self, hit: float) -> tuple[float, float, float] | None:
        for _ in range(_TRIES):
            upper = await self._edge(hit, self.half_window)
            lower = await self._edge(hit, -self.half_window)
            if upper is None or lower is None:
                self.cut_off = "upper" if upper is None else "lower"
                return None
            if await self._are_edges(lower, upper):
                return lower, upper, self.signal
        return None

    async def _are_edges(self, lower: float, upper: float) -> bool:
        """Return whether the beam returns in the middle and not beside the edges; the joint ends in the middle.

        Two looks at the middle: what has stood in the beam since the edges were looked for shows at the first.
        """
        low, high = self.limits
        beside, middle = _BESIDE * self.half_window, 0.5 * (lower + upper)
        returns = await self._returns_at(middle)
        for value in (upper + beside, lower - beside):
            if returns and low <= value <= high:
                returns = not await self._returns_at(value)
        return await self._returns_at(middle) and returns

    async def _edge(self, hit: float, stride: float) -> float | None:
        """Return where the return ends on the side of the stride's sign; None beyond the limits."""
        low, high = self.limits
        inside, outside = hit, min(max(hit + stride, low), high)
        while await self._returns_at(outside):
            if outside in (low, high):
                return None
            inside, outside = outside, min(max(outside + stride, low), high)
        while abs(outside - inside) > _EDGE_RESOLUTION[self.joint]:
            middle = 0.5 * (inside + outside)
            if await self._returns_at(middle):
                inside = middle
            else:
                outside = middle
        return 0.5 * (inside + outside)

    async def _returns_at(self, value: float) -> bool:
        target = with_joint(self.pose, self.joint, value)
        await self.ctx.move(target)
        beam = await self.ctx.beam()
        self.signal = beam.signal
        self.looks.append((value, beam.signal))
        self.ctx.show(signal_live(beam.signal, self.signal_min))
        name, unit = _NAMES[self.joint]
        # It has no band to keep within: the signal is what is watched.
        self.ctx.show(Live(name, value, unit))
        return beam.beam_ok


def with_joint(pose: Pose, joint: int, value: float) -> Pose:
    """Return a pose with another value of one joint, 0...3."""
    one, two, three, four = (value if n == joint else own for n, own in enumerate(pose))
    return one, two, three, four


def signal_live(signal: float, signal_min: float) -> Live:
    """Return the signal, 0...1, with its band."""
    return Live("signal", signal, "", signal_min, 1.0)


def _position_mm(joints: Pose, bench: ScaraBench) -> NDArray[np.float64]:
    one, two = np.deg2rad(joints[:2])
    return forward(one, two, bench.link1_mm, bench.link2_mm)
