"""Straight and circular motions: along their ways, and as fast as SPD says."""

import math

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from tests.unit.simulators.melfa.desk import Desk, Talker

L1, L2 = 325.0, 225.0


def places(desk: Desk, robot: Talker, statement: str, every_s: float = 0.01) -> tuple[Floats, float]:
    """Carry out a motion; return where the tool was, x, y, z in mm, and how long it took, s.

    The tool's place follows from the commanded joints by two links, not by the emulator's own geometry.
    """
    began_s = desk.bench.time_s
    assert robot.ask(f"EXEC{statement}") == "QoK"
    seen = []
    while desk.bench.moving:
        desk.bench.advance(every_s)
        j1, j2, j3, _ = desk.bench.joints
        a, b = math.radians(j1), math.radians(j1 + j2)
        seen.append((L1 * math.cos(a) + L2 * math.cos(b), L1 * math.sin(a) + L2 * math.sin(b), j3))
    return np.array(seen), desk.bench.standstill_s - began_s


def ready(*commands: str) -> tuple[Desk, Talker]:
    desk = Desk()
    robot = desk.client().ready()
    robot.do("EXEC2=MOV (400,-30,10,0,0,0)(4,0)", *commands)
    return desk, robot


def test_a_straight_motion_is_straight_and_as_fast_as_spd() -> None:
    desk, robot = ready("EXECSPD 10")
    seen, took_s = places(desk, robot, "MVS (400,30,10,0,0,0)(4,0)")
    assert np.abs(seen[:, 0] - 400.0).max() < 2e-3
    assert np.abs(seen[:, 2] - 10.0).max() < 1e-6
    assert seen[-1, 1] == pytest.approx(30.0, abs=1e-6)
    # 60 mm at 10 mm/s, and the ramps of 2 ms.
    assert took_s == pytest.approx(6.002, abs=1e-3)


def test_overrides_slow_a_straight_motion_down() -> None:
    desk, robot = ready("EXECSPD 10", "OVRD=50", "EXECOVRD 50", "EXECJOVRD 10")
    _, took_s = places(desk, robot, "MVS (400,-20,10,0,0,0)(4,0)")
    assert took_s == pytest.approx(4.0, abs=0.01), "joint override acts on joint motions alone"


def test_no_joint_is_faster_than_it_can() -> None:
    desk, robot = ready()
    assert robot.ask("EXECMVS (400,300,10,0,0,0)(4,0)") == "QoK"
    fastest = np.zeros(4)
    before = np.array(desk.bench.joints)
    while desk.bench.moving:
        desk.bench.advance(1e-3)
        now = np.array(desk.bench.joints)
        fastest = np.maximum(fastest, np.abs(now - before) / 1e-3)
        before = now
    assert np.all(fastest <= 1.001 * np.array([420.0, 720.0, 1100.0, 3000.0]))


def test_an_arc_lies_on_its_circle_through_all_places() -> None:
    desk, robot = ready("EXECSPD 20", "EXECP1=(400,-30,10,0,0,0)(4,0)", "EXECP2=(430,0,10,0,0,0)(4,0)")
    seen, took_s = places(desk, robot, "MVR P1,P2,(400,30,10,0,0,0)(4,0)")
    # A half circle about (400, 0) of 30 mm.
    assert np.abs(np.hypot(seen[:, 0] - 400.0, seen[:, 1]) - 30.0).max() < 5e-3
    assert seen[:, 0].min() > 400.0 - 1e-3
    assert seen[:, 0].max() == pytest.approx(430.0, abs=0.01)
    assert took_s == pytest.approx(math.pi * 30.0 / 20.0, abs=0.01)


def test_a_circle_comes_back_to_its_start() -> None:
    desk, robot = ready("EXECSPD 50", "EXECP1=(400,-30,10,0,0,0)(4,0)", "EXECP2=(430,0,20,0,0,0)(4,0)")
    seen, took_s = places(desk, robot, "MVC P1,P2,(400,30,10,0,0,0)(4,0)")
    assert seen[-1] == pytest.approx((400.0, -30.0, 10.0), abs=1e-3)
    # Through three places in space; the radius by the sides of the triangle.
    sides = (math.sqrt(30**2 + 30**2 + 10**2),) * 2 + (60.0,)
    half = sum(sides) / 2.0
    area = math.sqrt(half * math.prod(half - side for side in sides))
    radius_mm = math.prod(sides) / (4.0 * area)
    assert took_s == pytest.approx(2.0 * math.pi * radius_mm / 50.0, abs=0.02)


def test_an_arc_begins_where_it_is_told_to() -> None:
    desk, robot = ready("EXECSPD 20")
    seen, _ = places(desk, robot, "MVR (400,-10,10,0,0,0)(4,0),(410,0,10,0,0,0)(4,0),(400,10,10,0,0,0)(4,0)")
    straight = seen[seen[:, 1] < -10.0]
    assert np.abs(straight[:, 0] - 400.0).max() < 2e-3


def test_a_straight_motion_leads_to_the_place_of_joints() -> None:
    desk, robot = ready("EXECSPD 100", "EXECJ1=(0,60,10,0)")
    seen, _ = places(desk, robot, "MVS J1")
    assert seen[-1] == pytest.approx((325.0 + 225.0 * 0.5, 225.0 * math.sqrt(0.75), 10.0), abs=1e-3)


@pytest.mark.parametrize(
    ("statement", "answer"),
    [
        ("MVS (600,0,10,0,0,0)(4,0)", "QeR280200000"),
        ("MVS (400,0,10,0,0,0)(0,0)", "QeR281000000"),
        # Both ends are within the ring, the chord leads through the hole about J1.
        ("MVS (-180,-30,10,0,0,0)(4,0)", "QeR280200000"),
        ("MVR P_CURR,P_CURR,P_CURR", "QeR280200000"),
        ("MVR P_CURR,P_CURR", "QeR422000000"),
    ],
)
def test_ways_that_lead_nowhere_are_refused(statement: str, answer: str) -> None:
    desk, robot = ready()
    assert robot.ask(f"EXEC{statement}") == answer
    assert not desk.bench.moving


def test_a_stop_ends_a_straight_motion() -> None:
    desk, robot = ready("EXECSPD 10")
    robot.do("EXECMVS (400,30,10,0,0,0)(4,0)")
    desk.bench.advance(1.0)
    robot.do("STOP")
    desk.bench.advance(1.0)
    assert not desk.bench.moving
    j1, j2 = (math.radians(value) for value in desk.bench.joints[:2])
    assert L1 * math.sin(j1) + L2 * math.sin(j1 + j2) == pytest.approx(-20.0, abs=1.0)
