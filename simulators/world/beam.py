"""The beam that an arm carries from reflector to reflector."""

from collections.abc import Callable, Mapping

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import BenchError
from catseye.simulators.world.arm import Arm
from catseye.simulators.world.counted_beam import CountedBeam
from catseye.simulators.world.mount import Mount, Screw
from catseye.simulators.world.optics import Optics, Reflectors, Sight
from catseye.simulators.world.types import Floats


class Beam(CountedBeam):
    """The beam on its arm.

    Args:
        index_at: refractive index of the air at a bench time, s.
        now: bench time, s.
    """

    def __init__(
        self,
        arm: Arm,
        reflectors: Reflectors,
        config: EmulationConfig,
        index_at: Callable[[float], float],
        now: Callable[[], float],
    ) -> None:
        self._arm = arm
        self._optics = Optics(reflectors, config, float(arm.poses(np.zeros(1)).height_mm[0]))
        super().__init__(config, index_at, now, self._optics.path)

    def look(self, times_s: Floats) -> Sight:
        """Return what the beam meets at bench times, s, shape (n,); no counter notices."""
        return self._optics.look(self._arm.poses(times_s))

    def level(self, miss_mm: float) -> float:
        """Return the signal level, 0...1, of a beam that returns with a miss."""
        return self._optics.level(miss_mm)

    def name_of(self, place: int) -> str:
        """Return the name of a reflector by its place in a sight."""
        return self._optics.names[place]

    def move_reflector(self, name: str, dx_mm: float, dy_mm: float) -> None:
        """Shift a reflector; the counter counts what it sees of it.

        Raises:
            BenchError: there is no such reflector.
        """
        self._require_nest(name)
        self.observe()
        self._optics.move_reflector(name, complex(dx_mm, dy_mm))
        self._shift_target()

    def place_reflector(self, name: str) -> None:
        """Put the reflector into a nest and leave all others empty, or fill them all.

        Args:
            name: of the nest, or "all".

        Raises:
            BenchError: there is no such nest.
        """
        names = self._optics.names if name == "all" else [name]
        if name != "all":
            self._require_nest(name)
        self.observe()
        self._optics.remove_all_but(names)
        self.observe()
        self._optics.put(names)
        self.observe()

    @property
    def in_place(self) -> list[str]:
        """Names of the nests with a reflector in them."""
        return self._optics.in_place

    @property
    def mount(self) -> Mount:
        """How the beam lies on the arm."""
        return self._optics.mount

    def remount(self, turned_deg: float) -> None:
        """Take the interferometer off the arm and mount it turned; nothing is counted meanwhile.

        Args:
            turned_deg: angle about the last axis against the first mounting.
        """
        self.observe()
        with self._path.in_hand():
            self.observe()
            self.mount.remount(turned_deg)
        self.observe()

    @property
    def screws(self) -> Mapping[str, Screw]:
        """Screws of the mount by name."""
        return self.mount.screws

    def _turn(self, screw: str, turns: float) -> None:
        self.mount.turn(screw, turns)

    def _sample_times(self) -> Floats:
        return self._arm.sample_times()

    def _require_nest(self, name: str) -> None:
        if name not in self._optics.names:
            known = ", ".join(self._optics.names)
            raise BenchError(f"there is no reflector {name!r}; there are {known}")
