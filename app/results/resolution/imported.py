"""Tests that another program recorded, from their files to a result."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

from catseye.app.cell.arm import ArmDescription, arm_description
from catseye.app.errors import ConfigError, UsageError
from catseye.app.results.origin import now_utc
from catseye.app.results.provenance import Provenance
from catseye.app.results.resolution.actuation import actuation_of
from catseye.app.results.resolution.evaluation import Asked, Series, evaluated
from catseye.app.results.resolution.input_files import (
    MovesFile,
    RecordingFile,
    read_moves,
    read_recording,
    refused_recording,
    require_recording,
)
from catseye.app.results.resolution.result import (
    AngularTest,
    AnyTest,
    Clocks,
    LinearTest,
    ResolutionResult,
)
from catseye.app.results.resolution.target_reversal import DeviationUnit, is_target_file, reversal_of_targets
from catseye.app.results.resolution.torque_file import read_torque
from catseye.app.store.software import SOFTWARE
from catseye.calibration.resolution.alignment import ClockAlignment, align
from catseye.calibration.resolution.errors import ClockError, MovesError, RecordingError
from catseye.calibration.resolution.noise import standstill_before
from catseye.calibration.resolution.optics import AngularOptics, LinearOptics, Optics
from catseye.calibration.resolution.plateaus import GUARD_S
from catseye.calibration.resolution.recording import Recording
from catseye.procedures.kit.expanded import expanded_text

_AXES = ("X", "Y", "Z")
_OF_TARGETS = "from deviations at targets: nothing is known of single steps and of the motor's torque"
_ONE_PAIR = (
    "a direction has one run: nothing was repeated, so u of the reversal error is not known; measure two pairs of "
    "runs or more, the standard test has five"
)
_NO_OPTICS = (
    "u without the instrument: the recording holds angles without a stated accuracy; u contains noise and drift "
    "only, and the interval of the least step no scale error: state --accuracy-percent and --accuracy-urad, or "
    "give the displacements with --spacing-mm of angular optics"
)


@dataclass(frozen=True)
class Import:
    """A test in files.

    Attributes:
        recording: of the laser, or target deviations.
        asked: which test of what.
        moves: commanded meanwhile; None with target deviations.
        joint_torque: of the motor; None for none.
        torque_channel: of a trace with several torques.
        align: find offset and drift of the two clocks.
        deviation_unit: of the deviations of a `.rta`.
    """

    recording: RecordingFile
    asked: Asked
    moves: Path | None = None
    joint_torque: Path | None = None
    torque_channel: str | None = None
    align: bool = False
    deviation_unit: DeviationUnit | None = None


def named_arm(arm: str, asked: Asked) -> ArmDescription:
    """Return the description of an arm that has the joint that was asked for.

    Raises:
        UsageError: there is no such arm, it has no such joint, or the joint does not reach the position.
    """
    try:
        found = arm_description(arm)
    except (ConfigError, ValueError) as error:
        raise UsageError(f"--arm {arm}: {error}") from error
    joints = _AXES if asked.test == "cartesian" else tuple(joint.name for joint in found.joint)
    if asked.joint not in joints:
        raise UsageError(
            f"--joint {asked.joint}: a {asked.test} test of {found.name} is of {', '.join(joints)}"
        )
    _require_in_range(found, asked)
    return found


def _require_in_range(arm: ArmDescription, asked: Asked) -> None:
    of = next((joint for joint in arm.joint if joint.name == asked.joint), None)
    if of is None or asked.position is None:
        return
    low, high = of.range
    if not low <= asked.position <= high:
        raise UsageError(
            f"--position-deg {asked.position:g}: {of.name} of {arm.name} moves from {low:g} to {high:g} {of.unit}: "
            "state where it stood"
        )


def _place_name(arm: ArmDescription, asked: Asked) -> str | None:
    """Return what the arm's description calls the position, K1 … K5; None where it is none of its test places."""
    of = next((joint for joint in arm.joint if joint.name == asked.joint), None)
    if of is None or of.type != "revolute" or asked.position is None:
        return None
    places = enumerate(of.test_places_deg or (), 1)
    return next((f"K{number}" for number, at in places if math.isclose(at, asked.position)), None)


def _require_unit(arm: ArmDescription, given: Import, unit: str) -> None:
    """Refuse lengths of a joint that turns, and angles of what slides: no reader of the result would take them."""
    asked = given.asked
    of = next((joint for joint in arm.joint if joint.name == asked.joint), None)
    wanted = "mm" if asked.test == "cartesian" or of is None else of.unit
    if unit == wanted:
        return
    remedy = (
        "state the spacing of the angular optics by --spacing-mm, and moves in command_deg"
        if wanted == "deg"
        else "leave out --spacing-mm, and give displacement_mm and moves in command_mm"
    )
    raise UsageError(
        f"{given.recording.path}: is in {unit}, and a {asked.test} test of {asked.joint} in {wanted}: {remedy}"
    )


def imported_result(given: Import, arm: str) -> ResolutionResult:
    """Return the result of a test in files.

    Args:
        given: the test.
        arm: name of a shipped arm, or path of its description.

    Raises:
        UsageError: as for `imported_test`, the arm has no such joint at such a position, or the unit is not its own.
        CalibrationError: recording and moves do not fit.
    """
    description = named_arm(arm, given.asked)
    asked = replace(given.asked, position_name=_place_name(description, given.asked))
    test = imported_test(replace(given, asked=asked))
    _require_unit(description, given, test.unit)
    return ResolutionResult(
        arm=description.name,
        actuation=actuation_of(description),
        tests=[test],
        provenance=Provenance(runs=[given.recording.path.name], software=SOFTWARE, created=now_utc()),
    )


