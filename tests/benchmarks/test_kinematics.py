"""Joints of 20 000 poses of a KR 210 against a loop over a scalar inverse, with the same numbers."""

import itertools
import math
import time
from collections.abc import Callable

import numpy as np

from catseye.calibration.kinematics.inverse import inverse_kinematics
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.kinematics.types import Floats
from tests.unit.calibration.kinematics.chains import chain

START = np.array([20.0, -80.0, 95.0, 15.0, 30.0, -40.0])
POSES, LOOPED, ROUNDS = 20_000, 400, 9
LOW = (-185.0, -140.0, -120.0, -350.0, -125.0, -350.0)
HIGH = (185.0, -5.0, 155.0, 350.0, 125.0, 350.0)


def targets(count: int) -> Floats:
    """Return poses within some mm of the start, as steps of a Cartesian test are."""
    steps = np.random.default_rng(1).normal(0.0, 3.0, (count, 3))
    start = chain("kr210-r2700").frames(START[None])[-1, 0]
    placed: Floats = start @ pose_of(steps, np.zeros((count, 3)))
    return placed


def about_z(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def about_y(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def with_turns(angle: float, near: float, low: float, high: float) -> float | None:
    turns = (angle + 360.0 * k for k in (-2, -1, 0, 1, 2))
    return min((q for q in turns if low <= q <= high), key=lambda q: abs(q - near), default=None)


def scalar_inverse(target: Floats, near: Floats) -> Floats:
    """Return the joints of one pose as textbooks solve a KUKA: the arm as a triangle, the wrist as Euler angles."""
    x, y, z = target[:3, 3] - 215.0 * target[:3, 2]
    forearm, bow = math.hypot(1200.0, 41.0), math.atan2(41.0, 1200.0)
    found: list[list[float]] = []
    for front, elbow, flip in itertools.product((1.0, -1.0), (1.0, -1.0), (1.0, -1.0)):
        first = math.atan2(front * y, front * x)
        ahead, up = front * math.hypot(x, y) - 350.0, z - 675.0
        bend = elbow * math.acos((ahead**2 + up**2 - 1150.0**2 - forearm**2) / (2.0 * 1150.0 * forearm))
        # Angles about +y, as KUKA counts them: downwards.
        second = -math.atan2(up, ahead) - math.atan2(
            forearm * math.sin(bend), 1150.0 + forearm * math.cos(bend)
        )
        third = bend - bow
        wrist = (about_z(first) @ about_y(second + third)).T @ target[:3, :3]
        fifth = flip * math.acos(wrist[0, 2])
        fourth = math.atan2(-flip * wrist[1, 2], -flip * wrist[2, 2])
        sixth = math.atan2(-flip * wrist[0, 1], -flip * wrist[0, 0])
        degrees = [math.degrees(angle) for angle in (-first, second, third, fourth, fifth, sixth)]
        turned = [with_turns(*each) for each in zip(degrees, near, LOW, HIGH, strict=True)]
        if None not in turned:
            found.append([q for q in turned if q is not None])
    return np.array(min(found, key=lambda q: sum((a - b) ** 2 for a, b in zip(q, near, strict=True))))


def timed_s(work: Callable[[], object]) -> float:
    start_s = time.perf_counter()
    work()
    return time.perf_counter() - start_s


def test_many_poses_are_solved_at_once() -> None:
    arm, wanted = chain("kr210-r2700"), targets(POSES)
    few = wanted[:LOOPED]

    def looped() -> Floats:
        return np.array([scalar_inverse(target, START) for target in few])

    def one_by_one() -> list[Floats]:
        return [inverse_kinematics(arm, target[None], START).required()[0] for target in few]

    def at_once() -> Floats:
        return inverse_kinematics(arm, wanted, START).required()

    assert np.abs(at_once()[:LOOPED] - looped()).max() < 1e-9
    rounds = [(timed_s(at_once), timed_s(looped), timed_s(one_by_one)) for _ in range(ROUNDS)]
    # The least of each: whatever else runs on the machine only adds.
    taken = np.min(rounds, axis=0) / [POSES, LOOPED, LOOPED]
    ours, loop, single = (float(each) for each in taken)
    print(  # noqa: T201  # the figure
        f"\n{POSES} poses of a KR 210: {1e6 * ours:.1f} µs each at once; scalar loop {1e6 * loop:.0f} µs "
        f"(ratio {loop / ours:.0f}); our own one by one {1e6 * single:.0f} µs (ratio {single / ours:.0f})"
    )
    assert loop / ours > 50.0
