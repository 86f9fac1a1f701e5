"""A bench with an IRB 120 that carries three nests, for tests of what measures it in the room."""

from dataclasses import replace

from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.survey import Mark, SurveyConfig
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.driven_arm import DrivenArm
from catseye.simulators.world.serial.truth import read_joint_truth
from tests.unit.simulators.world.serial.arms import exact_truth, serial_arm

TARGETS = (
    Mark("nest1", (0.0, 0.0, 125.0), (0.0, 0.0, 1.0)),
    Mark("nest2", (71.0, 90.0, 215.0), (0.0, 0.0, 1.0)),
    Mark("nest3", (150.0, 0.0, 125.0), (0.0, 0.0, 1.0)),
)
"""The triangular artifact of the six-axis paper, section 2.1; where its retroreflectors look is chosen here."""

FORWARD: Joints = (0.0, 10.0, -10.0, 0.0, 5.0, 0.0)
"""The tool looks forwards, to where the tracker stands."""

EXACT = SurveyConfig(
    targets=TARGETS,
    u_target_mm=0.0,
    range_um=0.0,
    range_um_per_m=0.0,
    angle_um=0.0,
    angle_um_per_m=0.0,
    face_urad=0.0,
    zero_um=0.0,
    instrument_drift_um=0.0,
    instrument_drift_urad=0.0,
    base_drift_um=0.0,
    base_drift_urad=0.0,
    mark_um=0.0,
    volume_um=0.0,
    u_bar_um=0.0,
    ballbar_um=0.0,
    u_ballbar_um=0.0,
    nest_um=0.0,
    growth_ppm=0.0,
)
"""Instruments without errors around an arm that does not wander."""


def surveyed(survey: SurveyConfig = EXACT, seed: int = 5, start: Joints = FORWARD) -> SerialBench:
    """Return a bench whose arm follows its commands exactly."""
    arm = serial_arm("irb120")
    config = EmulationConfig(serial=arm, start_joints=start, seed=seed, survey=survey)
    plant = DrivenArm(arm, read_joint_truth(exact_truth(arm), arm).joints, start, seed)
    return SerialBench(plant, config)


def exact_but(**changes: float) -> SurveyConfig:
    """Return instruments with no errors but those that are stated."""
    return replace(EXACT, **changes)  # type: ignore[arg-type]  # every field that tests change is a float
