"""The SCARA: motion, error maps, play, scatter of arrivals, radial error motions, warming and ringing.

Every quantity is a closed function of bench time within one motion (and the rest that follows it), so results do
not depend on the steps in which bench time advances. Play is closed too: each joint moves in one direction only
within a leg of a motion, and clipping a monotone function once is the same as integrating the play operator.

The scatter of an arrival (robot repeatability) is drawn when J1 or J2 travels, however little: it is where those two
end up and how their links lie. A turn of J4 alone leaves the J4 axis where it stands (J4 has its play), and so does a
lift of J3: its spline is taken to be straight and upright. The white noise of the length is drawn at every arrival.

Glides that follow each other without a standstill are one stream with one draw of the scatter and one
ringing at its end.
"""

from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from catseye.simulators.config import STEEL_PER_K, EmulationConfig, Joints
from catseye.simulators.errors import BenchError
from catseye.simulators.world.arm import BeamPoses
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.motion import (
    SHORTEST,
    STANDSTILL,
    Motion,
    plan_glide,
    plan_motion,
    plan_stop,
    plan_way,
)
from catseye.simulators.world.scara.axis_errors import FlankTable, JointMap, RadialError
from catseye.simulators.world.scara.truth import TrueArm
from catseye.simulators.world.timed_bench import OnEvent
from catseye.simulators.world.types import Floats, Ints, Plane
from catseye.simulators.world.warming import Warming

_TO_RAD = np.pi / 180.0
_PLAY_JOINTS = (0, 1, 3)
_STEP_DEG = 0.05
_STEP_S = 0.005
_CALM_MM = 1e-9


@dataclass(frozen=True)
class _Shape:
    """The arm's shape without what goes on at rest too (warming, ringing), shape (n,) each."""

    reach_mm: Plane
    shift_mm: Plane
    beam_rad: Floats
    height_mm: Floats
    white_mm: Floats


