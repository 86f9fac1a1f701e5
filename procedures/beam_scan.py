"""Finding the beam's return by turning J4, and the middle of the window in which it returns (Remark 1)."""

import math
from dataclasses import dataclass

from procedures.context import Context
from procedures.devices import Joints

_EDGE_RESOLUTION_DEG = 0.002
"""An edge of the window is bisected to this; the controller resolves 0.001°."""


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


def half_window_deg(acceptance_mm: float, beam_mm: float) -> float:
    """Return half the width of the return window that geometry lets expect, deg."""
    return math.degrees(math.asin(min(1.0, acceptance_mm / beam_mm)))


def scan_offsets_deg(half_range_deg: float, step_deg: float) -> list[float]:
    """Return offsets that cover ±half_range from the middle outwards: 0, +s, −s, +2s and so on."""
    count = math.ceil(half_range_deg / step_deg)
    return [0.0] + [sign * k * step_deg for k in range(1, count + 1) for sign in (1.0, -1.0)]


async def find_return(
    ctx: Context,
    pose: Joints,
    half_range_deg: float,
    half_window: float,
    j4_limits_deg: tuple[float, float],
) -> ReturnWindow | None:
    """Turn J4 about a pose until the beam returns, then centre it.

    Args:
        ctx: the bench.
        pose: where to start; only J4 is moved.
        half_range_deg: how far J4 may turn to either side.
        half_window: expected half width of the return window, deg.
        j4_limits_deg: limits of J4; offsets beyond them are left out.

    Returns:
        The window, with J4 at its middle; or None when the beam does not return anywhere in the range, or when
        a limit of J4 cuts the window off, so that its middle cannot be known.
    """
    low, high = j4_limits_deg
    for offset in scan_offsets_deg(half_range_deg, 1.4 * half_window):
        j4 = pose[3] + offset
        if low <= j4 <= high and await _returns_at(ctx, pose, j4):
            return await _centre(ctx, pose, j4, half_window, j4_limits_deg)
    return None


async def _centre(
    ctx: Context, pose: Joints, hit_deg: float, half_window: float, j4_limits_deg: tuple[float, float]
) -> ReturnWindow | None:
    upper = await _edge(ctx, pose, hit_deg, half_window, j4_limits_deg)
    lower = await _edge(ctx, pose, hit_deg, -half_window, j4_limits_deg)
    if upper is None or lower is None:
        return None
    await ctx.move((*pose[:3], 0.5 * (lower + upper)))
    return ReturnWindow(lower, upper, (await ctx.beam()).signal)


async def _edge(
    ctx: Context, pose: Joints, hit_deg: float, stride: float, j4_limits_deg: tuple[float, float]
) -> float | None:
    """Return the J4 angle at which the return ends on the side of the stride's sign; None beyond the limits."""
    low, high = j4_limits_deg
    inside, outside = hit_deg, min(max(hit_deg + stride, low), high)
    while await _returns_at(ctx, pose, outside):
        if outside in (low, high):
            return None
        inside, outside = outside, min(max(outside + stride, low), high)
    while abs(outside - inside) > _EDGE_RESOLUTION_DEG:
        middle = 0.5 * (inside + outside)
        if await _returns_at(ctx, pose, middle):
            inside = middle
        else:
            outside = middle
    return 0.5 * (inside + outside)


async def _returns_at(ctx: Context, pose: Joints, j4_deg: float) -> bool:
    await ctx.move((*pose[:3], j4_deg))
    return (await ctx.beam()).beam_ok
