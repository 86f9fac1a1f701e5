"""One test, from its recordings and moves to what a result file says of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from catseye.app.results.resolution.result import (
    AngularTest,
    AnyTest,
    LeastStep,
    LikelyMistake,
    LinearTest,
    Reversal,
    Test,
    Torque,
)
from catseye.app.results.resolution.step_parts import (
    duration_s,
    move_rows,
    or_none,
    outside,
    staircase,
    unit_of,
)
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.backlash import backlash
from catseye.calibration.resolution.decaying import decaying_test
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.flags import Flag, doubts
from catseye.calibration.resolution.iso import IsoTest, iso_amplitude, iso_test
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.noise import standstill_before
from catseye.calibration.resolution.optics import Optics
from catseye.calibration.resolution.plateaus import GUARD_S
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.same_run import require_same_run, require_same_times
from catseye.calibration.resolution.series_ratio import ratio_flags
from catseye.calibration.resolution.standstill import Standstill
from catseye.calibration.resolution.steps import Steps, steps
from catseye.calibration.resolution.units import shown

_EQUAL = 1e-6
"""Steps of one size differ by less, relative."""


@dataclass(frozen=True)
class Asked:
    """Which test of what.

    Attributes:
        test: which one.
        joint: of the arm; X, Y or Z of a Cartesian test.
        position: of the joint, deg or mm; None where nobody says.
        pose: name of the pose of a Cartesian test.
        threshold_percent: largest step error of a step that counts.
        position_name: what the run or the arm's description calls the position; None where nobody named it.
    """

    test: Test
    joint: str
    position: float | None = None
    pose: str | None = None
    threshold_percent: float = 10.0
    position_name: str | None = None


@dataclass(frozen=True)
class Series:
    """Moves that were recorded in one go.

    Attributes:
        recording: rad or mm.
        moves: by the clock of the recording, in its unit.
        optics: what measured; None where nobody says.
        still: a standstill recorded apart; None for the one before the first move.
        torque_s: times of the motor torque by the same clock, s, shape (k,); None where none was recorded.
        torque_nm: motor torque, N m, shape (k,).
    """

    recording: Recording
    moves: Moves
    optics: Optics | None = None
    still: Standstill | None = None
    torque_s: Floats | None = None
    torque_nm: Floats | None = None
    confirmed: bool = False

    def steps(self) -> Steps:
        """Return the steps of all moves."""
        return steps(self.recording, self.moves, self.still, self.optics)


def evaluated(asked: Asked, series: Sequence[Series]) -> AnyTest:
    """Return what a test comes to.

    Args:
        asked: which test of what.
        series: one; of a test by ISO 230 any number, each with one or several sizes of steps.

    Raises:
        CalibrationError: recording and moves do not fit, or the moves are not those of the test.
    """
    if asked.test == "iso":
        return _iso(asked, series)
    if len(series) != 1:
        raise MovesError(
            f"a {asked.test} test is one series, here are {len(series)}: evaluate each by itself"
        )
    found = series[0].steps()
    require_same_run(found, series[0].recording)
    if asked.test == "backlash":
        return _backlash(asked, series[0], found)
    return _decaying(asked, series[0], found)


def _decaying(asked: Asked, series: Series, found: Steps) -> AnyTest:
    judged = decaying_test(found, asked.threshold_percent)
    flags = (*ratio_flags(found, confirmed=series.confirmed), *judged.flags)
    if judged.stopped_at is not None and not series.confirmed:
        raise _ended(found, judged.stopped_at)
    scale, least = outside(found.moves.unit), judged.least_step
    rows = [
        row | {"mean_percent": or_none(mean), "std_percent": or_none(spread)}
        for row, mean, spread in zip(
            move_rows(found), judged.mean_percent.tolist(), judged.spread_percent.tolist(), strict=True
        )
    ]
    lis = None
    if least is not None:
        value, u, low, high = (scale * one for one in (least.value, least.u, least.low, least.high))
        lis = LeastStep(value=value, u=u, low=low, high=high)
    return _test(
        asked,
        found,
        direction=int(found.moves.directions[0]),
        moves=rows,
        lis=lis,
        lis_reason=_reason(flags) if lis is None else None,
        by_rule=None if judged.by_rule is None else scale * judged.by_rule,
        likely_mistake=None
        if (mistake := judged.mistake) is None
        else LikelyMistake(factor=mistake.factor, text=mistake.text),
        staircase=staircase(series.recording, found),
        duration_s=duration_s(found),
        flags=_texts(flags),
        doubts=_texts(doubts(flags, _from(found, 0.0 if least is None else least.value))),
    )


def _ended(found: Steps, number: int) -> MovesError:
    """Return what is wrong with moves whose last ones show nothing, from a number on: nobody knows who stood."""
    moves = found.moves
    first, last = (shown(abs(float(moves.command[k])), moves.unit) for k in (number - moves.first, -1))
    return MovesError(
        f"from move {number} of {len(moves)} on ({first} … {last}) nothing moves, and all larger steps were made: "
        "fewer steps were driven than commanded, or the joint no longer follows; the recording cannot tell "
        f"which. Leave out the moves from {number} on to judge the others",
        number,
    )


def _backlash(asked: Asked, series: Series, found: Steps) -> AnyTest:
    judged = backlash(found, series.torque_s, series.torque_nm)
    scale, torque = outside(found.moves.unit), judged.torque
    targets = zip((scale * judged.place).tolist(), (scale * judged.reversal).tolist(), strict=True)
    return _test(
        asked,
        found,
        moves=move_rows(found),
        reversal=Reversal(value=scale * judged.lost_motion, u=scale * judged.u, valid=judged.valid),
        targets=[{"position": place, "reversal": lost} for place, lost in targets],
        torque=None
        if torque is None
        else Torque(forward_nm=torque.forward_nm, backward_nm=torque.backward_nm),
        staircase=staircase(series.recording, found),
        duration_s=duration_s(found),
        flags=_texts(judged.flags),
        doubts=_texts(doubts(judged.flags, _from(found, 0.0))),
    )


def _iso(asked: Asked, series: Sequence[Series]) -> AnyTest:
    parts = [part for one in series for part in _by_size(one)]
    amplitudes = [iso_amplitude(part.steps()) for part in parts]
    largest = max(range(len(parts)), key=lambda number: amplitudes[number].amplitude)
    # Play may swallow steps of the largest size, too; then they are not as long as commanded.
    require = require_same_run if amplitudes[largest].passed_between_reversals else require_same_times
    require(amplitudes[largest].steps, parts[largest].recording)
    judged = iso_test(amplitudes)
    # What is drawn shows the least step; without one, the largest.
    wanted = judged.least_step or judged.amplitudes[-1].amplitude
    drawn = next(number for number, one in enumerate(amplitudes) if one.amplitude == wanted)
    scale = outside(parts[0].moves.unit)
    least = math.inf if judged.least_step is None else judged.least_step
    doubtful = [flag for one in judged.amplitudes for flag in doubts(one.flags, _from(one.steps, least))]
    return _test(
        asked,
        amplitudes[drawn].steps,
        moves=[row for one in judged.amplitudes for row in move_rows(one.steps)],
        lis=_iso_least_step(judged, scale),
        lis_reason=_reason(judged.flags) if judged.least_step is None else None,
        amplitudes=[
            {"command": scale * one.amplitude, "distinguishable": one.passed} for one in judged.amplitudes
        ],
        staircase=staircase(parts[drawn].recording, amplitudes[drawn].steps),
        duration_s=sum(duration_s(one.steps) for one in judged.amplitudes),
        flags=_texts([*(flag for one in judged.amplitudes for flag in one.flags), *judged.flags]),
        doubts=_texts([*doubtful, *doubts(judged.flags, ())]),
    )


_FEWEST_OF_A_SIZE = 2
"""A rest lies between two moves."""


def _by_size(series: Series) -> list[Series]:
    """Return a series by the sizes of its steps, with the noise that was recorded before the first of them.

    Raises:
        MovesError: there is a single move of a size.
    """
    moves = series.moves
    size = np.abs(moves.command)
    begins = np.flatnonzero(np.abs(np.diff(size)) > _EQUAL * size[1:]) + 1
    if not begins.size:
        return [series]
    counts = np.diff([0, *begins.tolist(), len(moves)])
    if (counts < _FEWEST_OF_A_SIZE).any():
        alone = int(np.argmax(counts < _FEWEST_OF_A_SIZE))
        number = moves.first + int([0, *begins.tolist()][alone])
        raise MovesError(
            f"move {number} is the only one of its size: a test by ISO 230 has three sequences of equal steps of "
            "each size; are these the moves of another test, or is one of them wrong?",
            number,
        )
    still = series.still or standstill_before(series.recording, moves, GUARD_S)
    ends = [*begins.tolist(), len(moves)]
    # What the next size moves is no motion behind the last move of this one.
    recording = series.recording
    until_s = [*moves.time_s[begins].tolist(), recording.end_s + 1.0]
    return [
        replace(
            series,
            recording=recording.clipped(recording.start_s, end_s),
            moves=moves.part(first, end),
            still=still,
        )
        for first, end, end_s in zip([0, *begins.tolist()], ends, until_s, strict=True)
    ]


def _iso_least_step(judged: IsoTest, scale: float) -> LeastStep | None:
    """Return the least step; it lies anywhere between it and the largest size that failed."""
    if judged.least_step is None:
        return None
    low, high = scale * judged.not_below, scale * judged.least_step
    # The standard deviation of a uniform distribution (GUM 4.3.7).
    return LeastStep(value=high, u=(high - low) / math.sqrt(12.0), low=low, high=high)


def _test(asked: Asked, found: Steps, **parts: Any) -> AnyTest:
    kind = AngularTest if unit_of(found.moves.unit) == "deg" else LinearTest
    return kind.model_validate(
        {
            "test": asked.test,
            "joint": asked.joint,
            "position": asked.position,
            "position_name": asked.position_name,
            "pose": asked.pose,
            "threshold_percent": asked.threshold_percent,
            **parts,
        }
    )


def _from(found: Steps, least: float) -> list[int]:
    """Return the numbers of the moves that are no smaller than a least step."""
    return (np.flatnonzero(np.abs(found.moves.command) >= least) + found.moves.first).tolist()


def _reason(flags: Sequence[Flag]) -> str | None:
    """Return why a test without a least step has none."""
    return next((flag.text for flag in flags if flag.kind == "least-step-open"), None)


def _texts(flags: Sequence[Flag]) -> list[str]:
    """Return what was noticed, each once."""
    return list(dict.fromkeys(flag.text for flag in flags))
