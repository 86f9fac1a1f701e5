"""What J4 is turned by beyond the plan's aim, and finding that without losing the beam."""

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context

_FIRST_STEP = 1.0 / 12.0
_STEP = 0.25
_MOST_STEPS = 8
"""Steps in half widths of the return window: the first gives the direction and is safe even near the edge."""

_AGREEMENT = 0.25
"""Two offsets that differ by less, in half widths of the return window, are the same."""


class AimCorrection:
    """Offset of J4 from the plan's aim, for one reflector.

    An offset that a scan has found serves as long as the beam is kept, since going back to the plan's aim would
    break it again, and for the next start, which is near. A later start elsewhere begins with an offset only if two
    scans in a row found the same: one alone may hold at its own pose only.

    Attributes:
        present_deg: offset of all targets now.
    """

    def __init__(self) -> None:
        self.present_deg = 0.0
        self._kept_deg = 0.0
        self._last_deg: float | None = None
        self._just_found = False

    def found(self, offset_deg: float, half_window_deg: float) -> None:
        """Take in the offset that a scan has found."""
        last, self._last_deg = self._last_deg, offset_deg
        if last is not None and abs(offset_deg - last) <= _AGREEMENT * half_window_deg:
            self._kept_deg = offset_deg
        self.present_deg = offset_deg
        self._just_found = True

    def restart(self) -> None:
        """Begin elsewhere without the beam."""
        if not self._just_found:
            self.present_deg = self._kept_deg
        self._just_found = False

    def applied(self, target: Pose, j4_limits_deg: tuple[float, float]) -> Pose:
        """Return a target with J4 corrected, unless a limit of J4 forbids that."""
        low, high = j4_limits_deg
        j4 = target[3] + self.present_deg
        return (*target[:3], j4) if low <= j4 <= high else target


async def brighten(
    ctx: Context, pose: Pose, half_window_deg: float, j4_limits_deg: tuple[float, float]
) -> float | None:
    """Turn J4 in small steps to where the signal is strongest, with the beam kept all the time.

    Args:
        pose: where the arm stands; only J4 is moved.

    Returns:
        J4 there; None when the beam was lost, and the count with it.
    """
    best_deg, best = pose[3], (await ctx.beam()).signal
    for sign in (1.0, -1.0):
        step, start_deg = _FIRST_STEP, best_deg
        for _ in range(_MOST_STEPS):
            trial_deg = best_deg + sign * step * half_window_deg
            if not j4_limits_deg[0] <= trial_deg <= j4_limits_deg[1]:
                break
            await ctx.move((*pose[:3], trial_deg))
            status = await ctx.beam()
            if not status.count_valid:
                return None
            if status.signal <= best:
                break
            best_deg, best, step = trial_deg, status.signal, _STEP
        if best_deg != start_deg:
            break
    await ctx.move((*pose[:3], best_deg))
    status = await ctx.beam()
    return best_deg if status.count_valid else None
