"""The test with decreasing steps: step errors, their moving mean and scatter, and the least increment step.

The resolution paper, sections 3.4, 3.6 and 4.1. What is stated is the least step of the mean error, with an interval:
one series alone leaves the threshold early or late by some steps of the series (ADR 34).
"""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from catseye.calibration.core.arguments import require_count, require_positive
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.resolution.disturbed_steps import disturbed_steps
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.flags import Flag, flag_moves, listed
from catseye.calibration.resolution.least_step import (
    WINDOW,
    first_grown,
    moving_mean,
    moving_spread,
    steps_within,
)
from catseye.calibration.resolution.mean_curve import draw_mean_curves
from catseye.calibration.resolution.scale import Mistake, likely_mistake
from catseye.calibration.resolution.steps import BELOW_INSTRUMENT, Steps
from catseye.calibration.resolution.units import shown

THRESHOLD_PERCENT = 10.0
"""Of ASME B5.64, which the paper follows."""

_DRAWS = 1000
_TAIL = 0.025
"""What lies beyond either end of a 95 % interval."""

_HALF = WINDOW // 2
_FAR_PERCENT = 50.0

_STILL_PERCENT: Final = 50.0
"""A step that is made to less than this, either way, is hardly made."""

_NONE_PERCENT: Final = 10.0
"""A step that is made to less than this, either way, is not made at all."""

_FEWEST_NONE: Final = 5
"""Steps at the end of a series that are not made at all before somebody has to say whether they were driven."""

_DRIFT_SHARE: Final = 0.01
"""Of the least step: a drift that changes by less in a dwell is a tenth of the threshold at most."""

_FEWEST_STILL: Final = 3
"""Steps at the end of a series that are hardly made before the joint counts as having stopped following."""


@dataclass(frozen=True)
class LeastStep:
    """Least increment step of the mean error, in the unit of the moves.

    Attributes:
        value: a step of the series: the median of what the series leaves open.
        u: standard deviation of what it leaves open.
        low: lower end of the 95 % interval; 0 where the steps that were judged do not end the search.
        high: upper end of it.
    """

    value: float
    u: float
    low: float
    high: float


@dataclass(frozen=True)
class DecayingTest:
    """Result of a series of decreasing steps in one direction.

    Attributes:
        steps: what was measured.
        error_percent: E_s of the moves that were judged, NaN of the others, shape (n,).
        mean_percent: their 11-point moving mean; at the ends, of the steps that are there, shape (n,).
        spread_percent: standard deviation of the errors about their moving mean in the same window, shape (n,).
        threshold_percent: largest mean error of a step that counts as made.
        by_rule: least step by the paper's rule from this series as it is, one that was judged; None where not even
            the largest is within.
        least_step: None where the largest steps are not within the threshold with enough certainty.
        mistake: what may be the reason for that; None for nothing known, and where a least step is stated.
        stopped_at: number of the move from which on no step was made at all, while the mean error of those before
            kept within the threshold to the last one: the least step is where the motion ended; None where it is not.
        flags: of the steps and of the result.
    """

    steps: Steps
    error_percent: Floats
    mean_percent: Floats
    spread_percent: Floats
    threshold_percent: float
    by_rule: float | None
    least_step: LeastStep | None
    mistake: Mistake | None
    stopped_at: int | None
    flags: tuple[Flag, ...]


