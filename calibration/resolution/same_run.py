"""Whether moves are those of a recording: its large steps are as long as commanded, and where they are listed."""

import numpy as np

from catseye.calibration.core.types import Ints
from catseye.calibration.resolution.begin import motion_begin_s
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.scale import likely_mistake
from catseye.calibration.resolution.steps import Steps
from catseye.calibration.resolution.units import shown

_LARGE = 30.0
_LARGEST = 10
_COMPARED = 40
"""Steps that show whether they are those of other moves: ten that scatter by 3 % do not always."""

_FURTHEST = 10
"""Moves away that are looked at."""

_EQUAL = 1e-6
_PLAUSIBLE = (0.5, 1.5)
"""Median ratio of measured to commanded, of the largest steps, in a recording of these moves."""

_SHIFTED = 0.04
"""Steps off by less than this, rms, are not those of another move: the series falls by 7 % a move."""

_ABSENT = 0.5
"""Less than this share of its command is not the step of a move."""

_FEWEST_LEFT = 5

_EARLY_S = 0.4
"""A motion that begins so long before its command reaches the plateau before it; it is seen up to 0.2 s too early."""

_WRONG_TIMES = "the times of the moves do not fit the recording: align the clocks, or correct the times"

_MOST_LATE = 0.1
"""Share of the largest motions that may reach into their plateaus."""


def require_same_run(found: Steps, recording: Recording) -> None:
    """Refuse steps whose largest ones are nothing like what was commanded.

    For tests whose largest steps any joint follows; where all steps are small, a joint may well not follow.

    Args:
        recording: that they come from.

    Raises:
        MovesError: the text says how they differ and what may be wrong.
    """
    _require_unshifted(found, recording)
    large = _largest(found, _LARGE * found.noise.step)
    if large.size:
        _require_plausible(found, recording, large)
    _require_in_time(found, recording)


def require_same_times(found: Steps, recording: Recording) -> None:
    """Refuse steps that were made before their commands or much later, and those of moves some dwells away.

    Args:
        recording: that they come from.

    Raises:
        MovesError: the text says by how much, and what to do.
    """
    _require_unshifted(found, recording)
    _require_in_time(found, recording)


def _largest(found: Steps, least: float = 0.0, count: int = _LARGEST) -> Ints:
    """Return the largest moves beyond a size, by falling size, and all that are as large as they."""
    command = found.moves.command
    large = np.argsort(-np.abs(command), kind="stable")
    large = large[np.isfinite(found.measured[large])]
    large = large[np.abs(command[large]) > least]
    # Equal ones count together: the first ten of a test there and back would not show a shift.
    smallest = np.abs(command[large[:count]]).min(initial=np.inf)
    return np.asarray(large[np.abs(command[large]) >= (1.0 - _EQUAL) * smallest])


def _require_in_time(found: Steps, recording: Recording) -> None:
    """Refuse large steps that were made while the joint should rest: plateaus there are none.

    Small ones count, too: motion on the plateaus would pass for noise, beside which no step is large.
    """
    moves, large = found.moves, _largest(found)
    if not large.size or np.median(found.measured[large] / moves.command[large]) < _PLAUSIBLE[0]:
        return
    begin_s = motion_begin_s(recording, moves)
    if begin_s < -_EARLY_S:
        raise MovesError(
            f"the motions begin about {-begin_s:.1f} s before they were commanded, or "
            f"{moves.dwell_s + begin_s:.1f} s behind the command before: {_WRONG_TIMES}",
            moves.first,
        )
    late = int(np.count_nonzero(found.peak_s[large] > found.plateaus.start_s[1:][large]))
    if late > _MOST_LATE * large.size:
        rest_s = found.plateaus.start_s[1] - moves.time_s[0]
        raise MovesError(
            f"{late} of the {large.size} largest motions lie behind {rest_s:.1f} s of their dwell, where the joint "
            f"should rest: the dwell is too short for this speed, or {_WRONG_TIMES}",
            moves.first,
        )


def _require_plausible(found: Steps, recording: Recording, large: Ints) -> None:
    command = found.moves.command
    ratio = float(np.median(found.measured[large] / command[large]))
    if _PLAUSIBLE[0] <= ratio <= _PLAUSIBLE[1]:
        return
    if not np.ptp(recording.position):
        likely = (
            "the signal does not change by its last digit in the whole recording: it is saturated, or the beam was "
            "lost; align the optics, and measure again"
        )
    elif -_PLAUSIBLE[1] <= ratio <= -_PLAUSIBLE[0]:
        likely = "the direction is reversed: take the moves of this recording, or change its sign"
    elif mistake := likely_mistake(ratio):
        likely = f"{mistake.text}; correct it and evaluate again"
    else:
        likely = (
            "these are moves of another run or joint, the clocks differ (align them), or spacing or unit are "
            "wrong"
        )
    raise MovesError(
        f"the {large.size} largest moves show {ratio:.3g} of what was commanded, in the median ("
        f"{shown(float(np.abs(command[large]).max()), found.moves.unit)} and less): {likely}",
        found.moves.first + int(large[0]),
    )


def _require_unshifted(found: Steps, recording: Recording) -> None:
    """Refuse steps that are those of moves some dwells earlier or later."""
    large = _largest(found, _LARGE * found.noise.step, _COMPARED)
    command, measured = found.moves.command, found.measured

    def near(shift: int) -> Ints:
        return large[(large - shift >= 0) & (large - shift < command.size)]

    def misfit(of: Ints, shift: int) -> float:
        """Return the rms relative error if each of some steps were that of another move."""
        return float(np.sqrt(np.mean((measured[of] / command[of - shift] - 1.0) ** 2)))

    furthest = min(_FURTHEST, large.size - _FEWEST_LEFT)
    shifts = [shift for size in range(1, furthest + 1) for shift in (size, -size)]
    if not shifts:
        return
    best = min(shifts, key=lambda shift: misfit(near(shift), shift))
    as_commanded = misfit(near(best), 0)
    if as_commanded < _SHIFTED or misfit(near(best), best) > 0.5 * as_commanded:
        return
    if not _begins_shifted(found, recording, best):
        return
    raise MovesError(
        f"the largest steps are those commanded {abs(best)} moves {'earlier' if best > 0 else 'later'}: the "
        f"recording's clock is {'ahead' if best > 0 else 'behind'} by about {abs(best) * found.moves.dwell_s:.3g} s "
        "(align the clocks), these are moves of another run, or spacing or unit are wrong",
        found.moves.first + int(large[0]),
    )


def _begins_shifted(found: Steps, recording: Recording, shift: int) -> bool:
    """Return whether the first moves are missing where they are listed, or were made before that.

    An error that all steps share makes them as large as those of other moves, too; but then they begin in time.
    """
    moves, rests = found.moves, found.plateaus
    if shift > 0:
        made = np.abs(found.measured[:shift]) >= _ABSENT * np.abs(moves.command[:shift])
        return not made.all()
    start_s = float(rests.start_s[0]) + shift * moves.dwell_s
    before = recording.between(start_s, start_s + rests.length_s)
    if not before.size:
        return True
    moved = float(rests.mean[0] - before.mean())
    return moved / float(moves.command[:-shift].sum()) > _ABSENT
