"""One test, from its recordings and moves to what a result file says of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from catseye.app.results.resolution.result import AngularTest, AnyTest, LinearTest, Test
from catseye.app.results.resolution.step_parts import duration_s, move_rows, outside, staircase, unit_of
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.moves import Moves
from catseye.calibration.resolution.optics import Optics
from catseye.calibration.resolution.recording import Recording
from catseye.calibration.resolution.standstill import Standstill
from catseye.calibration.resolution.steps import Steps, require_same_run, steps


@dataclass(frozen=True)
class Asked:
    """Which test of what.

    Attributes:
        test: which one.
        joint: of the arm; X, Y or Z of a Cartesian test.
        position: of the joint, deg or mm; None where nobody says.
        pose: name of the pose of a Cartesian test.
        threshold_percent: largest step error of a step that counts.
    """

    test: Test
    joint: str
    position: float | None = None
    pose: str | None = None
    threshold_percent: float = 10.0


@dataclass(frozen=True)
class Series:
    """Moves that were recorded in one go.

    Attributes:
        recording: rad or mm.
        moves: by the clock of the recording, in its unit.
        optics: what measured; None where nobody says.
        still: a standstill recorded apart; None for the one before the first move.
    """

    recording: Recording
    moves: Moves
    optics: Optics | None = None
    still: Standstill | None = None