def decaying_test(
    steps: Steps, threshold_percent: float = THRESHOLD_PERCENT, seed: int = 1, draws: int = _DRAWS
) -> DecayingTest:
    """Evaluate a series of decreasing steps in one direction.

    Args:
        steps: of the whole series.
        threshold_percent: largest mean error of a step that counts as made.
        seed: of the draws that the interval comes from.

    Raises:
        MovesError: the steps do not decrease, change their direction, or fewer than 11 of them are judged.
        ArgumentError: the threshold is not positive, or there are fewer than two draws.
    """
    require_positive(threshold_percent, "threshold_percent")
    require_count(draws, "draws", 2)
    size = _sizes(steps)
    error = np.where(steps.judged, steps.error_percent, np.nan)
    mean = moving_mean(error)
    spread = moving_spread(error, mean)
    # A gap of the recording leaves steps out on the way to the smallest one that is judged.
    judged = int(np.flatnonzero(steps.judged)[-1]) + 1
    # Below the last of them, the moving mean is that of steps above.
    within = int(steps_within(mean[:judged], threshold_percent))
    known = steps.judged[:judged]
    rng = np.random.default_rng(seed)
    scales = 1.0 + steps.u_scale * rng.standard_normal(draws)
    followed = _followed(error[:judged], known)
    places = np.flatnonzero(followed)
    disturbed = disturbed_steps(size[places], error[places])
    curves = draw_mean_curves(np.log(size[places]), error[places], ~disturbed.left_out, draws, rng)
    drawn = np.tile(error[:judged], (draws, 1))
    drifts = steps.noise.u_drift_per_s * steps.moves.dwell_s * rng.standard_normal(draws)
    curves += 100.0 * drifts[:, None] / size[places]
    drawn[:, followed] = (100.0 + curves) * scales[:, None] - 100.0
    counts = steps_within(moving_mean(drawn), threshold_percent)
    least = _least_step(size[:judged], counts + rng.uniform(-0.5, 0.5, draws))
    by_rule = float(size[within - 1]) if within else None
    if disturbed.left_out.any():
        least = _holding(least, by_rule)
    flags = (
        *steps.flags,
        *disturbed.flags(places, steps.moves.first),
        *_drift_flags(steps, least),
        *_flags(steps, judged, least, size),
    )
    mistake = likely_mistake(_ratio(steps)) if least is None else None
    stopped_at = _stopped_at(steps, np.where(followed, error[:judged], np.nan), threshold_percent)
    return DecayingTest(
        steps, error, mean, spread, threshold_percent, by_rule, least, mistake, stopped_at, flags
    )


def _followed(error: Floats, known: Bools) -> Bools:
    """Return which of the judged steps come before the joint stops following: a smooth mean makes no such jump.

    Smaller steps than a controller passes on are not made at all, nor those after a program has ended. A joint that
    hardly follows from the beginning is left as it is.

    Args:
        error: E_s, NaN where a step is not judged, shape (n,).
        known: which steps are judged, shape (n,).
    """
    judged = np.flatnonzero(known)
    moved = np.flatnonzero(np.abs(error[judged] + 100.0) >= _STILL_PERCENT)
    count = int(moved[-1]) + 1 if moved.size else 0
    if count < WINDOW or judged.size - count < _FEWEST_STILL:
        return known
    followed = known.copy()
    followed[judged[count:]] = False
    return followed


def _stopped_at(steps: Steps, error: Floats, threshold_percent: float) -> int | None:
    """Return the number of the first move of an end that nobody made, if that end alone gives the least step.

    Args:
        error: E_s up to the last step that is judged, NaN where the joint does not follow any more, shape (n,).
    """
    made = int(np.flatnonzero(np.isfinite(error))[-1]) + 1
    ended = made + np.flatnonzero(steps.judged[made : error.size])
    size, moved = np.abs(steps.moves.command[ended]), np.abs(steps.measured[ended])
    none = moved <= np.maximum(_NONE_PERCENT / 100.0 * size, BELOW_INSTRUMENT * steps.u[ended])
    if ended.size < _FEWEST_NONE or not none.all():
        return None
    if int(steps_within(moving_mean(error[:made]), threshold_percent)) < made:
        return None
    return int(ended[0]) + steps.moves.first


def _sizes(steps: Steps) -> Floats:
    """Return the sizes of the commanded steps, or refuse a series that is none of decreasing ones."""
    command = steps.moves.command
    size = np.abs(command)
    turned = np.flatnonzero(command * command[0] < 0.0)
    if turned.size:
        raise MovesError(
            f"move {turned[0] + 1} goes the other way: a test with decreasing steps has one direction; evaluate each "
            "direction by itself, or state which test it was",
            int(turned[0]) + 1,
        )
    grown = first_grown(size)
    if grown is not None:
        raise MovesError(
            f"move {grown + 1} is {shown(float(size[grown]), steps.moves.unit)} and no smaller than "
            "the one before: the steps of this test decrease; check the moves, or state which test it was",
            grown + 1,
        )
    if size.size < WINDOW:
        raise MovesError(
            f"the test has {size.size} steps, and a moving mean takes {WINDOW}: measure more of them"
        )
    judged = int(np.count_nonzero(steps.judged))
    if judged < WINDOW:
        raise MovesError(
            f"{judged} of {size.size} steps lie above what the instrument resolves, and a moving mean takes "
            f"{WINDOW}: begin with larger steps, or measure in calmer air"
        )
    return size


