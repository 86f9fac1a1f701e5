"""The bench on which a serial arm stands."""

import numpy as np

from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.errors import BenchError
from catseye.simulators.world.motion import SHORTEST
from catseye.simulators.world.serial.arm_beam import ArmBeam
from catseye.simulators.world.serial.ballbar import Ballbar
from catseye.simulators.world.serial.cmm import OpticalCmm
from catseye.simulators.world.serial.driven_arm import DrivenArm
from catseye.simulators.world.serial.room import Room
from catseye.simulators.world.serial.tracker import LaserTracker
from catseye.simulators.world.timed_bench import OnEvent, TimedBench, listed
from catseye.simulators.world.types import Floats

_MOMENT_S = 1e-3


class SerialBench(TimedBench):
    """A serial arm on bench time.

    Args:
        plant: the arm with its drives.
        on_event: called with motions, stops and arrivals.

    Attributes:
        beam: of the interferometer beside the arm.
        room: what stands around the arm, and the nests that trackers see.
        tracker: the laser tracker in the room.
        cmm: the optical CMM in the room.
        ballbar: that hands put between arm and table.
        readback_deg: standard deviation of what the controller reads back wrongly: half of its variance is the
            joint's own, half is drawn at each motion.
    """

    beam: ArmBeam
    counts_encoders = True

    def __init__(self, plant: DrivenArm, config: EmulationConfig, on_event: OnEvent | None = None) -> None:
        super().__init__(config)
        self.plant = plant
        self.beam = ArmBeam(plant, config, self._air.index_at, lambda: self.time_s)
        bodies = () if config.serial is None else config.serial.bodies
        self.room = Room(plant, bodies, config, lambda: self.time_s)
        self.tracker = LaserTracker(self.room, config, lambda: self.time_s)
        self.cmm = OpticalCmm(self.room, config, lambda: self.time_s)
        self.beside = [self.tracker, self.cmm]
        self.ballbar = Ballbar(self.room, config, lambda: self.time_s)
        self.readback_deg = 0.0
        self._seed = config.seed
        self._on_event = on_event or (lambda _text: None)
        self._arrived = True

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints from the base outwards."""
        return self.plant.names

    def joint_named(self, name: str) -> int:
        """Return the number of a joint, from 1.

        Raises:
            BenchError: there is no such joint.
        """
        if name not in self.joint_names:
            raise BenchError(f"there is no joint {name!r}; there are {', '.join(self.joint_names)}")
        return self.joint_names.index(name) + 1

    @property
    def joints(self) -> Joints:
        """Joints as commanded at this moment, deg or mm."""
        return self.plant.motion.joints_at(self.time_s)

    @property
    def true_joints(self) -> Joints:
        """Joints as they really are at this moment, deg or mm."""
        return self.plant.true_joints(self.time_s)

    @property
    def tracked_mm(self) -> tuple[float, float]:
        """True position of the flange at this moment, x and y, mm."""
        x_mm, y_mm = self.plant.screws.frames(np.array([self.true_joints]))[0, -1, :2, 3]
        return float(x_mm), float(y_mm)

    @property
    def measured(self) -> Joints:
        """Joints as the encoders show them at this moment, deg or mm."""
        shown = self.plant.measured(self.time_s)
        if not self.readback_deg:
            return shown
        draws = [np.random.default_rng([self._seed, 44, n]) for n in (0, 1 + self.plant.motions_begun)]
        off = sum(rng.standard_normal(len(shown)) for rng in draws) * np.sqrt(0.5) * self.readback_deg
        return tuple((np.array(shown) + off).tolist())

    @property
    def encoder_counts(self) -> tuple[int, ...]:
        """Counts of the encoders at this moment, from the joints' zeros on."""
        return self.plant.encoder_counts(self.time_s)

    @property
    def torques_nm(self) -> tuple[float, ...]:
        """Torques of the drives at this moment, N m, or N of joints that slide."""
        return self.plant.torques_nm(self.time_s)

    def joints_at(self, time_s: float) -> Joints:
        """Return the joints as commanded at a moment of the present motion or after it, deg or mm."""
        return self.plant.motion.joints_at(time_s)

    @property
    def destination(self) -> Joints:
        """Joints as commanded at the end of the present motion, deg or mm."""
        return self.plant.motion.end

    @property
    def moving(self) -> bool:
        """A motion is commanded."""
        return self.time_s < self.plant.motion.end_s

    @property
    def standstill_s(self) -> float:
        """Bench time at which the present or last commanded motion ends, s."""
        return self.plant.motion.end_s

    def velocity_mm_s(self) -> float:
        """Return the displacement rate over the last millisecond, mm/s; 0 without a beam."""
        return self.beam.rate_mm_s(max(0.0, self.time_s - _MOMENT_S), self.time_s)

    def move_to(self, target: Joints, override_percent: float = 100.0, accel_percent: float = 100.0) -> None:
        """Start a synchronous motion of all axes; see `DrivenArm.move_to`.

        Raises:
            BenchError: the arm moves already.
        """
        self._require_rest()
        self.beam.observe()
        self.plant.move_to(target, self.time_s, override_percent / 100.0, accel_percent / 100.0)
        self._begun(f"motion to {listed(target)} at {override_percent:g} %")

    def follow(self, times_s: Floats, joints: Floats) -> None:
        """Start a motion through knots; see `DrivenArm.follow`.

        Raises:
            BenchError: the arm moves already.
        """
        self._require_rest()
        self.beam.observe()
        self.plant.follow(times_s, joints, self.time_s)
        self._begun(f"way through {times_s.size} knots to {listed(self.plant.motion.end)}")

    def stop(self) -> None:
        """Decelerate to a standstill; without a motion nothing happens."""
        if not self.moving:
            return
        self.beam.observe()
        self.plant.brake(self.time_s)
        self._begun(f"stop towards {listed(self.plant.motion.end)}")

    def clear_faults(self) -> None:
        """Take away what stands in the beams, dims them or unlocks the laser, and put retroreflectors back."""
        self.clear_beam()
        self.room.put_back()
        self.readback_deg = 0.0
        self.beam.weaken(1.0)
        self.beam.set_laser(ready=True)

    def _begun(self, text: str) -> None:
        self.beam.plan_looks()
        self._on_event(text)
        self._arrived = not self.moving

    def _require_rest(self) -> None:
        if self.moving:
            raise BenchError("the arm moves already")
        self._note_arrival()

    def _pass_to(self, time_s: float) -> None:
        if time_s <= self.time_s:
            return
        self.beam.observe_until(time_s)
        if time_s > self.standstill_s + SHORTEST:
            self._note_arrival()
        self.time_s = time_s

    def _note_arrival(self) -> None:
        if self._arrived:
            return
        self._arrived = True
        self.time_s = self.standstill_s
        self._on_event(f"arrival at {listed(self.joints)}")
