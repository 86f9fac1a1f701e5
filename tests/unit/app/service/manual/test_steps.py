"""Steps against the geometry of plane vectors as complex numbers."""

import cmath
import math
from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.errors import ManualStepError
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.manual_steps import step_target
from tests.unit.app.service.manual.benches import bench_from_template

BENCH: ScaraBench = bench_from_template()
REFLECTORS = {reflector.name: reflector for reflector in BENCH.reflectors}
NAMES = st.sampled_from(sorted(REFLECTORS))
ANGLES = st.tuples(st.floats(-90.0, 40.0), st.floats(5.0, 140.0))


def axis_mm(bench: ScaraBench, joints: Pose) -> complex:
    """Return the place of the J4 axis."""
    one, two = math.radians(joints[0]), math.radians(joints[1])
    return bench.link1_mm * cmath.exp(1j * one) + bench.link2_mm * cmath.exp(1j * (one + two))


def beside_mm(bench: ScaraBench, joints: Pose, reflector: Reflector) -> float:
    """Return where the beam crosses the line through the reflector across the line of sight; to the left positive."""
    place = complex(reflector.x_mm, reflector.y_mm) - axis_mm(bench, joints)
    world = math.radians(joints[0] + joints[1] + joints[3] + bench.optics.theta40_deg)
    sight = place / abs(place)
    beam = cmath.exp(1j * world) / sight
    return abs(place) * beam.imag / beam.real


def pointing(bench: ScaraBench, angles: tuple[float, float], reflector: Reflector, off_deg: float) -> Pose:
    """Return a pose whose beam points to the left of a reflector by an angle."""
    place = complex(reflector.x_mm, reflector.y_mm) - axis_mm(bench, (*angles, 50.0, 0.0))
    world_deg = math.degrees(cmath.phase(place)) + off_deg
    j4_deg = (world_deg - sum(angles) - bench.optics.theta40_deg + 180.0) % 360.0 - 180.0
    return (angles[0], angles[1], 50.0, j4_deg)


@given(ANGLES, NAMES, st.floats(-20.0, 20.0), st.floats(-90.0, 90.0), st.floats(-180.0, 180.0))
def test_the_beam_moves_sideways_at_the_reflector(
    angles: tuple[float, float], name: str, off_deg: float, by_mm: float, theta40_deg: float
) -> None:
    bench = replace(BENCH, optics=replace(BENCH.optics, theta40_deg=theta40_deg))
    here = pointing(bench, angles, REFLECTORS[name], off_deg)
    assume(abs(complex(REFLECTORS[name].x_mm, REFLECTORS[name].y_mm) - axis_mm(bench, here)) > 150.0)
    target = step_target(bench, here, "beam", by_mm, name)
    assert target[:3] == here[:3]
    moved_mm = beside_mm(bench, target, REFLECTORS[name]) - beside_mm(bench, here, REFLECTORS[name])
    assert moved_mm == pytest.approx(by_mm, abs=1e-6)
    assert (target[3] - here[3]) * by_mm >= 0.0


@given(ANGLES, NAMES, st.floats(-5.0, 5.0), st.floats(-30.0, 30.0), st.sampled_from(["j1", "j2"]))
def test_j4_keeps_the_beam_where_it_is_beside_the_reflector(
    angles: tuple[float, float], name: str, off_deg: float, by_deg: float, joint: str
) -> None:
    here = pointing(BENCH, angles, REFLECTORS[name], off_deg)
    target = step_target(BENCH, here, "j1" if joint == "j1" else "j2", by_deg, None)
    for pose in (here, target):
        assume(abs(complex(REFLECTORS[name].x_mm, REFLECTORS[name].y_mm) - axis_mm(BENCH, pose)) > 60.0)
    target = step_target(BENCH, here, "j1" if joint == "j1" else "j2", by_deg, name)
    kept_mm = beside_mm(BENCH, target, REFLECTORS[name])
    assert kept_mm == pytest.approx(beside_mm(BENCH, here, REFLECTORS[name]), abs=1e-6)
    stepped = (target[0] - here[0], target[1] - here[1])
    assert stepped == pytest.approx((by_deg, 0.0) if joint == "j1" else (0.0, by_deg))
    assert abs(target[3] - here[3]) <= 180.0


def test_a_joint_without_an_aim_moves_alone() -> None:
    here = (1.0, 2.0, 50.0, 4.0)
    assert step_target(BENCH, here, "j1", -3.0) == (-2.0, 2.0, 50.0, 4.0)
    assert step_target(BENCH, here, "j2", 3.0) == (1.0, 5.0, 50.0, 4.0)
    assert step_target(BENCH, here, "j4", 3.0, "P1") == (1.0, 2.0, 50.0, 7.0)


def test_what_cannot_be_stepped_says_so() -> None:
    with pytest.raises(ManualStepError, match="say at which; there are P1, P2, P3"):
        step_target(BENCH, (0.0, 0.0, 50.0, 0.0), "beam", 1.0)
    with pytest.raises(ManualStepError, match="no reflector 'P9'; there are P1"):
        step_target(BENCH, (0.0, 0.0, 50.0, 0.0), "j1", 1.0, "P9")
    # At the stretched arm the beam looks along +X, where P2 stands at y = 0: 90 deg to the left is past it.
    with pytest.raises(ManualStepError, match=r"points 90\.0° past P2: turn J4 by -90\.0 deg first"):
        step_target(BENCH, (0.0, 0.0, 50.0, 90.0), "beam", 1.0, "P2")
    near = replace(BENCH, reflectors=(Reflector("P2", 560.0, 0.0, 180.0),))
    with pytest.raises(ManualStepError, match="10 mm from P2"):
        step_target(near, (0.0, 0.0, 50.0, 0.0), "beam", 1.0, "P2")
