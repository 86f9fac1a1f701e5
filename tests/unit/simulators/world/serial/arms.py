"""Arms of the bench for tests, from the shipped descriptions."""

import json
from dataclasses import replace

from catseye.app.cell.arm import shipped_arm
from catseye.app.service.serial.emulation import serial_arm_of
from catseye.simulators.config import SerialArm, SerialLoad, TruthText
from catseye.simulators.world.serial.truth import FORMAT, ArmTruth, JointTruth, joint_truth_document

TOOL = SerialLoad(6, 20.0, (0.0, 0.0, 145.0))
"""A gripper on the flange, of which the paper says no more than that there is one."""


def serial_arm(name: str, *more: SerialLoad) -> SerialArm:
    """Return a shipped arm, with further loads."""
    arm = serial_arm_of(shipped_arm(name))
    return replace(arm, loads=(*arm.loads, *more))


def exact_arm(name: str) -> SerialArm:
    """Return a shipped arm with encoders of no coarser step than floating point."""
    arm = serial_arm(name)
    return replace(arm, joints=tuple(replace(joint, encoder_bits=48) for joint in arm.joints))


def exact_truth(arm: SerialArm) -> TruthText:
    """Return the document of drivetrains without friction, play, torsion, scatter and noise."""
    joints = tuple(
        JointTruth(
            name=joint.name,
            stiffness_nm_per_deg=1e15,
            play_deg=0.0,
            engagement_nm=1.0,
            link_friction_nm=0.0,
            friction_waviness=0.0,
            presliding_deg=1.0,
            creep=0.0,
            motor_friction_nm=0.0,
            static_friction_nm=0.0,
            servo_nm_per_deg=1.0,
            stop_scatter_deg=0.0,
            stop_window_deg=0.0,
            encoder_noise_counts=0.0,
            encoder_error_deg=0.0,
            ringing_s=0.0,
        )
        for joint in arm.joints
    )
    document = joint_truth_document(ArmTruth(format=FORMAT, joints=joints))
    return TruthText(json.dumps(document).encode(), "exact.json")
