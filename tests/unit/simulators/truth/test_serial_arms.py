"""Controllers of serial arms know counts of encoders and currents of motors, and only the drawing of their arm."""

import re

import numpy as np
import pytest

from catseye.simulators.config import EmulatedDevice, EmulationConfig, Joints
from catseye.simulators.emulated_bench import EmulatedAbbBench, EmulatedSerialBench
from catseye.simulators.kuka.controller import KukaController
from catseye.simulators.world.serial.servo import Encoders
from catseye.simulators.world.serial.truth import draw_joint_truth
from catseye.simulators.world.types import Floats
from tests.unit.simulators.abb.test_server import Client as AbbClient
from tests.unit.simulators.truth.worlds import assert_unsure
from tests.unit.simulators.world.serial.arms import serial_arm

UPRIGHT: Joints = (0.0, -90.0, 90.0, 0.0, 30.0, 0.0)
GOAL: Joints = (12.3, -81.7, 77.7, 33.3, 21.1, -15.5)
ARM = serial_arm("kr210-r2700")
SEEDS = range(12)
PROTOCOLS = ("kuka-varproxy", "abb-rws")
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")


def kuka(seed: int) -> EmulatedSerialBench:
    device = EmulatedDevice("robot", "kuka-varproxy")
    config = EmulationConfig(serial=ARM, start_joints=UPRIGHT, devices=(device,), seed=seed)
    emulation = EmulatedSerialBench(config, ARM)
    emulation.bench.move_to(GOAL, 20.0)
    emulation.bench.advance(20.0)
    return emulation


def abb(seed: int) -> EmulatedAbbBench:
    arm = serial_arm("irb120")
    device = EmulatedDevice("robot", "abb-rws")
    config = EmulationConfig(serial=arm, start_joints=GOAL, devices=(device,), seed=seed)
    emulation = EmulatedAbbBench(config, arm)
    emulation.bench.move_to((0.0, 0.0, 0.0, 0.0, 30.0, 0.0), 20.0)
    emulation.bench.advance(20.0)
    return emulation


def axes(controller: KukaController, name: str) -> Floats:
    structure = controller.variables.read(name)
    return np.array([float(re.search(rf"A{n} ([^,}}]+)", structure)[1]) for n in range(1, 7)])  # type: ignore[index]  # there are six


def elements(controller: KukaController, name: str) -> Floats:
    return np.array([float(controller.variables.read(f"{name}[{n}]")) for n in range(1, 7)])


def place(text: str) -> Floats:
    return np.array([float(re.search(rf"\b{axis} ([^,}}]+)", text)[1]) for axis in "XYZ"])  # type: ignore[index]  # they are there


def true_flange_mm(emulation: EmulatedSerialBench | EmulatedAbbBench) -> Floats:
    frames = emulation.bench.plant.screws.frames(np.array([emulation.bench.true_joints]))
    return np.asarray(frames[0, -1, :3, 3])


def count_deg(emulation: EmulatedSerialBench | EmulatedAbbBench, seed: int) -> Floats:
    arm = emulation.context.config.serial
    assert arm is not None
    return Encoders(arm.joints, draw_joint_truth(arm, seed).joints, seed).count_deg


def test_measured_axes_are_whole_counts_and_not_the_links() -> None:
    emulation = kuka(3)
    counts = axes(emulation.controller, "$AXIS_ACT_MEAS") / count_deg(emulation, 3)
    # REALs have 32 bits.
    coarse = 2e-7 * np.abs(counts) + 1e-3
    assert np.all(np.abs(counts - np.round(counts)) < coarse)
    off_deg = axes(emulation.controller, "$AXIS_ACT_MEAS") - np.array(emulation.bench.true_joints)
    assert np.abs(off_deg).min() > 1e-6
    assert np.abs(off_deg).max() > 1e-4


@pytest.mark.parametrize("name", ["$POS_ACT", "$POS_ACT_MEAS"])
def test_the_flange_is_stated_of_the_arm_as_drawn(name: str) -> None:
    off_mm = [place(one.controller.variables.read(name)) - true_flange_mm(one) for one in map(kuka, range(4))]
    assert np.abs(off_mm).max(axis=1).min() > 0.05


