"""A serial arm with servos, transmissions and weight: what its links do of what the controller commands.

Everything is a closed function of bench time within a motion and the rest that follows it. Motors follow the
commanded way, stretched so that it ends where their servos come to rest; the links follow the motors through their
transmissions, under the weight of all links at the commanded pose.
"""

from bisect import bisect_right
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.simulators.config import ArmDynamics, Joints, SerialArm
from catseye.simulators.world.motion import (
    SHORTEST,
    STANDSTILL,
    Motion,
    plan_motion,
    plan_stop,
    plan_way,
)
from catseye.simulators.world.serial.drivetrain import Drive, Drivetrains
from catseye.simulators.world.serial.gears import Gears
from catseye.simulators.world.serial.screws import ScrewArm
from catseye.simulators.world.serial.servo import Encoders, Servos
from catseye.simulators.world.serial.truth import JointTruth, column
from catseye.simulators.world.types import Bools, Floats, Ints
from catseye.simulators.world.warming import Warming

_PIECE_DEG = 10.0
"""Weight is worked out anew after each such piece of a way, and taken to change evenly between."""

_HEAVIER = 1e-3
"""A resting joint notices a change of its load by this part of its friction."""

_RINGING_DECAY_S = 0.15
_CALM_S = 30.0 * _RINGING_DECAY_S
_KEPT = 512
"""Motions that are remembered, for instruments that look back."""

_TORQUE_NOISE = 0.01
"""Standard deviation of a torque that a drive shows, as a part of its motor's friction; an assumption."""


@dataclass(frozen=True)
class _Stretch:
    """One motion, cut into pieces of even load, and the rest after it; n joints, m knots.

    Attributes:
        motion: as commanded.
        marks: fractions of the way at the knots, shape (m,).
        knots: drives at the knots, shape (m, n).
        moved: joints that the motion moves or loads, shape (n,).
        ends: drives when each joint came to rest, shape (n,).
        rests_s: when it did, shape (n,).
        senses: direction of each motor's last motion, 0 before the first one, shape (n,).
        rings_deg: amplitudes of the ringing after the motion, shape (n,).
    """

    motion: Motion
    marks: Floats
    knots: Drive
    moved: Bools
    ends: Drive
    rests_s: Floats
    senses: Floats
    rings_deg: Floats


