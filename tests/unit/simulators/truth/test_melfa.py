"""The MELFA controller knows what it commanded and what its encoders count, and nothing of the arm behind them."""

import math
import struct
from dataclasses import replace

import numpy as np
import pytest

from catseye.simulators.config import EmulationConfig
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulated_bench import EmulatedBench, EmulatedDrivenScara
from catseye.simulators.melfa.commands.table import COMMANDS
from catseye.simulators.world.types import Floats
from tests.transcripts import melfa_datalink, melfa_mxt
from tests.unit.simulators.benches import P1, P2, P3
from tests.unit.simulators.truth.worlds import said, session_of
from tests.unit.simulators.world.serial.arms import serial_arm

PROTOCOLS = ("melfa-r3", "melfa-datalink", "melfa-mxt")
CONFIG = EmulationConfig(reflectors=(P1, P2, P3), acceptance_mm=30.0)
ARGUMENTS = {"SRVCUR": ("0", "1"), "VAL": ("M_RSPD", "J_CURR", "J_FBC", "P_CURR", "P_FBC", "M_SVO")}
CHANGES = (
    *("ALIGN", "CLOSE", "DELETE", "EXEC", "EXEC2=", "HOME", "JOG", "MOVSP", "RUN", "STOP", "SRVOFF"),
    *("NEW", "OPEN=", "RSTALRM", "RENAME", "SAVE", "SLOTINIT", "STOPON"),
)

# Where the arm is, as each program is asked for it.
STREAMS = {"melfa-datalink": melfa_datalink.ASK_FEEDBACK, "melfa-mxt": melfa_mxt.WHERE}


def moving(seed: int) -> EmulationContext:
    """Return a bench whose controller drives the arm, the same way whatever the seed."""
    context = EmulatedBench(replace(CONFIG, seed=seed)).context
    robot = session_of(context, "melfa-r3")
    for command in ("OPEN=TEST", "CNTLON", "SRVON"):
        assert said(context, robot, f"1;1;{command}\r".encode()).lower().startswith(b"qok")
    context.bench.advance(2.0)
    for command in ("OVRD=10", "EXECJ1=(40,-60,20,30)", "EXECMOV J1"):
        assert said(context, robot, f"1;1;{command}\r".encode()).lower().startswith(b"qok")
    context.bench.advance(0.5)
    assert context.bench.moving
    return context


def answers(context: EmulationContext) -> dict[str, bytes]:
    """Ask everything that can be asked."""
    robot = session_of(context, "melfa-r3")
    asked = {}
    for word in sorted(set(COMMANDS) - set(CHANGES)):
        for argument in ARGUMENTS.get(word, ("",)):
            request = f"{word}{argument}"
            asked[request] = said(context, robot, f"1;1;{request}\r".encode())
    return asked


@pytest.mark.parametrize("after_s", [0.0, 60.0])
def test_no_answer_depends_on_the_true_arm(after_s: float) -> None:
    worlds = [moving(seed) for seed in (1, 2)]
    assert worlds[0].bench.true_joints != worlds[1].bench.true_joints
    for context in worlds:
        context.bench.advance(after_s)
        assert context.bench.moving is (after_s == 0.0)
    one, other = map(answers, worlds)
    for protocol, request in STREAMS.items():
        one[protocol], other[protocol] = (said(c, session_of(c, protocol), request) for c in worlds)
        assert one[protocol]
    assert {asked: answer for asked, answer in one.items() if answer != other[asked]} == {}
    assert sum(answer.lower().startswith(b"qok") for answer in one.values()) > 50


def test_the_stated_speed_is_that_of_the_nominal_arm() -> None:
    context = moving(1)
    robot = session_of(context, "melfa-r3")
    stated = float(said(context, robot, b"1;1;PPOSF\r").split(b";")[-2])
    first, second = (np.array(context.bench.joints_at(context.bench.time_s + step)) for step in (0.0, 1e-3))
    way_mm = math.hypot(abs(place_mm(second) - place_mm(first)), second[2] - first[2])
    assert stated == pytest.approx(way_mm / 1e-3, abs=0.01)


def place_mm(joints: Floats) -> complex:
    first = math.radians(joints[0])
    both = first + math.radians(joints[1])
    links = CONFIG.scara
    return links.link1_mm * complex(math.cos(first), math.sin(first)) + links.link2_mm * complex(
        math.cos(both), math.sin(both)
    )


def test_feedback_of_real_time_control_has_the_encoders_step() -> None:
    start = (40.0004, -60.0004, 20.0004, 30.0004)
    context = EmulatedBench(replace(CONFIG, start_joints=start)).context
    session = session_of(context, "melfa-mxt")
    request = bytearray(196)
    struct.pack_into("<3H", request, 0, 0, 0, 8)
    reply = said(context, session, bytes(request))
    j1, j2, j3, j4 = struct.unpack_from("<4f", reply, 8)
    counts = 1000.0 * np.array([math.degrees(j1), math.degrees(j2), j3, math.degrees(j4)])
    assert np.abs(counts - np.round(counts)).max() < 0.01


def test_feedback_of_motors_with_encoders_is_theirs() -> None:
    arm = serial_arm("rh-3frh5515")
    config = EmulationConfig(serial=arm, start_joints=(10.0, 20.0, 30.0, 40.0), seed=3)
    emulation = EmulatedDrivenScara(config, arm)
    emulation.bench.move_to((10.5, 20.5, 30.5, 40.5))
    emulation.bench.advance(20.0)
    feedback = np.array(emulation.controller.feedback)
    off = feedback - np.array(emulation.bench.true_joints)
    assert feedback.tolist() == list(emulation.bench.measured)
    assert np.abs(off).min() > 1e-6