class ScaraArm:
    """State of the arm: the present motion, the play of each joint, what is left of earlier ringing.

    Args:
        truth: true geometry and maps.
        config: dynamics, budget, seed and joints at bench time 0.
    """

    def __init__(self, truth: TrueArm, config: EmulationConfig) -> None:
        self._truth = truth
        self._budget = config.budget
        self._dynamics = config.dynamics
        half_j4 = np.array([config.scara.j4_backlash_mdeg * _TO_RAD / 2e3])
        j4_map = JointMap(np.zeros(1), -half_j4, half_j4)
        self._tables = [FlankTable(m) for m in (truth.theta1_map, truth.theta2_map, j4_map)]
        rng = np.random.default_rng([config.seed, 3])
        self._radial = [RadialError(rng, rms_um) for rms_um in config.budget.radial_um]
        self._arrivals = np.random.default_rng([config.seed, 4])
        self.motion = Motion.straight(config.start_joints, config.start_joints, 0.0, STANDSTILL)
        self.gliding = False
        self._stream_mm = 0.0
        self._scattered = False
        self._vibration = (0.0, -np.inf, -np.inf)
        self._play = np.full((3, 1), -1.0)
        self._play_steps = np.zeros((3, 1))
        self._scatter_from = self._scatter_to = (0j, 0.0)
        self._scatter_from = self._scatter_to = self._draw_scatter(turned=True)
        self._ringing = np.zeros(2, dtype=np.complex128)
        self._kick_mm = 0j
        self._rest_shape: _Shape | None = None
        final_ppm = 1e6 * STEEL_PER_K * config.budget.thermal_k
        self.warming = Warming(config.dynamics.max_speed, final_ppm, config.budget.thermal_time_s)
        # The amplitude decays and turns: exp(rate t).
        self._ring_rate = -1.0 / self._budget.vibration_decay_s + 2j * np.pi * self._budget.vibration_hz

    def move_to(
        self, target: Joints, time_s: float, speed_fraction: float, acceleration_fraction: float
    ) -> None:
        """Start a motion at a bench time at which the arm stands still."""
        start = self.motion.joints_at(time_s)
        motion = plan_motion(start, target, time_s, self._dynamics, speed_fraction, acceleration_fraction)
        self._begin(motion)

    def follow(self, times_s: Floats, joints: Floats, time_s: float) -> None:
        """Start a motion through knots at a bench time at which the arm stands still; see `plan_way`."""
        self._begin(plan_way(self.motion.joints_at(time_s), times_s, joints, time_s))

    def glide(self, target: Joints, time_s: float, duration_s: float) -> bool:
        """Move at constant speed, from standstill or from a glide under way.

        Returns:
            False when the arm stands there already: nothing was changed.
        """
        here = self.motion.joints_at(time_s)
        way = max(abs(b - a) for a, b in zip(here, target, strict=True))
        if way < SHORTEST and time_s >= self.motion.end_s:
            return False
        goes_on = self.gliding and time_s <= self.motion.end_s + SHORTEST
        self._begin(plan_glide(here, target, time_s, duration_s), goes_on=goes_on)
        self.gliding = True
        return True

    def stop(self, time_s: float) -> None:
        """Decelerate from a bench time on; the path is not left."""
        self._begin(plan_stop(self.motion, time_s, self._dynamics))

    def shake(self, size_mm: float, from_s: float, until_s: float) -> None:
        """Let something beside the arm keep it ringing between two bench times.

        Args:
            size_mm: amplitude of the J4 axis, mm.
            from_s: start; the amplitude grows and decays with the ringing's own time constant.
            until_s: end.
        """
        self._vibration = (size_mm, from_s, until_s)

    def play_at(self, time_s: float) -> Floats:
        """Return the states of the play of J1, J2 and J4 (-1...1), shape (3,)."""
        play: Floats = self._play_on(*self.motion.legs(self.motion.done(np.array([time_s]))))[:, 0]
        return play

    def true_joints(self, time_s: float) -> Joints:
        """Return the joints as they really are: command plus deviation, deg, deg, mm, deg."""
        command = self.motion.joints_at(time_s)
        play = self.play_at(time_s)
        j1, j2, j4 = (
            command[joint]
            + float(self._tables[k].deviation_rad(np.array([command[joint]]), play[k : k + 1])[0]) / _TO_RAD
            for k, joint in enumerate(_PLAY_JOINTS)
        )
        return (j1, j2, command[2], j4)

    def axis_shift_mm(self, joint: int) -> complex:
        """Return by how much the axis of J1 or J2 is displaced at the motion's end, in the frame that carries it.

        Args:
            joint: its number, from 1.

        Raises:
            BenchError: it is another joint; below J4 hangs the interferometer.
        """
        if joint not in {1, 2}:
            raise BenchError("a ball stands on the axis of J1 or of J2")
        return complex(self._radial[joint - 1].shift_mm(np.array([self.motion.end[joint - 1]]))[0])

    def sample_times(self) -> Floats:
        """Return the bench times at which the beam has to be looked at, from the motion's start until it is calm."""
        profile = self.motion.profile
        # J3 moves no beam sideways.
        fastest_deg_s = float(np.abs(self.motion.slopes[:, _PLAY_JOINTS]).max()) * profile.speed
        step_s = min(_STEP_S, _STEP_DEG / fastest_deg_s) if fastest_deg_s else _STEP_S
        moving = np.linspace(0.0, profile.duration_s, int(np.ceil(profile.duration_s / step_s)) + 1)
        calm = np.arange(1, self._calm_steps() + 1) * _STEP_S + profile.duration_s
        times_s = self.motion.start_s + np.concatenate([moving, calm])
        _, from_s, until_s = self._vibration
        if until_s + self._calm_s <= times_s[-1]:
            return times_s
        shaken = np.arange(max(from_s, times_s[-1]) + _STEP_S, until_s + self._calm_s, _STEP_S)
        return np.concatenate([times_s, shaken])

    def poses(self, time_s: Floats) -> BeamPoses:
        """Return what the arm does at bench times not before the start of the present motion.

        Args:
            time_s: bench times, s, shape (n,).
        """
        shape = self._shape(self.motion.done(time_s)) if time_s[0] < self.motion.end_s else self._at_rest()
        axis = shape.reach_mm * self.warming.growth(time_s) + shape.shift_mm + self._ringing_at(time_s)
        spread = np.zeros(time_s.shape)
        return BeamPoses(
            time_s, axis, spread + shape.beam_rad, spread + shape.height_mm, spread + shape.white_mm
        )

    def _at_rest(self) -> _Shape:
        """Return the shape at the end; there one reading follows another, so it is worked out once."""
        if self._rest_shape is None:
            self._rest_shape = self._shape(np.ones(1))
        return self._rest_shape

    def _shape(self, done: Floats) -> _Shape:
        leg, part = self.motion.legs(done)
        j1, j2, j3, j4 = (self.motion.knots[leg] + part[:, None] * self.motion.steps[leg]).T
        play1, play2, play4 = self._play_on(leg, part)
        turn1 = _TO_RAD * j1 + self._tables[0].deviation_rad(j1, play1)
        turn2 = turn1 + _TO_RAD * j2 + self._tables[1].deviation_rad(j2, play2)
        turn4 = turn2 + _TO_RAD * j4 + self._tables[2].deviation_rad(j4, play4)
        link1, link2 = np.exp(1j * turn1), np.exp(1j * turn2)
        (xy0, white0), (xy1, white1) = self._scatter_from, self._scatter_to
        shift = self._radial[0].shift_mm(j1) + link1 * self._radial[1].shift_mm(j2)
        shift += link2 * self._radial[2].shift_mm(j4) + (xy0 + done * (xy1 - xy0))
        reach = self._truth.link1_mm * link1 + self._truth.link2_mm * link2
        return _Shape(reach, shift, turn4 + self._truth.theta40_rad, j3, white0 + done * (white1 - white0))

    def _begin(self, motion: Motion, *, goes_on: bool = False) -> None:
        """Start a motion; one that goes on belongs to the same stream as the one before."""
        now = np.array([motion.start_s])
        done = float(self.motion.done(now)[0])
        play = self.play_at(motion.start_s)
        if goes_on:
            self._kick_mm = 0j
        left = self._phasors_at(now)[:, 0]
        self._ringing = np.where(np.abs(left) > _CALM_MM, left, 0.0)
        (xy0, w0), (xy1, w1) = self._scatter_from, self._scatter_to
        self._scatter_from = (xy0 + done * (xy1 - xy0), w0 + done * (w1 - w0))
        turned = bool(np.any(np.abs(motion.steps[:, :2]) > SHORTEST))
        if not goes_on:
            self._stream_mm = 0.0
            self._scatter_to = self._scatter_from
        if motion.profile.duration_s and (not goes_on or (turned and not self._scattered)):
            self._scatter_to = self._draw_scatter(turned=turned)
            self._scattered = turned
        self.motion = motion
        self.warming.begin(motion)
        self.gliding = False
        self._plan_play(play)
        self._kick_mm = self._kick()
        self._rest_shape = None

    def _plan_play(self, play: Floats) -> None:
        """Work out the play at the start of each leg, and what it would change by on it without its bounds."""
        legs = len(self.motion.steps)
        self._play, self._play_steps = np.empty((3, legs)), np.empty((3, legs))
        for k, joint in enumerate(_PLAY_JOINTS):
            width_deg = self._tables[k].width_deg(self.motion.knots[:-1, joint])
            travel_deg = np.maximum(width_deg, self._dynamics.reversal_travel_deg)
            self._play_steps[k] = 2.0 * self.motion.steps[:, joint] / travel_deg
            changes = self._play_steps[k, :-1].tolist()
            self._play[k] = list(accumulate(changes, _played, initial=float(play[k])))

    def _play_on(self, leg: Ints, part: Floats) -> Floats:
        """Return the states of the play on legs of the motion, -1...1, shape (3, n)."""
        play: Floats = self._play[:, leg] + part * self._play_steps[:, leg]
        return np.minimum(np.maximum(play, -1.0, out=play), 1.0, out=play)

    def _draw_scatter(self, *, turned: bool) -> tuple[complex, float]:
        """Return the scatter of an arrival, mm in the plane and along the beam; J1 and J2 turned or stood."""
        x, y, white = (float(value) for value in self._arrivals.standard_normal(3))
        new_mm = complex(x, y) * self._budget.repeatability_um * 1e-3
        return new_mm if turned else self._scatter_from[0], white * self._budget.white_um * 1e-3

    def _kick(self) -> complex:
        """Return the ringing that the end of the motion excites, mm."""
        if not self._budget.vibration_um:
            return 0j
        chords = np.diff(self._shape(self.motion.marks).reach_mm)
        lengths = np.abs(chords)
        moved = np.flatnonzero(lengths)
        if not moved.size:
            return 0j
        self._stream_mm += float(lengths.sum())
        # Very small ways excite in proportion to their size, in the direction of the arrival.
        size_um = self._budget.vibration_um * min(1.0, self._stream_mm)
        return complex(size_um * 1e-3 * chords[moved[-1]] / lengths[moved[-1]])

    def _phasors_at(self, time_s: Floats) -> Plane:
        """Return the complex amplitudes of the ringing in x and y, mm, shape (2, n)."""
        old = np.exp(self._ring_rate * (time_s - self.motion.start_s))
        after_s = time_s - self.motion.end_s
        fresh = np.where(after_s > 0.0, np.exp(self._ring_rate * np.maximum(after_s, 0.0)), 0.0)
        return np.stack(
            [
                self._ringing[0] * old + self._kick_mm.real * fresh,
                self._ringing[1] * old + self._kick_mm.imag * fresh,
            ]
        )

    def _ringing_at(self, time_s: Floats) -> Plane | float:
        shaken = self._shaken_at(time_s)
        if not (self._ringing.any() or self._kick_mm):
            return shaken
        x, y = self._phasors_at(time_s).imag
        ringing: Plane = x + 1j * y + shaken
        return ringing

    def _shaken_at(self, time_s: Floats) -> Plane | float:
        """Return the ringing that something beside the arm excites, mm: the axis runs around a circle."""
        size_mm, from_s, until_s = self._vibration
        if time_s[-1] <= from_s or time_s[0] >= until_s + 2.0 * self._calm_s:
            return 0.0
        decay_s = self._budget.vibration_decay_s
        grown = -np.expm1(-np.maximum(np.minimum(time_s, until_s) - from_s, 0.0) / decay_s)
        left = np.exp(-np.maximum(time_s - until_s, 0.0) / decay_s)
        turn = np.exp(2j * np.pi * self._budget.vibration_hz * (time_s - from_s))
        shaken: Plane = size_mm * grown * left * turn
        return shaken

    def _calm_steps(self) -> int:
        ringing = bool(self._kick_mm) or bool(self._ringing.any())
        return int(np.ceil(self._calm_s / _STEP_S)) if ringing else 0

    @property
    def _calm_s(self) -> float:
        """Time in which ringing dies away."""
        return 5.0 * self._budget.vibration_decay_s


def _played(play: float, change: float) -> float:
    return min(1.0, max(-1.0, play + change))


def scara_bench(truth: TrueArm, config: EmulationConfig, on_event: OnEvent | None = None) -> Bench:
    """Return the bench on which a true arm stands; see `Bench`."""
    return Bench(ScaraArm(truth, config), truth.reflectors, config, on_event)
