"""The test of ISO 230 with three sequences of ten equal steps: forth, back, forth; repeated with growing steps.

The resolution paper, section 3.3. A step is distinguishable here if it goes the right way by three standard
uncertainties of a step or more, beside what a reader of the staircase says. Steps after a reversal have play and
torsion to take up first, so they mask what the joint resolves.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from catseye.calibration.core.types import Bools, Ints
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.flags import Flag, flag_moves
from catseye.calibration.resolution.scale import is_scaled, scale_text
from catseye.calibration.resolution.steps import Steps
from catseye.calibration.resolution.units import shown

DISTINGUISHABLE = 3.0
"""Standard uncertainties of a step that one has to exceed; chance alone does so in 0.14 % of steps."""

_EQUAL = 1e-6
_BACKWARD = -0.5
_SEQUENCES = 3


@dataclass(frozen=True)
class IsoAmplitude:
    """Result of the sequences with steps of one size.

    Attributes:
        steps: what was measured.
        amplitude: size of the commanded steps.
        sequence: number of the sequence that each move belongs to, from 0, shape (n,).
        distinguishable: for each move, shape (n,).
        masked: moves at the begin of a sequence after a reversal that are not distinguishable, shape (n,).
        unknown: moves that a gap of the recording swallows, shape (n,).
        flags: of the steps and of the result.
    """

    steps: Steps
    amplitude: float
    sequence: Ints
    distinguishable: Bools
    masked: Bools
    unknown: Bools
    flags: tuple[Flag, ...]

    @property
    def passed(self) -> bool:
        """Every step that was measured is distinguishable."""
        return bool((self.distinguishable | self.unknown).all())

    @property
    def passed_between_reversals(self) -> bool:
        """Every step is distinguishable that does not follow a reversal, and some in every sequence are."""
        in_each = [bool(self.distinguishable[self.sequence == k].any()) for k in range(_SEQUENCES)]
        return bool((self.distinguishable | self.masked | self.unknown).all()) and all(in_each)


@dataclass(frozen=True)
class IsoTest:
    """Result of the test over all sizes.

    Attributes:
        amplitudes: by growing size.
        least_step: smallest size from which on all steps of all sizes are distinguishable; None where those of the
            largest are not.
        not_below: largest size of which some were not; 0 where there is none.
        between_reversals: the least step if those masked by a reversal are left out; None likewise.
        flags: of the result.
    """

    amplitudes: tuple[IsoAmplitude, ...]
    least_step: float | None
    not_below: float
    between_reversals: float | None
    flags: tuple[Flag, ...]


def iso_amplitude(steps: Steps) -> IsoAmplitude:
    """Judge the steps of three sequences.

    Raises:
        MovesError: the steps are not of one size, do not go forth, back and forth, are more or fewer in one sequence
            than in another, or go the other way than commanded.
    """
    amplitude = steps.moves.equal_size()
    sequence = np.concatenate([[0], np.cumsum(np.diff(steps.moves.directions) != 0)]).astype(np.int64)
    if sequence[-1] != _SEQUENCES - 1:
        raise MovesError(
            f"the moves make {sequence[-1] + 1} sequences: the test has {_SEQUENCES}, forth, back and forth; are "
            "there fewer moves than the test has, or those of another run?",
            steps.moves.first,
        )
    _require_equal_lengths(steps, sequence)
    forward = steps.measured * steps.moves.directions
    if float(np.nanmedian(forward)) < _BACKWARD * amplitude:
        raise MovesError(
            "the steps go the other way than commanded: change the sign of the recording, or these are other moves",
            steps.moves.first,
        )
    good, unknown = forward > DISTINGUISHABLE * steps.u, np.isnan(forward)
    masked = _masked(sequence, good) & ~unknown
    text = "not distinguishable after a reversal: play and torsion are taken up there"
    flags = (*steps.flags, *flag_moves("masked-by-reversal", masked, text, steps.moves.first))
    return IsoAmplitude(steps, amplitude, sequence, good, masked, unknown, flags)


def iso_test(amplitudes: Sequence[IsoAmplitude]) -> IsoTest:
    """Return the least step over the sizes that were tested.

    Raises:
        MovesError: no size, or one twice.
    """
    if not amplitudes:
        raise MovesError("no size of steps was tested: test one or more")
    ordered = sorted(amplitudes, key=lambda one: one.amplitude)
    sizes = [one.amplitude for one in ordered]
    twice = [a for a, b in pairwise(sizes) if b - a <= _EQUAL * b]
    if twice:
        unit = ordered[0].steps.moves.unit
        raise MovesError(f"steps of {shown(twice[0], unit)} were tested twice: leave one of the tests out")
    passed = [one.passed for one in ordered]
    between = [one.passed_between_reversals for one in ordered]
    failed = [size for size, good in zip(sizes, passed, strict=True) if not good]
    least, unmasked = _smallest_of_all_larger(sizes, passed), _smallest_of_all_larger(sizes, between)
    flags = (*_scale_flags(ordered[-1]), *_flags(ordered[0].steps, least, unmasked, sizes))
    return IsoTest(tuple(ordered), least, max(failed, default=0.0), unmasked, flags)


def _require_equal_lengths(steps: Steps, sequence: Ints) -> None:
    counts = np.bincount(sequence)
    if (counts == counts.max()).all():
        return
    short = int(np.argmin(counts))
    last = int(np.flatnonzero(sequence == short)[-1])
    raise MovesError(
        f"the sequences of {shown(abs(float(steps.moves.command[0])), steps.moves.unit)} have "
        f"{', '.join(map(str, counts.tolist()))} moves, the last of the shortest one being move "
        f"{last + steps.moves.first}: the test has as many in each; complete the list of moves, or measure again",
        last + steps.moves.first,
    )


def _scale_flags(largest: IsoAmplitude) -> list[Flag]:
    """Return a flag where steps of the largest size follow, and are all longer or shorter than commanded."""
    steps = largest.steps
    # What play and torsion take is missing from the step behind a reversal.
    following = np.append(False, np.diff(largest.sequence) == 0) & ~(largest.masked | largest.unknown)
    if not (largest.passed_between_reversals and following.any()):
        return []
    ratio = float(np.median((steps.measured / steps.moves.command)[following]))
    if not is_scaled(ratio):
        return []
    text = (
        f"the steps of {shown(largest.amplitude, steps.moves.unit)} that follow no reversal are {ratio:.3g} times "
        f"those commanded, in the median: {scale_text(ratio)}, or go on with larger steps if the joint does not "
        "follow these"
    )
    return [Flag("scale", text)]


def _masked(sequence: Ints, good: Bools) -> Bools:
    """Return the moves from a reversal up to the first one that is distinguishable."""
    masked = np.zeros(good.size, dtype=np.bool_)
    for number in range(1, _SEQUENCES):
        own = np.flatnonzero(sequence == number)
        masked[own] = ~np.logical_or.accumulate(good[own])
    return masked


def _smallest_of_all_larger(sizes: Sequence[float], passed: Sequence[bool]) -> float | None:
    least = None
    for size, good in zip(reversed(sizes), reversed(passed), strict=True):
        if not good:
            break
        least = size
    return least


def _flags(steps: Steps, least: float | None, unmasked: float | None, sizes: Sequence[float]) -> list[Flag]:
    unit = steps.moves.unit
    if least is None:
        text = f"not even all steps of {shown(sizes[-1], unit)} are distinguishable: go on with larger ones"
        return [Flag("least-step-open", text)]
    if least == sizes[0]:
        text = f"all steps of the smallest size, {shown(least, unit)}, are distinguishable: at most that"
        return [Flag("least-step-open", text)]
    if unmasked is not None and unmasked < least:
        text = (
            f"reversals mask the resolution: without the steps behind them, all from {shown(unmasked, unit)} on are "
            "distinguishable"
        )
        return [Flag("masked-by-reversal", text)]
    return []
