"""What tests of motion resolution keep beside the recordings themselves."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from catseye.procedures.kit.records import Record

Test = Literal["decaying", "iso", "backlash", "cartesian"]
"""Decaying steps one way; equal steps there, back and there; equal steps there and back, five times; steps of the
tool."""


@dataclass(frozen=True, kw_only=True)
class Configuration(Record):
    """One series at one place: what was stepped, and how its recording is read.

    Attributes:
        recording: name of its recording in the same step; earlier ones of the step were cut short.
        test: which test.
        joint: axis that was stepped, or X, Y, Z of the base frame.
        position: name of the place.
        position_value: of the axis there, deg or mm; None for a straight series.
        direction: 1 or -1; of a test that goes both ways that of its first sequence.
        unit: of steps and position: deg or mm.
        amplitude: of equal steps, in that unit; None for a series that decays.
        absolute: 1 when each step was commanded as a pose, 0 when it was added to the measured position.
        standstill_from_s: the arm stood from here, s since the recording's origin.
        standstill_until_s: until here; the moves follow.
        dwell_s: standstill after each move.
        spacing_mm: baseline of the angular optics; None for linear optics, whose displacement is the length itself.
        u_spacing_mm: its standard uncertainty.
        distance_mm: between interferometer and retroreflector.
        moves: how many were commanded.
    """

    table: ClassVar[str] = "configurations"
    recording: str
    test: str
    joint: str
    position: str
    position_value: float | None = None
    direction: int
    unit: str
    amplitude: float | None = None
    absolute: int
    standstill_from_s: float
    standstill_until_s: float
    dwell_s: float
    spacing_mm: float | None = None
    u_spacing_mm: float | None = None
    distance_mm: float
    moves: int


@dataclass(frozen=True, kw_only=True)
class Move(Record):
    """One commanded move of a series. Whole poses stand in `extra`, as `before` and `after`.

    Attributes:
        recording: name of the recording in the same step.
        joint: axis that was stepped, or X, Y, Z of the base frame.
        number: within the recording, from 1.
        sequence: of a test that goes there and back; 0 for moves that only lead to its beginning.
        command: signed size, deg or mm.
        time_s: when it was sent, s since the recording's origin.
        ended_s: when the controller said that it was over.
        measured_before: the axis as the controller reported it just before; None for a straight step.
        measured_after: the same after the move.
        torque_nm: of the axis' motor behind the dwell; None where the controller states none.
        torque_s: when it was read, s since the recording's origin; None without it, or where nobody noted it.
    """

    table: ClassVar[str] = "moves"
    is_point: ClassVar[bool] = True
    point_name: ClassVar[str] = "move"
    target_column: ClassVar[str] = "joint"
    recording: str
    joint: str
    number: int
    sequence: int
    command: float
    time_s: float
    ended_s: float
    measured_before: float | None = None
    measured_after: float | None = None
    torque_nm: float | None = None
    torque_s: float | None = None