def imported_test(given: Import) -> AnyTest:
    """Return what a test in files comes to.

    Raises:
        UsageError: a file cannot be used, or they do not belong together; names line and remedy.
        CalibrationError: recording and moves do not fit, or their clocks cannot be aligned without doubt.
    """
    if is_target_file(given.recording.path) and given.asked.test == "backlash":
        return _of_targets(given)
    require_recording(given.recording.path)
    if given.moves is None:
        raise UsageError(
            f"{given.recording.path}: --moves is missing: when each move was commanded, and its size"
        )
    recording = read_recording(given.recording)
    file = read_moves(given.moves, there_and_back=given.asked.test in {"iso", "backlash"})
    try:
        return _evaluated(given, recording, file)
    except MovesError as error:
        raise MovesError(f"{file.place(error.row)}: {error}", error.row) from error
    except RecordingError as error:
        raise refused_recording(given.recording, error) from error
    except ClockError as error:
        raise ClockError(f"{given.recording.path} with {file.path}: {error}") from error


def _evaluated(given: Import, recording: Recording, file: MovesFile) -> AnyTest:
    optics = _optics(given.recording, recording)
    test = _by_clocks(given, recording, file, optics)
    if optics is None:
        doubts = [_NO_OPTICS, *test.doubts]
        return test.model_copy(update={"flags": [_NO_OPTICS, *test.flags], "doubts": doubts})
    if given.recording.zero_is_stated or not isinstance(optics, AngularOptics) or not optics.u_zero_rad:
        return test
    return test.model_copy(update={"flags": [*test.flags, _assumed_zero(optics)]})


def _assumed_zero(optics: AngularOptics) -> str:
    return (
        f"the optics are taken as parallel where the displacement is 0, u = {math.degrees(optics.u_zero_rad):g}°: "
        f"{100.0 * optics.u_zero_share:.2g} % of each step in its u; if you know it, state --u-zero-deg, and "
        "--zero-deg of a recording of displacements"
    )


def _optics(file: RecordingFile, recording: Recording) -> Optics | None:
    if recording.unit == "mm":
        return LinearOptics()
    if file.optics is None or file.accuracy is not None:
        return file.accuracy
    return file.optics.over(recording.position)


def _by_clocks(given: Import, recording: Recording, file: MovesFile, optics: Optics | None) -> AnyTest:
    clocks = align(recording, file.all_moves) if given.align else None
    moves, every = (one if clocks is None else clocks.moves(one) for one in (file.moves, file.all_moves))
    # What leads to the beginning of the test moves the joint behind its standstill.
    series = Series(recording, moves, optics, standstill_before(recording, every, GUARD_S))
    if given.joint_torque is not None:
        torque = read_torque(given.joint_torque, given.torque_channel)
        torque_s = torque["t_s"] if clocks is None else clocks.times_s(torque["t_s"])
        series = replace(series, torque_s=torque_s, torque_nm=torque["torque_nm"])
    test = evaluated(given.asked, [series])
    if clocks is None:
        return test
    stated = _clocks(clocks)
    return test.model_copy(update={"clocks": stated, "flags": [_clocks_text(stated), *test.flags]})


def _clocks(found: ClockAlignment) -> Clocks:
    return Clocks(
        offset_s=found.offset_s,
        u_offset_s=found.u_offset_s,
        about_s=found.about_s,
        drift_ppm=1e6 * found.drift,
        u_drift_ppm=1e6 * found.u_drift,
        peaks=found.peaks,
    )


def _clocks_text(clocks: Clocks) -> str:
    return (
        f"the recording's clock is {expanded_text(abs(clocks.offset_s), clocks.u_offset_s, 2)} s "
        f"{'behind' if clocks.offset_s < 0.0 else 'ahead of'} that of the moves at "
        f"{clocks.about_s:.0f} s of theirs, the delay between command and motion included, and gains "
        f"{expanded_text(clocks.drift_ppm, clocks.u_drift_ppm, 0)} ppm (k = 2, from {clocks.peaks} steps): the "
        "moves were aligned to it"
    )


def _without_effect(given: Import) -> list[str]:
    """Return a text on options that say something of a recording, which a file of target deviations is not."""
    file = given.recording
    stated = {
        "--moves": given.moves,
        "--spacing-mm": file.optics,
        "--accuracy-urad or --accuracy-percent": file.accuracy,
        "--mapping": file.mapping,
        "--rate-hz": file.rate_hz,
        "--joint-torque": given.joint_torque,
        "--align auto": given.align or None,
    }
    needless = [option for option, value in stated.items() if value is not None]
    return [f"{', '.join(needless)}: without effect on deviations at targets"] if needless else []


def _of_targets(given: Import) -> AnyTest:
    needless = _without_effect(given)
    unit, reversal, targets = reversal_of_targets(given.recording.path, given.deviation_unit)
    kind = AngularTest if unit == "deg" else LinearTest
    asked = given.asked
    return kind.model_validate(
        {
            "test": asked.test,
            "joint": asked.joint,
            "position": asked.position,
            "position_name": asked.position_name,
            "threshold_percent": asked.threshold_percent,
            "moves": [],
            "reversal": reversal,
            "targets": targets,
            "flags": [_OF_TARGETS, *((_ONE_PAIR,) if reversal.u is None else ()), *needless],
            "doubts": needless,
        }
    )
