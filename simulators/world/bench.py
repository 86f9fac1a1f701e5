"""The bench as one thing: arm, beam and air on one bench time."""

import numpy as np

from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.errors import BenchError
from catseye.simulators.world.arm import Arm
from catseye.simulators.world.axis_gauge import AxisGauge
from catseye.simulators.world.beam import Beam
from catseye.simulators.world.motion import SHORTEST
from catseye.simulators.world.optics import NOBODY, Reflectors
from catseye.simulators.world.timed_bench import OnEvent, TimedBench, listed
from catseye.simulators.world.types import Floats, TrueState

_MOMENT_S = 1e-3
"""Speeds are taken over this time."""


class Bench(TimedBench):
    """The physical truth of an arm that carries a beam.

    Args:
        on_event: called with motions, stops and arrivals.

    Attributes:
        beam: that the arm carries.
        gauge: a ball and indicators for the axes of its joints.
    """

    beam: Beam

    def __init__(
        self, arm: Arm, reflectors: Reflectors, config: EmulationConfig, on_event: OnEvent | None = None
    ) -> None:
        if not reflectors:
            raise BenchError("a bench needs at least one reflector")
        super().__init__(config)
        self._arm = arm
        self.beam = Beam(arm, reflectors, config, self._air.index_at, lambda: self.time_s)
        self.gauge = AxisGauge(arm, config, lambda: self.time_s)
        self._on_event = on_event or (lambda _text: None)
        self._arrived = True
        self._streams = False
        self._slip: Floats = np.zeros(len(arm.motion.end))

    @property
    def joints(self) -> Joints:
        """Joints as commanded at this moment, deg or mm."""
        return self._arm.motion.joints_at(self.time_s)

    @property
    def true_joints(self) -> Joints:
        """Joints as they really are at this moment, deg or mm."""
        return self._arm.true_joints(self.time_s)

    @property
    def measured(self) -> Joints:
        """Joints as the encoders show them: the drives of this bench follow exactly, all errors come behind them."""
        return self.joints

    @property
    def tracked_mm(self) -> tuple[float, float]:
        """True position of the axis that turns the beam at this moment, mm."""
        return self.true_state().axis_mm

    def joints_at(self, time_s: float) -> Joints:
        """Return the joints as commanded at a moment of the present motion or after it."""
        return self._arm.motion.joints_at(time_s)

    def end_mm(self, times_s: Floats) -> Floats:
        """Return where the end of the arm really is at bench times, shape (m, 3).

        Before the start of the present motion it stood where that began.
        """
        poses = self._arm.poses(np.maximum(times_s, self._arm.motion.start_s))
        return np.column_stack([poses.axis_mm.real, poses.axis_mm.imag, poses.height_mm])

    @property
    def destination(self) -> Joints:
        """Joints at the end of the present motion."""
        return self._arm.motion.end

    @property
    def moving(self) -> bool:
        """A motion is under way."""
        return self.time_s < self._arm.motion.end_s

    @property
    def standstill_s(self) -> float:
        """Bench time at which the present or last motion ends, s."""
        return self._arm.motion.end_s

    def _pass_to(self, time_s: float) -> None:
        if time_s <= self.time_s:
            return
        self.beam.observe_until(time_s)
        if time_s > self.standstill_s + SHORTEST:
            self._note_arrival()
        self.time_s = time_s

    def _note_arrival(self) -> None:
        """Report the end of a motion; at its very end something that is to be done may still continue it."""
        if self._arrived:
            return
        self._arrived = True
        self.time_s = self.standstill_s
        self._on_event(f"arrival at {listed(self.destination)}")

    def move_to(self, target: Joints, override_percent: float = 100.0, accel_percent: float = 100.0) -> None:
        """Start a joint-interpolated motion.

        Args:
            target: joints to reach, deg or mm.
            override_percent: speed, per cent of the largest.
            accel_percent: acceleration, per cent of the largest.

        Raises:
            BenchError: the arm moves already.
        """
        self._require_rest()
        self.beam.observe()
        target = self._slipped(np.array(target))
        self._arm.move_to(target, self.time_s, override_percent / 100.0, accel_percent / 100.0)
        self._on_event(f"motion to {listed(target)} at {override_percent:g} %")
        self._streams = False
        self._restart_looks()

    def follow(self, times_s: Floats, joints: Floats) -> None:
        """Start a motion through knots, straight and at constant speed from one to the next.

        Args:
            times_s: when each knot is passed, s from now, above 0 and increasing, shape (m,).
            joints: knots, deg or mm, shape (m, n).

        Raises:
            BenchError: the arm moves already, or the knots do not fit each other.
        """
        self._require_rest()
        if (
            not times_s.size
            or joints.shape != (times_s.size, self._slip.size)
            or np.any(np.diff(times_s, prepend=0.0) <= 0.0)
        ):
            raise BenchError(
                f"a way needs knots of {self._slip.size} joints, and times above 0 that increase"
            )
        self.beam.observe()
        joints = np.concatenate([joints[:-1], [self._slipped(joints[-1])]])
        self._arm.follow(times_s, joints, self.time_s)
        self._on_event(f"way through {times_s.size} knots to {listed(self.destination)}")
        self._streams = False
        self._restart_looks()

    def begin_stream(self) -> None:
        """Take note that the glides from now on are of another stream of set points."""
        self._streams = False

    def glide(self, target: Joints, duration_s: float) -> None:
        """Move at constant speed to joints within a time, s: one cycle of real-time control.

        Consecutive glides join without standing still; one that comes early leaves the one before where it is. Where
        set points come late the arm comes to rest within a stream, which then goes on.

        Raises:
            BenchError: the arm moves otherwise than by a glide.
        """
        if self.moving and not self._arm.gliding:
            raise BenchError("the arm moves already")
        self.beam.observe()
        rested = self._arrived
        if self._arm.glide(target, self.time_s, duration_s):
            if rested:
                begins = "goes on from" if self._streams else "from"
                self._on_event(f"stream {begins} {listed(self._arm.motion.start)}")
            self._streams = True
            self._restart_looks()

    def _require_rest(self) -> None:
        if self.moving:
            raise BenchError("the arm moves already")
        self._note_arrival()

    def stop(self) -> None:
        """Decelerate to standstill; without a motion nothing happens."""
        if not self.moving:
            return
        self.beam.observe()
        self._arm.stop(self.time_s)
        self._on_event(f"stop towards {listed(self.destination)}")
        self._streams = False
        self._restart_looks()

    def velocity_mm_s(self) -> float:
        """Return the displacement rate at this moment, mm/s; 0 without a beam."""
        return self.beam.rate_mm_s(*self._moment())

    def _moment(self) -> tuple[float, float]:
        """Return the millisecond before now, or that after the start of the present motion, s."""
        start_s = self._arm.motion.start_s
        if self.time_s - start_s >= _MOMENT_S:
            return self.time_s - _MOMENT_S, self.time_s
        return start_s, max(self.time_s, min(start_s + _MOMENT_S, self.standstill_s))

    def true_state(self) -> TrueState:
        """Return the truth of this moment; nothing on the bench notices."""
        now = np.array([self.time_s])
        poses = self._arm.poses(now)
        sight = self.beam.look(now)
        axis = complex(poses.axis_mm[0])
        nearest = self.beam.name_of(int(sight.nearest[0]))
        return TrueState(
            axis_mm=(axis.real, axis.imag),
            joints=self.true_joints,
            beam_deg=float(np.rad2deg(poses.beam_rad[0] + self.beam.mount.turn_rad)),
            play=tuple(float(state) for state in self._arm.play_at(self.time_s)),
            reflector=nearest if sight.index[0] != NOBODY else None,
            nearest=nearest,
            miss_mm=float(sight.miss_mm[0]),
            length_mm=float(sight.length_mm[0]),
        )

    def shake(self, amplitude_mm: float, duration_s: float) -> None:
        """Keep the arm ringing from now on for a time, s."""
        self.beam.observe()
        self._arm.shake(amplitude_mm, self.time_s, self.time_s + duration_s)
        self.beam.plan_looks()

    def slip(self, joint: int, by: float) -> None:
        """Let the next motion end beside its target, as after a collision; the encoders show where.

        Real-time streams are left alone.

        Args:
            joint: its number, from 1.
            by: how far, deg or mm.
        """
        self._slip[joint - 1] = by

    def clear_faults(self) -> None:
        """Take away what stands in the beam, shakes, dims, unlocks the laser or waits to let a joint slip."""
        self.clear_beam()
        self.beam.weaken(1.0)
        self.shake(0.0, 0.0)
        self.beam.set_laser(ready=True)
        self._slip[:] = 0.0

    def _slipped(self, target: Floats) -> Joints:
        slipped = tuple((target + self._slip).tolist())
        self._slip[:] = 0.0
        return slipped

    def _restart_looks(self) -> None:
        self.beam.plan_looks()
        self._arrived = not self.moving