class DrivenArm:
    """State of the arm.

    Args:
        arm: with its true geometry.
        truths: its true drivetrains, a joint each.
        start: joints at bench time 0, deg.
        seed: of everything random.
        base: where it really stands, from where it should, shape (4, 4); by default it stands there.

    Attributes:
        names: of the joints.
        base: its true base in the room.
        motions_begun: number of motions so far.
        screws: geometry of the arm.
        warming: of its links.
    """

    def __init__(
        self,
        arm: SerialArm,
        truths: Sequence[JointTruth],
        start: Joints,
        seed: int,
        base: Floats | None = None,
    ) -> None:
        self.names = tuple(joint.name for joint in arm.joints)
        self.base: Floats = np.eye(4) if base is None else base
        self.screws = ScrewArm(arm.joints, arm.loads)
        self.motions_begun = 0
        self._motor_friction_nm = column(truths, "motor_friction_nm")
        self._static_friction_nm = column(truths, "static_friction_nm")
        self._torque_gain = 1.0 + column(truths, "torque_gain_error")
        self._viscous_nm_s = column(truths, "viscous_nm_s_per_deg")
        self._stribeck_deg_s = column(truths, "stribeck_deg_s")
        self._noticed_nm = _HEAVIER * column(truths, "link_friction_nm") + SHORTEST
        self._balancer_nm = column(truths, "counterbalance_nm")
        self._balancer_zero_deg = column(truths, "counterbalance_zero_deg")
        self._ringing_s = column(truths, "ringing_s")
        self._ringing_rad_s = 2.0 * np.pi * column(truths, "ringing_hz")
        self._gears = Gears(truths)
        self._dynamics = dynamics_of(arm)
        self.warming = Warming(self._dynamics.max_speed)
        self._drivetrains = Drivetrains(truths)
        self._encoders = Encoders(arm.joints, truths, seed)
        self._servos = Servos(truths, self._encoders, seed)
        motion = Motion.straight(start, start, 0.0, STANDSTILL)
        rest = self._drivetrains.at_rest(np.array(start), self._holding(np.array([start]))[0])
        nothing = np.zeros(len(start))
        knots = _stacked([rest, rest])
        first = _Stretch(motion, motion.marks, knots, nothing > 0.0, rest, nothing, nothing, nothing)
        self._stretches = deque([first], maxlen=_KEPT)

    @property
    def motion(self) -> Motion:
        """The present motion as the controller commands it, and the rest that follows it."""
        return self._stretches[-1].motion

    def move_to(
        self, target: Joints, time_s: float, speed_fraction: float, acceleration_fraction: float = 1.0
    ) -> None:
        """Start a synchronous motion of all axes at a bench time at which none is commanded.

        Args:
            target: command, deg, from where the last command ended.
            time_s: bench time, s.
            speed_fraction: part of the largest speeds, above 0, up to 1.
            acceleration_fraction: part of the largest accelerations, above 0, up to 1.
        """
        start = self.motion.joints_at(time_s)
        self._begin(plan_motion(start, target, time_s, self._dynamics, speed_fraction, acceleration_fraction))

    def follow(self, times_s: Floats, joints: Floats, time_s: float) -> None:
        """Start a motion through knots; see `plan_way`."""
        self._begin(plan_way(self.motion.joints_at(time_s), times_s, joints, time_s))

    def brake(self, time_s: float) -> None:
        """Decelerate to a standstill on the path as fast as the drives can."""
        self._begin(plan_stop(self.motion, time_s, self._dynamics))

    def measured(self, time_s: float) -> Joints:
        """Return what the encoders show, counted out to the joints, deg."""
        drive = self._at(self._stretch_at(time_s), np.array([time_s]))
        shown: Joints = tuple(self._encoders.measured_deg(drive.motor_deg[0], time_s).tolist())
        return shown

    def encoder_counts(self, time_s: float) -> tuple[int, ...]:
        """Return the counts of the encoders, from the joints' zeros on."""
        drive = self._at(self._stretch_at(time_s), np.array([time_s]))
        return tuple(int(count) for count in self._encoders.counts(drive.motor_deg[0], time_s))

    def true_joints(self, time_s: float) -> Joints:
        """Return where the links really are, deg."""
        links: Joints = tuple(self.links_deg(np.array([time_s]))[0].tolist())
        return links

    def links_deg(self, times_s: Floats) -> Floats:
        """Return where the links really are.

        Args:
            times_s: bench times in order, among those of the last motions, shape (m,).

        Returns:
            Angles, deg, shape (m, n).
        """
        if times_s[0] >= self.motion.start_s:
            return self._links(self._stretches[-1], times_s)
        starts_s = [stretch.motion.start_s for stretch in self._stretches]
        of = np.maximum(np.searchsorted(starts_s, times_s, side="right") - 1, 0)
        links = np.empty((times_s.size, len(self.names)))
        for number in np.unique(of):
            mine = of == number
            links[mine] = self._links(self._stretches[int(number)], times_s[mine])
        return links

    def torques_nm(self, time_s: float) -> tuple[float, ...]:
        """Return the torques at the joints, N m, as drives take them from the currents of their motors."""
        noise = _TORQUE_NOISE * self._motor_friction_nm * self._encoders.torque_noise(time_s)
        shown: Floats = self._torque_gain * np.array(self.true_torques_nm(time_s)) + noise
        return tuple(shown.tolist())

    def true_torques_nm(self, time_s: float) -> tuple[float, ...]:
        """Return the torques of the drives at the joints, N m: load, friction, and what the balancers leave."""
        stretch = self._stretch_at(time_s)
        drive = self._at(stretch, np.array([time_s]))
        friction = self._motor_friction(stretch, time_s)
        return tuple((drive.hold_nm[0] + drive.friction_nm[0] + friction).tolist())

    def _stretch_at(self, time_s: float) -> _Stretch:
        starts_s = [stretch.motion.start_s for stretch in self._stretches]
        return self._stretches[max(0, bisect_right(starts_s, time_s) - 1)]

    def _begin(self, motion: Motion) -> None:
        self.motions_begun += 1
        self.warming.begin(motion)
        before = self._stretch_at(motion.start_s)
        start = _row(self._at(before, np.array([motion.start_s])), 0)
        speeds = np.abs(motion.slopes).max(axis=0) * motion.profile.speed
        wavy = self._drivetrains.wavy(start.link_deg)
        stops = self._servos.stops_deg(np.array(motion.end), start.motor_deg, speeds, wavy)
        travels = np.abs(motion.steps).sum(axis=0) > SHORTEST
        stops = np.where(travels, stops, start.motor_deg)
        marks, commanded = _pieces(motion)
        holds = self._holding(commanded)
        heavier = np.abs(holds - start.hold_nm).max(axis=0) > self._noticed_nm
        turned = travels & ((stops != start.motor_deg) | (len(motion.steps) > 1))
        moved = turned | heavier
        motors = self._motors(start, commanded, stops, marks)
        knots = self._passed(start, motors, np.where(moved, holds, start.hold_nm))
        end = _row(knots, -1)
        self._stretches.append(
            _Stretch(
                motion,
                marks,
                knots,
                moved,
                _where(moved, end, before.ends),
                np.where(moved, motion.end_s, before.rests_s),
                np.where(turned, np.sign(stops - start.motor_deg), before.senses),
                np.where(turned, speeds * self._ringing_s, 0.0),
            )
        )

    def _motors(self, start: Drive, commanded: Floats, stops: Floats, marks: Floats) -> Floats:
        """Return the motors at the knots: the commanded way, stretched to where the servos come to rest."""
        left = (stops - start.motor_deg) - (commanded[-1] - commanded[0])
        motors: Floats = start.motor_deg + (commanded - commanded[0]) + marks[:, None] * left
        return motors

    def _passed(self, start: Drive, motors: Floats, holds: Floats) -> Drive:
        drives = [start]
        for motor, hold in zip(motors[1:], holds[1:], strict=True):
            drives.append(self._drivetrains.driven(drives[-1], motor, hold))
        return _stacked(drives)

    def _at(self, stretch: _Stretch, times_s: Floats) -> Drive:
        """Return the drives at bench times not before the start of a stretch, shape (m, n)."""
        rests = np.maximum(times_s[:, None] - stretch.rests_s, 0.0)
        drive = self._drivetrains.rested(stretch.ends, rests)
        runs = times_s < stretch.motion.end_s
        if runs.any() and stretch.moved.any():
            running = _row(drive, runs)
            moving = self._moving(stretch, times_s[runs])
            _put(drive, runs, _where(stretch.moved, moving, running))
        return drive

    def _moving(self, stretch: _Stretch, times_s: Floats) -> Drive:
        """Return all drives as if the motion moved them, at bench times within it, shape (m, n)."""
        done = stretch.motion.done(times_s)
        leg = np.searchsorted(stretch.marks[1:-1], done, side="right")
        part = ((done - stretch.marks[leg]) / np.diff(stretch.marks)[leg])[:, None]
        start, end = _row(stretch.knots, leg), _row(stretch.knots, leg + 1)
        motor = start.motor_deg + part * (end.motor_deg - start.motor_deg)
        hold = start.hold_nm + part * (end.hold_nm - start.hold_nm)
        return self._drivetrains.driven(start, motor, hold)

    def _links(self, stretch: _Stretch, times_s: Floats) -> Floats:
        drive = self._at(stretch, times_s)
        links = drive.link_deg + self._gears.errors_deg(drive, times_s)
        if times_s[0] > stretch.motion.end_s + _CALM_S:
            return links
        after_s = np.maximum(times_s - stretch.motion.end_s, 0.0)[:, None]
        rung: Floats = stretch.rings_deg * np.exp(-after_s / _RINGING_DECAY_S)
        return links + rung * np.sin(self._ringing_rad_s * after_s)

    def _motor_friction(self, stretch: _Stretch, time_s: float) -> Floats:
        """Return the friction in front of the transmissions, N m at the joints, shape (n,)."""
        coulomb = stretch.senses * self._motor_friction_nm
        motion = stretch.motion
        rate = motion.profile.speed_at(time_s - motion.start_s)
        speeds = rate * motion.slopes_from(float(motion.done(np.array([time_s]))[0]))[0]
        slow = np.exp(-((speeds / self._stribeck_deg_s) ** 2))
        static = np.sign(speeds) * slow * self._static_friction_nm
        friction: Floats = coulomb + speeds * self._viscous_nm_s + static
        return friction

    def _holding(self, joints_deg: Floats) -> Floats:
        """Return the load of each drive: weight less what balancers take, N m, shape (m, n)."""
        balanced: Floats = self._balancer_nm * np.sin(np.deg2rad(joints_deg - self._balancer_zero_deg))
        return self.screws.holding_torques(joints_deg) + balanced