def _least_step(size: Floats, counts: Floats) -> LeastStep | None:
    """Return the least step of counts of steps within, which are spread over the cells of the series.

    A count of whole steps has ends that jump by a step; spread over half a step to either side, an interval's ends
    lie where they hold as often as they say.

    Args:
        size: by decreasing step, shape (n,).
        counts: of steps within, shape (draws,).
    """
    if np.mean(counts < 0.5) > _TAIL:
        return None
    low, middle, high = np.quantile(counts, [1.0 - _TAIL, 0.5, _TAIL]) - 1.0
    found = _size_at(size, np.clip(counts, 0.5, size.size + 0.5) - 1.0)
    open_below = float(np.mean(counts > size.size - 0.5)) > _TAIL
    return LeastStep(
        value=float(size[int(np.clip(round(middle), 0, size.size - 1))]),
        u=float(found.std()),
        low=0.0 if open_below else float(_size_at(size, low)),
        high=float(_size_at(size, high)),
    )


def _holding(least: LeastStep | None, by_rule: float | None) -> LeastStep | None:
    """Return a least step whose interval holds what the rule gives with the steps that were left out.

    One series does not tell what happened once from what happens seldom: None where the rule gives none.
    """
    if least is None or by_rule is None:
        return None
    return replace(least, low=min(least.low, by_rule), high=max(least.high, by_rule))


def _size_at(size: Floats, number: Floats | float) -> Floats:
    """Return the size at places between the steps, from 0 on, and up to a step beyond the ends, any shape.

    The series need not fall by the same factor everywhere: moves may be missing.
    """
    logs = np.log(size)
    ends = 2.0 * logs[[0, -1]] - logs[[1, -2]]
    places = np.arange(-1.0, size.size + 1.0)
    return np.asarray(np.exp(np.interp(number, places, np.concatenate([ends[:1], logs, ends[1:]]))))


def _flags(steps: Steps, judged: int, least: LeastStep | None, size: Floats) -> list[Flag]:
    numbers = np.arange(size.size)
    ends = steps.judged & ((numbers < _HALF) | (numbers >= judged - _HALF))
    flags = flag_moves("partial-mean", ends, f"the moving mean takes fewer than {WINDOW} steps here")
    unit = steps.moves.unit
    if least is None:
        return [*flags, Flag("least-step-open", _why_none(steps, size))]
    if least.low == 0.0:
        smallest = shown(float(size[judged - 1]), unit)
        text = f"the mean error may keep within the threshold beyond the smallest judged step, {smallest}: no low end"
        return [*flags, Flag("least-step-open", text)]
    return flags


def _drift_flags(steps: Steps, least: LeastStep | None) -> list[Flag]:
    """Return the doubt about a drift that changes by more than a hundredth of the least step in a dwell."""
    each = steps.noise.drift_change_per_s * steps.moves.dwell_s
    smallest = float(np.abs(steps.moves.command[steps.judged]).min())
    if each <= _DRIFT_SHARE * (smallest if least is None else least.value):
        return []
    text = (
        f"the plateaus show a drift that differs by {shown(each, steps.moves.unit)} in a dwell from that of the "
        "standstill: the interval of the least step holds that; let optics and air come to rest, and measure again"
    )
    return [Flag("changing-drift", text)]


def _ratio(steps: Steps) -> float:
    """Return how many times as long as commanded the largest steps are, in the median."""
    return 1.0 + float(np.nanmedian(steps.error_percent[:WINDOW])) / 100.0


def _why_none(steps: Steps, size: Floats) -> str:
    """Return why no least step is stated, with the steps among the largest that hardly are what was commanded."""
    error = steps.error_percent[:WINDOW]
    if mistake := likely_mistake(_ratio(steps)):
        return (
            f"the largest steps are {_ratio(steps):.3g} times those commanded: {mistake.text}; correct it and "
            "evaluate again. No least step is stated"
        )
    largest, mean = shown(float(size[0]), steps.moves.unit), float(np.nanmean(error))
    far = [number + steps.moves.first for number in np.flatnonzero(np.abs(error) > _FAR_PERCENT).tolist()]
    if 0 < len(far) <= _HALF:
        verb = "is" if len(far) == 1 else "are"
        likely = f"{listed(far)} {verb} off by more than {_FAR_PERCENT:g} %: look at the recording there"
    else:
        likely = "begin with larger steps, or check spacing and unit"
    return (
        f"the mean error of the largest steps, {largest} and less, is {mean:+.3g} % and may exceed the threshold: no "
        f"least step is stated; {likely}"
    )
