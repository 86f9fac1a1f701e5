"""Motion that no listed move explains: a second one behind a move, or one behind the last move."""

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.lowess import WINDOW_S, half_window
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.noise import StepNoise
from catseye.calibration.resolution.plateaus import GUARD_S
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.speed import speed_of
from catseye.calibration.resolution.units import shown

SEEN = 5.0
"""A velocity, or a creep on a plateau, beyond so many standard deviations is motion."""

_APART_S = 0.5 * WINDOW_S
"""Rest between two motions; settling swings back sooner."""

_SHARE = 0.1
"""A second motion counts from this share of the command on."""


def second_motions(clip: Recording, speed: Floats, moves: Moves, noise: StepNoise) -> Bools:
    """Return which moves are followed by a motion of its own before the next one, shape (n,).

    Args:
        clip: recording of the moves.
        speed: its smoothed velocity, NaN where it is not known.
        moves: by the clock of the recording.
        noise: of steps and velocity.
    """
    edges = np.append(moves.time_s, moves.time_s[-1] + moves.dwell_s) - GUARD_S
    speed, twice = speed - noise.drift_per_s, np.zeros(len(moves), dtype=np.bool_)
    for number, size in enumerate(np.abs(moves.command).tolist()):
        window = speed[clip.index(float(edges[number])) : clip.index(float(edges[number + 1])) - 1]
        runs = _motions(window, clip.rate_hz, noise)
        moved = np.abs([_moved(window, run, clip.rate_hz) for run in runs])
        # What reaches the end of the window is the next motion, which begins.
        inside = np.array([run[-1] < window.size - 1 for run in runs], dtype=np.bool_)
        large = moved > max(SEEN * noise.step, _SHARE * size)
        twice[number] = np.count_nonzero(large & inside) > 1
    return twice


def motion_behind(recording: Recording, end_s: float, noise: StepNoise) -> list[Flag]:
    """Return a flag for motion behind the last plateau, none without any.

    Args:
        recording: of the moves.
        end_s: of the last plateau, s.
        noise: of steps and velocity.
    """
    # The guard is what the smoothing takes from the begin.
    rest = recording.clipped(end_s - GUARD_S, recording.end_s)
    if rest.position.size <= 2 * half_window(recording.rate_hz) + 1:
        return []
    speed = speed_of(rest) - noise.drift_per_s
    runs = _motions(speed, rest.rate_hz, noise)
    seen = [run for run in runs if abs(_moved(speed, run, rest.rate_hz)) > SEEN * noise.step]
    if not seen:
        return []
    moved = sum(_moved(speed, run, rest.rate_hz) for run in seen)
    at_s = rest.start_s + float(seen[0][0]) / rest.rate_hz
    text = (
        f"behind the last move, from {at_s:.2f} s on, the recording shows motion by {shown(moved, rest.unit)}: moves "
        "are missing from the list, or something else moved the joint"
    )
    return [Flag("unexpected-motion", text)]


def _motions(speed: Floats, rate_hz: float, noise: StepNoise) -> list[Ints]:
    """Return the samples of each motion; what a gap hides belongs to the motion beside it."""
    fast = np.flatnonzero(~(np.abs(speed) <= SEEN * noise.velocity) & ~_ends(speed))
    if not fast.size:
        return []
    return np.split(fast, np.flatnonzero(np.diff(fast) > _APART_S * rate_hz) + 1)


def _ends(speed: Floats) -> Bools:
    """Return where at either end the velocity is not known."""
    known = np.isfinite(speed)
    return np.asarray(~np.logical_or.accumulate(known) | ~np.logical_or.accumulate(known[::-1])[::-1])


def _moved(speed: Floats, run: Ints, rate_hz: float) -> float:
    """Return by how much the position changes in a motion."""
    return float(np.nansum(speed[run])) / rate_hz