def dynamics_of(arm: SerialArm) -> ArmDynamics:
    """Return how fast an arm moves."""
    return ArmDynamics(
        tuple(joint.speed for joint in arm.joints), tuple(joint.acceleration for joint in arm.joints)
    )


def _pieces(motion: Motion) -> tuple[Floats, Floats]:
    """Return fractions of a way, at its knots and between, and the commanded joints there."""
    counts = np.ceil(np.abs(motion.steps).max(axis=1) / _PIECE_DEG).astype(int)
    ends = zip(motion.marks[:-1], motion.marks[1:], np.maximum(counts, 1), strict=True)
    inner = [np.linspace(first, last, count, endpoint=False) for first, last, count in ends]
    marks = np.concatenate([*inner, motion.marks[-1:]])
    return marks, motion.along(marks)


def _row(drive: Drive, rows: int | Ints | Bools) -> Drive:
    return Drive(drive.motor_deg[rows], drive.link_deg[rows], drive.hold_nm[rows], drive.friction_nm[rows])


def _put(drive: Drive, rows: Bools, other: Drive) -> None:
    drive.motor_deg[rows] = other.motor_deg
    drive.link_deg[rows] = other.link_deg
    drive.hold_nm[rows] = other.hold_nm
    drive.friction_nm[rows] = other.friction_nm


def _stacked(drives: Sequence[Drive]) -> Drive:
    return Drive(
        np.array([drive.motor_deg for drive in drives]),
        np.array([drive.link_deg for drive in drives]),
        np.array([drive.hold_nm for drive in drives]),
        np.array([drive.friction_nm for drive in drives]),
    )


def _where(chosen: Bools, one: Drive, other: Drive) -> Drive:
    return Drive(
        np.where(chosen, one.motor_deg, other.motor_deg),
        np.where(chosen, one.link_deg, other.link_deg),
        np.where(chosen, one.hold_nm, other.hold_nm),
        np.where(chosen, one.friction_nm, other.friction_nm),
    )
