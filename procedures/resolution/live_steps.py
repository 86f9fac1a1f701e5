"""The steps of a series as they look while it goes on; results come from the whole recording."""

import math
import statistics
from collections.abc import Sequence
from typing import Final

from catseye.procedures.kit.angular_optics import angle_deg
from catseye.procedures.kit.bench import AngularOptics, LinearOptics
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.live import Live, LiveStep
from catseye.procedures.kit.recording import Recording
from catseye.procedures.resolution.campaign_plan import Place, Series
from catseye.procedures.resolution.records import Move

_PLATEAU_S: Final = 1.0
"""Of the newest readings."""

_MOST_READINGS: Final = 1000
_THRESHOLD_PERCENT: Final = 10.0
"""Band of the step error that is shown (ASME B5.64, as the resolution paper has it); results choose their own."""

_NOT_JUDGED: Final = "the step is below what the instrument resolves: it is not judged"
_SIGMAS: Final = 3.0
_FEWEST_DIFFERENCES: Final = 5
"""With fewer means of the standstill nothing is said about what the instrument resolves."""


class LiveSteps:
    """Shows the steps of one recording.

    Args:
        series: that is recorded.
        place: where the optics stand.
        optics: there.
    """

    def __init__(
        self, ctx: Context, series: Series, place: Place, optics: AngularOptics | LinearOptics
    ) -> None:
        self._ctx = ctx
        self._series = series
        self._unit = place.unit
        self._optics = optics
        self._still: list[float] = []
        self._resolved = 0.0
        self._mounting = 0.0
        self._origin = 0.0

    async def stand_still(self, recording: Recording, duration_s: float, dwell_s: float) -> None:
        """Pause, and learn from this and earlier pauses how small a step the instrument resolves.

        Args:
            duration_s: of the pause, s.
            dwell_s: between moves, s: plateaus are compared that far apart.
        """
        left_s = duration_s
        while left_s > 0.0:
            await self._ctx.pause(min(_PLATEAU_S, left_s))
            left_s -= _PLATEAU_S
            mean = self.plateau(recording)
            if mean is not None:
                self._still.append(mean)
        self._resolved = _SIGMAS * _difference(self._still, dwell_s)

    def plateau(self, recording: Recording) -> float | None:
        """Return where the arm stands by the newest readings, deg or mm; None without any."""
        newest = recording.newest(_MOST_READINGS)
        values = [value for time_s, value in newest if time_s > newest[-1][0] - _PLATEAU_S]
        if not values:
            return None
        mean_mm = statistics.fmean(values)
        if not isinstance(self._optics, AngularOptics):
            return mean_mm
        return angle_deg(mean_mm, self._optics.spacing_mm)

    def show(self, move: Move, before: float | None, after: float | None) -> None:
        """Show a step.

        Args:
            before: plateau before it, deg or mm.
            after: plateau after it.
        """
        if before is None or after is None:
            return
        # Which way the beam grows is a matter of mounting: the first step, the largest one, tells.
        if not self._mounting:
            self._mounting, self._origin = math.copysign(1.0, (after - before) * move.command), before
        measured = self._mounting * (after - before)
        error = 100.0 * (measured / move.command - 1.0)
        step = LiveStep(
            self._series.title,
            move.number,
            len(self._series.orders),
            move.command,
            measured,
            self._mounting * (after - self._origin),
            self._unit,
            error,
            _THRESHOLD_PERCENT,
            move.torque_nm,
            below=abs(move.command) < self._resolved,
        )
        name = f"step error of {self._series.title}"
        limit, text = (None, _NOT_JUDGED) if step.below else (_THRESHOLD_PERCENT, "")
        self._ctx.show(Live(name, error, "%", None if limit is None else -limit, limit, text, step))


def _difference(means: Sequence[float], apart_s: float) -> float:
    """Return the rms of differences between means so far apart; 0 where they are too few to tell.

    It is the structure function that the evaluation judges steps by, from fewer means.
    """
    apart = max(1, math.ceil(apart_s / _PLATEAU_S))
    differences = [later - earlier for earlier, later in zip(means, means[apart:], strict=False)]
    if len(differences) < _FEWEST_DIFFERENCES:
        return 0.0
    return math.sqrt(statistics.fmean(each * each for each in differences))
