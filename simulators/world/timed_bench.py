"""What every bench has, whatever arm stands on it: bench time, what is to be done at a moment of it, and the air."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar, Protocol

from catseye.simulators.config import EmulationConfig, Joints
from catseye.simulators.world.air import Air, AirSample
from catseye.simulators.world.counted_beam import CountedBeam
from catseye.simulators.world.types import Floats

OnEvent = Callable[[str], None]
"""Called with what happens on the bench, at the moment it happens."""


class Seeing(Protocol):
    """An instrument that looks through the room."""

    def block(self, duration_s: float | None) -> None:
        """Hold something into its sight, for a time in s or until it is taken away."""
        ...

    def unblock(self) -> None:
        """Take it away."""
        ...


class TimedBench(ABC):
    """Bench time and the air. Commands act at the present bench time; `advance` lets time pass.

    Results depend on the sequence of commands and their bench times, never on the steps of `advance`.

    Attributes:
        time_s: bench time, s.
        beam: what instruments look along.
        beside: further instruments in the room.
        counts_encoders: `measured` has the steps of encoders; otherwise a controller puts them in.
    """

    beam: CountedBeam
    counts_encoders: ClassVar[bool] = False

    def __init__(self, config: EmulationConfig) -> None:
        self.time_s = 0.0
        self.beside: list[Seeing] = []
        self._air = Air(config.air, config.seed)
        self._scheduled: list[tuple[float, Callable[[], None]]] = []

    @property
    @abstractmethod
    def joints(self) -> Joints:
        """Joints as commanded at this moment, deg or mm."""

    @property
    @abstractmethod
    def true_joints(self) -> Joints:
        """Joints as they really are at this moment, deg or mm."""

    @property
    @abstractmethod
    def tracked_mm(self) -> tuple[float, float]:
        """Where a tracker's target on the arm really is at this moment, x and y, mm."""

    @property
    @abstractmethod
    def measured(self) -> Joints:
        """Joints as the encoders on the motors show them at this moment, deg or mm."""

    @abstractmethod
    def joints_at(self, time_s: float) -> Joints:
        """Return the joints as commanded at a moment of the present motion or after it, deg or mm."""

    @property
    @abstractmethod
    def destination(self) -> Joints:
        """Joints as commanded at the end of the present motion, deg or mm."""

    @property
    @abstractmethod
    def moving(self) -> bool:
        """A motion is under way."""

    @property
    @abstractmethod
    def standstill_s(self) -> float:
        """Bench time at which the present or last motion ends, s."""

    @abstractmethod
    def move_to(self, target: Joints, override_percent: float = 100.0, accel_percent: float = 100.0) -> None:
        """Start a joint-interpolated motion.

        Args:
            target: joints to reach, deg or mm.
            override_percent: speed, per cent of the largest.
            accel_percent: acceleration, per cent of the largest.

        Raises:
            BenchError: the arm moves already.
        """

    @abstractmethod
    def follow(self, times_s: Floats, joints: Floats) -> None:
        """Start a motion through knots, straight and at constant speed from one to the next.

        Args:
            times_s: when each knot is passed, s from now, above 0 and increasing, shape (m,).
            joints: knots, deg or mm, shape (m, n).

        Raises:
            BenchError: the arm moves already, or the knots do not fit each other.
        """

    @abstractmethod
    def stop(self) -> None:
        """Decelerate to standstill; without a motion nothing happens."""

    @abstractmethod
    def velocity_mm_s(self) -> float:
        """Return the displacement rate at this moment, mm/s; 0 without a beam."""

    @abstractmethod
    def clear_faults(self) -> None:
        """End what goes wrong on the bench."""

    def block_beam(self, duration_s: float | None) -> None:
        """Stand before all instruments, for a time in s or until somebody goes away."""
        for seeing in (self.beam, *self.beside):
            seeing.block(duration_s)

    def clear_beam(self) -> None:
        """Go out of the way of all instruments."""
        for seeing in (self.beam, *self.beside):
            seeing.unblock()

    def advance(self, step_s: float) -> None:
        """Let bench time pass, s."""
        self.advance_to(self.time_s + step_s)

    def call_at(self, time_s: float, action: Callable[[], None]) -> None:
        """Have something done at a moment of bench time, before anything later happens.

        Args:
            time_s: bench time, s; a moment in the past is now, at the next `advance_to`.
            action: may command the arm and schedule further calls.
        """
        self._scheduled.append((max(time_s, self.time_s), action))

    def advance_to(self, time_s: float) -> None:
        """Let bench time pass up to a moment, with all that is to be done until then; the past is left alone."""
        while due := [at for at in self._scheduled if at[0] <= time_s]:
            first = min(due, key=lambda at: at[0])
            self._scheduled.remove(first)
            self._pass_to(first[0])
            first[1]()
        self._pass_to(time_s)
        if not self.moving:
            self._note_arrival()

    def air(self) -> AirSample:
        """Return the air's state at this moment."""
        return self._air.at(self.time_s)

    def air_index(self) -> float:
        """Return the refractive index of the air for a helium-neon laser at this moment."""
        return self._air.index_at(self.time_s)

    @abstractmethod
    def _pass_to(self, time_s: float) -> None:
        """Let bench time pass up to a moment at which nothing was to be done before; the past is left alone."""

    @abstractmethod
    def _note_arrival(self) -> None:
        """Report the end of a motion, once."""


def listed(joints: Joints) -> str:
    """Return joints for the journal."""
    return ", ".join(f"{value:.3f}" for value in joints)
