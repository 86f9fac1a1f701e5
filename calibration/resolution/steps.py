"""Steps of a recording: what the joint or the tool did at each commanded move.

The resolution paper, section 3.6: clip, differentiate, smooth, one velocity peak per expected move in its window,
plateaus between, a step as the difference of two. A move without a peak is measured like every other one, as what
its plateaus say, and flagged: a joint that sticks makes steps of zero, and to leave those out would flatter it. A
move beside a plateau that a gap of the recording swallows is not measured at all.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.flags import Flag, FlagKind, flag_moves
from catseye.calibration.resolution.frozen_signal import frozen_flags, frozen_stretch, require_unsaturated
from catseye.calibration.resolution.lowess import half_window
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.noise import (
    StepNoise,
    noise_of_plateaus,
    noise_of_standstill,
    standstill_before,
)
from catseye.calibration.resolution.optics import Optics
from catseye.calibration.resolution.plateau_drift import with_plateau_drift
from catseye.calibration.resolution.plateaus import GUARD_S, Plateaus, plateaus
from catseye.calibration.resolution.quantum import DIFFERENCE, DITHERED
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.speed import speed_of
from catseye.calibration.resolution.standstill import Standstill
from catseye.calibration.resolution.unexpected_motion import SEEN, motion_behind, second_motions
from catseye.calibration.resolution.units import shown

BELOW_INSTRUMENT = 3.0
"""A commanded step below so many standard uncertainties of a step is not judged."""

_CREEP = 0.01
"""A plateau is unsettled from this share of the step on."""

_LONG = 1.5
"""A rest of so many dwells is one in which other moves may have been made."""

_OFF = 0.5
"""A step off by this share of its command behind such a rest is not that of one move."""

_MERGED = 0.3


@dataclass(frozen=True)
class Steps:
    """What was measured at each move, in the unit of the moves.

    Attributes:
        moves: what was commanded.
        measured: Δm, the drift subtracted, NaN where a plateau is missing, shape (n,).
        u: standard uncertainty of each: noise, drift, optics, NaN likewise, shape (n,).
        peak_s: time of its velocity peak, s; NaN where none stands out of the noise, shape (n,).
        judged: False where the command lies below what the instrument resolves, nothing was measured, or what was is
            not the step of one move, shape (n,).
        plateaus: what the steps are differences of.
        noise: of steps, plateaus and velocity.
        u_scale: relative standard uncertainty that all steps share.
        flags: what was noticed.
    """

    moves: Moves
    measured: Floats
    u: Floats
    peak_s: Floats
    judged: Bools
    plateaus: Plateaus
    noise: StepNoise
    u_scale: float
    flags: tuple[Flag, ...]

    @property
    def error_percent(self) -> Floats:
        """E_s = 100 (Δm − Δc) / Δc, %, shape (n,) (the paper's equation 1)."""
        return np.asarray(100.0 * (self.measured / self.moves.command - 1.0))

    @property
    def position(self) -> Floats:
        """Position on each plateau, a significant drift subtracted, NaN where it is missing, shape (n + 1,)."""
        since_s = self.plateaus.middle_s - self.plateaus.middle_s[0]
        return np.asarray(self.plateaus.mean - self.noise.drift_per_s * since_s)


class _NoOptics:
    """Steps whose optics nobody stated: only noise counts."""

    u_scale = 0.0

    def u_step(self, step: ArrayLike) -> Floats:
        return np.zeros(np.shape(step))


def steps(
    recording: Recording, moves: Moves, still: Standstill | None = None, optics: Optics | None = None
) -> Steps:
    """Measure the steps of a recording.

    Args:
        moves: commanded meanwhile, by the same clock and in the same unit.
        still: a standstill recorded apart; by default the one before the first move, if it lasts 10 s or more.
        optics: what measured; without it, u contains noise and drift only.

    Raises:
        MovesError: the recording does not cover the moves, or the units differ.
        RecordingError: its signal is saturated.
    """
    if recording.unit != moves.unit:
        raise MovesError(
            "the recording holds displacements, the moves are angles: state the spacing of the angular optics, or "
            "use the moves of this recording"
            if recording.unit == "mm"
            else "the recording holds angles, the moves are displacements: leave out the spacing of angular optics "
            "if these were linear, or use the moves of this recording"
        )
    rests = plateaus(recording, moves)
    frozen = frozen_stretch(recording, moves)
    require_unsaturated(frozen)
    # The guard on either side is what the smoothing takes from the ends.
    clip = recording.clipped(
        float(rests.start_s[0]) - GUARD_S,
        float(rests.start_s[-1] + rests.length_s + 1.0 / recording.rate_hz) + GUARD_S,
    )
    speed = speed_of(clip)
    still = still or standstill_before(recording, moves, GUARD_S)
    noise = with_plateau_drift(_noise(clip, speed, rests, moves, still), rests, moves)
    spans_s = np.diff(rests.middle_s)
    measured = np.diff(rests.mean) - noise.drift_per_s * spans_s
    peak_s, hidden = _peaks(clip, speed, moves, noise.velocity)
    seen_by = optics or _NoOptics()
    # A plateau with gaps is known less well, as white noise averages out.
    lost = np.sqrt(0.5 * (rests.loss[:-1] + rests.loss[1:]))
    u = np.hypot(noise.step * lost, np.hypot(noise.u_drift_per_s * spans_s, seen_by.u_step(measured)))
    judged = (np.abs(moves.command) >= BELOW_INSTRUMENT * noise.step) & np.isfinite(measured)
    judged &= ~_with_others(moves, measured, noise.step)
    found = Steps(moves, measured, u, peak_s, judged, rests, noise, seen_by.u_scale, ())
    twice = second_motions(clip, speed, moves, noise)
    behind = motion_behind(recording, float(rests.start_s[-1]) + rests.length_s, noise)
    flags = (*recording.flags, *frozen_flags(frozen), *noise.flags, *_flags(found, hidden, twice), *behind)
    return replace(found, flags=flags)


def _noise(
    clip: Recording, speed: Floats, rests: Plateaus, moves: Moves, still: Standstill | None
) -> StepNoise:
    if still is not None:
        return _with_quantum(noise_of_standstill(still, clip, rests.length_s, moves.dwell_s), clip, rests)
    resting = [
        speed[clip.index(start) : clip.index(start + rests.length_s) - 1] for start in rests.start_s.tolist()
    ]
    return _with_quantum(noise_of_plateaus(rests.half_difference, np.concatenate(resting)), clip, rests)


def _with_quantum(noise: StepNoise, clip: Recording, rests: Plateaus) -> StepNoise:
    """Return noise with what rounding leaves unknown, where the readings scatter too little to average it out."""
    least = DIFFERENCE * clip.quantum
    if noise.step >= least:
        return noise
    resting = (clip.between(start, start + rests.length_s) for start in rests.start_s.tolist())
    if float(np.median([part.std() for part in resting if part.size])) > DITHERED * clip.quantum:
        return noise
    text = (
        f"the counter's step is {shown(clip.quantum, clip.unit)}, and readings scatter by less than half of it: "
        f"a mean is no better than one reading, so u of a step is {shown(least, clip.unit)} or more; record with "
        "a finer resolution"
    )
    return replace(
        noise,
        step=least,
        half_plateau=max(noise.half_plateau, least),
        flags=(*noise.flags, Flag("quantised", text)),
    )


def _peaks(clip: Recording, speed: Floats, moves: Moves, noise: float) -> tuple[Floats, Bools]:
    """Return when each move was fastest in its direction, and which of them a gap may hide.

    The time is NaN where no velocity stands out of the noise.
    """
    edges = np.append(moves.time_s, moves.time_s[-1] + moves.dwell_s) - GUARD_S
    found, hidden = np.full(len(moves), np.nan), np.zeros(len(moves), dtype=np.bool_)
    last = speed.size - half_window(clip.rate_hz)
    for number, direction in enumerate(moves.directions.tolist()):
        first, end = clip.index(float(edges[number])), min(clip.index(float(edges[number + 1])) - 1, last)
        window = direction * speed[first:end]
        known = np.nan_to_num(window, nan=-np.inf)
        fastest = int(np.argmax(known))
        if known[fastest] > SEEN * noise:
            # A velocity belongs to the middle between its two samples.
            found[number] = clip.start_s + (first + fastest + 0.5) / clip.rate_hz
        else:
            hidden[number] = bool(np.isnan(window).any())
    return found, hidden


def _flags(found: Steps, hidden: Bools, twice: Bools) -> list[Flag]:
    moves, noise, rests = found.moves, found.noise, found.plateaus
    command, measured = moves.command, found.measured
    still = np.isnan(found.peak_s) & ~hidden
    seen = SEEN * noise.step
    creeps = np.abs(rests.half_difference[1:] - 0.5 * rests.length_s * noise.drift_per_s)
    unsettled = (creeps > SEEN * noise.half_plateau) & (creeps > _CREEP * np.abs(command))
    with_others = _with_others(moves, measured, noise.step)
    late = found.peak_s > rests.start_s[1:]
    small = np.abs(command) < BELOW_INSTRUMENT * noise.step
    below = f"commanded below {BELOW_INSTRUMENT:g} u = {shown(BELOW_INSTRUMENT * noise.step, moves.unit)} of a step"
    texts: list[tuple[FlagKind, Bools, str]] = [
        *_gap_texts(found, hidden),
        ("below-instrument", small, f"{below}: below the instrument, not judged"),
        ("merged", _merged(found, still), "no motion, but the next step is as large as both"),
        ("no-motion", still & ~_tail(still), "no velocity peak; measured as what the plateaus say"),
        (
            "no-motion",
            still & _tail(still),
            "no motion from here to the end: the joint stood, or fewer steps were driven than commanded",
        ),
        (
            "unexpected-motion",
            with_others,
            "more moved in the long rest behind it than this move: not judged; moves are missing from the list, or "
            "something else moved the joint",
        ),
        (
            "unexpected-motion",
            twice & ~with_others,
            "moved a second time before the next move: its step holds both motions",
        ),
        ("reversed", measured * moves.directions < -seen, "went against its direction"),
        ("late", late, "moved while it should have rested: its plateau holds part of the motion"),
        ("unsettled", unsettled & ~late, "still creeping on the plateau behind it"),
    ]
    return [
        flag for kind, concerned, text in texts for flag in flag_moves(kind, concerned, text, moves.first)
    ]


def _with_others(moves: Moves, measured: Floats, noise: float) -> Bools:
    """Return which moves have a long rest behind them, and a step that is not theirs alone."""
    spans_s = np.append(np.diff(moves.time_s), moves.dwell_s)
    off = np.abs(measured - moves.command)
    far = off > np.maximum(_OFF * np.abs(moves.command), SEEN * noise)
    return np.asarray((spans_s > _LONG * moves.dwell_s) & far)


def _gap_texts(found: Steps, hidden: Bools) -> list[tuple[FlagKind, Bools, str]]:
    """Return what gaps of the recording do to moves: kind, which moves, text."""
    unknown = np.isnan(found.measured)
    loss = np.maximum(found.plateaus.loss[:-1], found.plateaus.loss[1:])
    return [
        ("missed", unknown, "a gap of the recording swallows the plateau before or behind it: not measured"),
        (
            "missed",
            hidden & ~unknown,
            "a gap of the recording may hide its motion; measured as what the plateaus say",
        ),
        (
            "gap",
            (loss > 1.0) & ~unknown,
            "samples are missing on the plateau before or behind it: its u is larger",
        ),
    ]


def _merged(found: Steps, still: Bools) -> Bools:
    """Return which moves show nothing while the next one, in the same direction, shows the sum of both."""
    command, measured = found.moves.command, found.measured
    sums = command[:-1] + command[1:]
    same = command[:-1] * command[1:] > 0.0
    as_both = np.abs(measured[1:] - sums) < _MERGED * np.abs(command[:-1])
    clear = np.abs(command[:-1]) * _MERGED > found.noise.step
    return np.append(still[:-1] & ~still[1:] & same & as_both & clear, False)


def _tail(still: Bools) -> Bools:
    """Return which moves belong to the end of the series in which nothing moves any more."""
    return np.asarray(np.logical_and.accumulate(still[::-1])[::-1])