def test_speeds_at_rest_are_differences_of_counts() -> None:
    emulation = kuka(3)
    found = []
    for _ in range(40):
        emulation.bench.advance(0.1)
        found.append(elements(emulation.controller, "$VEL_AXIS_ACT"))
    speeds = np.array([joint.speed for joint in ARM.joints])
    steps = np.array(found) / 100.0 * speeds * 0.012 / count_deg(emulation, 3)
    assert np.abs(steps - np.round(steps)).max() < 1e-2
    assert steps.std(axis=0).min() > 0.3


def test_speeds_in_motion_are_those_of_the_motors() -> None:
    emulation = kuka(3)
    emulation.bench.move_to(UPRIGHT, 20.0)
    emulation.bench.advance(0.5 * (emulation.bench.standstill_s - emulation.bench.time_s))
    now_s = emulation.bench.time_s
    before, after = (np.array(emulation.bench.joints_at(now_s - ago_s)) for ago_s in (0.012, 0.0))
    true = 100.0 * (after - before) / 0.012 / np.array([joint.speed for joint in ARM.joints])
    stated = elements(emulation.controller, "$VEL_AXIS_ACT")
    assert stated == pytest.approx(true, abs=0.02)
    assert np.abs(stated - true).min() > 0.0


def test_torques_are_known_as_well_as_motors_are() -> None:
    ratios = []
    for emulation in map(kuka, SEEDS):
        torques = elements(emulation.controller, "$TORQUE_AXIS_ACT")
        true = np.array(emulation.bench.plant.true_torques_nm(emulation.bench.time_s))
        ratios.append(float(torques[1] / true[1] - 1.0))
        assert np.abs(torques - true).min() > 0.0
    assert_unsure(ratios, 0.03, 0.035)


def kuka_geometry_is_hidden(emulation: EmulatedSerialBench) -> dict[str, str]:
    names = ("$AXIS_ACT", "$MODE_OP", "$PRO_STATE", "$TOOL", "$BASE", "$LOAD", "$ROBTRAFO[]", "$POS_ACT")
    return {name: emulation.controller.variables.read(name) for name in names}


def test_what_a_kuka_commands_tells_nothing_of_the_true_arm() -> None:
    one, other = kuka(1), kuka(2)
    assert one.bench.true_joints != other.bench.true_joints
    assert kuka_geometry_is_hidden(one) == kuka_geometry_is_hidden(other)


def test_every_variable_of_a_kuka_is_accounted_for() -> None:
    known = {name for name in kuka(1).controller.variables.names if not name.startswith("CATS_")}
    commanded = {"$AXIS_ACT", "$POS_ACT", "$TOOL", "$BASE", "$LOAD", "$OV_PRO"}
    measured = {"$AXIS_ACT_MEAS", "$AXIS_INC", "$POS_ACT_MEAS", "$VEL_AXIS_ACT", "$TORQUE_AXIS_ACT"}
    states = {"$MODE_OP", "$PRO_STATE", "$PERI_RDY", "$ALARM_STOP", "$STOPMESS"}
    names = {"$MODEL_NAME", "$ROBTRAFO", "$KR_SERIALNO"}
    assert known == commanded | measured | states | names


def abb_joints(client: AbbClient) -> Floats:
    state = client.get("/rw/motionsystem/mechunits/ROB_1/jointtarget").state
    return np.array([float(state[f"rax_{n}"]) for n in range(1, 7)])


def test_an_abb_reads_counts_and_not_its_links() -> None:
    emulation = abb(3)
    joints = abb_joints(AbbClient(emulation))
    counts = joints / count_deg(emulation, 3)
    assert np.all(np.abs(counts - np.round(counts)) < 2e-7 * np.abs(counts) + 1e-3)
    off_deg = joints - np.array(emulation.bench.true_joints)
    assert np.abs(off_deg).min() > 1e-6
    assert np.abs(off_deg).max() > 1e-4


def test_an_abb_states_its_tool_of_the_arm_as_drawn() -> None:
    off_mm = []
    for seed in range(4):
        emulation = abb(seed)
        state = AbbClient(emulation).get("/rw/motionsystem/mechunits/ROB_1/robtarget").state
        stated = np.array([float(state[axis]) for axis in "xyz"])
        off_mm.append(stated - true_flange_mm(emulation))
    assert np.abs(off_mm).max(axis=1).min() > 0.05
