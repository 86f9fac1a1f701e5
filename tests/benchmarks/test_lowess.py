"""LOWESS of 1.8 million samples against statsmodels: the same neighbourhood, no robustness iterations, no shortcut.

statsmodels takes longer a sample the more samples there are and does not come to an end with 1.8 million in ten
minutes, so it smooths slices of the same data, from its begin, its middle and its end, in the same run, and its least
time a sample counts. Times are those of one core (CPU seconds of this process), so that busy neighbours do not count.
"""

import time
from collections.abc import Callable

import numpy as np
from statsmodels.nonparametric.smoothers_lowess import lowess as peer

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.lowess import half_window, lowess

RATE_HZ = 1000.0
SAMPLES = 1_800_000
SLICE = 20_000
FIRSTS = (0, SAMPLES // 2 - 777, SAMPLES - SLICE)
ROUNDS = 5
HALF = half_window(RATE_HZ)


def recording() -> Floats:
    """Return the velocity of half an hour of steps in noise, 5 s each."""
    rng = np.random.default_rng(1)
    time_s = np.arange(SAMPLES) / RATE_HZ
    return 0.1 * np.exp(-(((time_s % 5.0) - 0.5) ** 2) / 0.05) + rng.normal(0.0, 1.0, SAMPLES)


def by_peer(values: Floats) -> Floats:
    places = np.arange(values.size, dtype=np.float64)
    share = (2 * HALF + 1) / values.size
    return np.asarray(peer(values, places, frac=share, it=0, delta=0.0, is_sorted=True, return_sorted=False))


def timed(work: Callable[[Floats], Floats], values: Floats) -> tuple[float, Floats]:
    start = time.process_time()
    smooth = work(values)
    return time.process_time() - start, smooth


def known(first: int) -> slice:
    """Return where a slice that begins there is as good as the whole: half a window from ends that it has alone."""
    return slice(HALF if first else 0, SLICE - HALF if first + SLICE < SAMPLES else SLICE)


def test_lowess_is_the_peers_in_a_hundredth_of_its_time() -> None:
    values = recording()
    ours_s, smooth = min(
        (timed(lambda v: lowess(v, HALF), values) for _ in range(ROUNDS)), key=lambda t: t[0]
    )
    slices = [timed(by_peer, values[first : first + SLICE]) for first in FIRSTS]
    peers_s = min(slice_s for slice_s, _ in slices) * SAMPLES / SLICE
    apart = max(
        float(np.abs(smooth[first:][known(first)] - expected[known(first)]).max())
        for first, (_, expected) in zip(FIRSTS, slices, strict=True)
    )
    print(  # noqa: T201  # the figure
        f"\nLOWESS of {SAMPLES} samples: {ours_s:.3f} s, statsmodels {peers_s:.1f} s at its time a sample in "
        f"slices of {SLICE}, {peers_s / ours_s:.0f} times; largest difference {apart:.1g}"
    )
    assert apart < 1e-10
    assert peers_s > 100.0 * ours_s
