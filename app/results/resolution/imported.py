"""Tests that another program recorded, from their files to a result."""

from dataclasses import dataclass
from pathlib import Path

from catseye.app.cell.arm import ArmDescription, arm_description
from catseye.app.errors import ConfigError, UsageError
from catseye.app.results.resolution.evaluation import Asked, evaluated
from catseye.app.results.resolution.input_files import RecordingFile, read_moves, read_recording
from catseye.app.results.resolution.result import AngularTest, AnyTest, LinearTest
from catseye.app.results.resolution.target_reversal import DeviationUnit, is_target_file, reversal_of_targets
from catseye.app.results.resolution.torque_file import read_torque

_AXES = ("X", "Y", "Z")


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
        UsageError: there is no such arm, or it has no such joint.
    """
    try:
        found = arm_description(arm)
    except (ConfigError, ValueError) as error:
        raise UsageError(f"--arm {arm}: {error}") from error
    joints = _AXES if asked.test == "cartesian" else tuple(joint.name for joint in found.joint)
    if asked.joint not in joints:
        raise UsageError(f"--joint {asked.joint}: a {asked.test} test of {found.name} is of {', '.join(joints)}")
    return found


def imported_test(given: Import) -> AnyTest:
    """Return what a test in files comes to.

    Raises:
        UsageError: a file cannot be used, or they do not belong together; names line and remedy.
        CalibrationError: recording and moves do not fit, or the clocks cannot be aligned without doubt.
    """
    if is_target_file(given.recording.path) and given.asked.test == "backlash":
        return _of_targets(given)
    if given.moves is None:
        raise UsageError(f"{given.recording.path}: --moves is missing: when each move was commanded, and its size")
    recording, moves = read_recording(given.recording), read_moves(given.moves)
    torque = None
    if given.joint_torque is not None:
        torque = read_torque(given.joint_torque, given.torque_channel)
    return evaluated(given.asked, recording, moves, torque, align=given.align)


def _of_targets(given: Import) -> AnyTest:
    unit, reversal, targets = reversal_of_targets(given.recording.path, given.deviation_unit)
    kind = AngularTest if unit == "deg" else LinearTest
    asked = given.asked
    return kind.model_validate(
        {
            "test": asked.test,
            "joint": asked.joint,
            "position": asked.position,
            "threshold_percent": asked.threshold_percent,
            "moves": [],
            "reversal": reversal,
            "targets": targets,
            "flags": ["from deviations at targets: nothing is known of single steps and of the motor's torque"],
        }
    )
