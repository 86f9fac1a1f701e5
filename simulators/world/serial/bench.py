"""The bench on which a serial arm stands."""

from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.errors import BenchError
from catseye.simulators.world.motion import SHORTEST
from catseye.simulators.world.serial.plant import SerialPlant
from catseye.simulators.world.timed_bench import OnEvent, TimedBench, listed
from catseye.simulators.world.types import Floats


class SerialBench(TimedBench):
    """A serial arm on bench time.

    Args:
        plant: the arm with its drives.
        on_event: called with motions, stops and arrivals.
    """

    def __init__(self, plant: SerialPlant, config: EmulationConfig, on_event: OnEvent | None = None) -> None:
        super().__init__(config)
        self.plant = plant
        self._on_event = on_event or (lambda _text: None)
        self._arrived = True

    @property
    def joints(self) -> Joints:
        """Joints as commanded at this moment, deg or mm."""
        return self.plant.motion.joints_at(self.time_s)

    @property
    def true_joints(self) -> Joints:
        """Joints as they really are at this moment, deg or mm."""
        return self.plant.true_joints(self.time_s)

    @property
    def measured(self) -> Joints:
        """Joints as the encoders show them at this moment, deg or mm."""
        return self.plant.measured(self.time_s)

    @property
    def torques_nm(self) -> tuple[float, ...]:
        """Torques of the drives at this moment, N m."""
        return self.plant.torques_nm(self.time_s)

    @property
    def moving(self) -> bool:
        """A motion is commanded."""
        return self.time_s < self.plant.motion.end_s

    @property
    def standstill_s(self) -> float:
        """Bench time at which the present or last commanded motion ends, s."""
        return self.plant.motion.end_s

    def move_to(self, target: Joints, speed_fraction: float) -> None:
        """Start a synchronous motion of all axes; see `SerialPlant.move_to`.

        Raises:
            BenchError: the arm moves already.
        """
        self._require_rest()
        self.plant.move_to(target, self.time_s, speed_fraction)
        self._begun(f"motion to {listed(target)} at {speed_fraction:.2%}")

    def follow(self, times_s: Floats, joints: Floats) -> None:
        """Start a motion through knots; see `SerialPlant.follow`.

        Raises:
            BenchError: the arm moves already.
        """
        self._require_rest()
        self.plant.follow(times_s, joints, self.time_s)
        self._begun(f"way through {times_s.size} knots to {listed(self.plant.motion.end)}")

    def brake(self) -> None:
        """Decelerate to a standstill; without a motion nothing happens."""
        if not self.moving:
            return
        self.plant.brake(self.time_s)
        self._begun(f"stop towards {listed(self.plant.motion.end)}")

    def clear_faults(self) -> None:
        """End what goes wrong on the bench: nothing yet does."""

    def _begun(self, text: str) -> None:
        self._on_event(text)
        self._arrived = not self.moving

    def _require_rest(self) -> None:
        if self.moving:
            raise BenchError("the arm moves already")
        self._note_arrival()

    def _pass_to(self, time_s: float) -> None:
        if time_s <= self.time_s:
            return
        if time_s > self.standstill_s + SHORTEST:
            self._note_arrival()
        self.time_s = time_s

    def _note_arrival(self) -> None:
        if self._arrived:
            return
        self._arrived = True
        self.time_s = self.standstill_s
        self._on_event(f"arrival at {listed(self.joints)}")
