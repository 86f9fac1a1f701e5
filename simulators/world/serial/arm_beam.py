"""The beam of an interferometer on a tripod to what hands have fastened to a serial arm."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from catseye.simulators.config import EmulationConfig, ErrorBudget
from catseye.simulators.errors import BenchError
from catseye.simulators.world.beam_path import BeamPath
from catseye.simulators.world.counted_beam import CountedBeam
from catseye.simulators.world.mount import Screw
from catseye.simulators.world.optics import NOBODY, Sight
from catseye.simulators.world.serial.driven_arm import DrivenArm
from catseye.simulators.world.serial.look_ahead import LookAhead
from catseye.simulators.world.serial.optics import (
    Mounting,
    Return,
    Wander,
    mount_angular,
    mount_linear,
    returned,
)
from catseye.simulators.world.types import Floats

SCREWS = ("pitch", "yaw")
"""They tilt the beam across the plane in which it should turn, and in it."""

_STEP_DEG = 0.05
_STEP_S = 0.005
_CALM_S = 0.75
_LOST = 10.0
"""Miss of a beam to nothing."""


class ArmBeam(CountedBeam):
    """The beam; until something is mounted it meets nothing.

    Args:
        arm: that carries the retroreflector.
        index_at: refractive index of the air at a bench time, s.
        now: bench time, s.

    Attributes:
        mounting: what the arm carries, None for nothing.
        spacing_mm: true distance of the prisms of the angular retroreflector.
    """

    def __init__(
        self,
        arm: DrivenArm,
        config: EmulationConfig,
        index_at: Callable[[float], float],
        now: Callable[[], float],
    ) -> None:
        self._arm = arm
        self._optics = optics = config.arm_optics
        rng = np.random.default_rng([config.seed, 22])
        self.spacing_mm = optics.spacing_mm + optics.u_spacing_mm * float(rng.standard_normal())
        self.mounting: Mounting | None = None
        self._tilts_rad: Floats = np.zeros(2)
        self._tripod_rad = Wander(rng, 1e-6 * optics.tripod_urad, (120.0, 3600.0))
        self._tripod_mm = Wander(rng, 1e-3 * optics.tripod_um, (120.0, 3600.0))
        self._turbulence_mm = Wander(rng, 1e-6 * optics.turbulence_nm, (0.3, 30.0))
        self._touches = 0
        self._hands = np.random.default_rng([config.seed, 23])
        hand = (self._hands, config.screws.setting_turns, config.screws.play_turns)
        self._screws = {name: Screw(*hand) for name in SCREWS}
        self._ahead = LookAhead(self._returned, self._state)
        super().__init__(replace(config, budget=_counted(config)), index_at, now, BeamPath())

    @property
    def screws(self) -> Mapping[str, Screw]:
        """Screws of the stage by name."""
        return self._screws

    @property
    def tilts_mrad(self) -> dict[str, float]:
        """How far the beam is misaligned, by the screws' names."""
        return dict(zip(SCREWS, (1e3 * self._tilts_rad).tolist(), strict=True))

    def look(self, times_s: Floats) -> Sight:
        """Return what the beam meets at bench times, s, shape (n,); no counter notices."""
        seen = self._ahead.at(float(times_s[0])) if times_s.size == 1 else self._returned(times_s)
        hit = (seen.miss <= 1.0) & ~self._path.blocked(times_s)
        nearest = np.zeros(times_s.size, dtype=np.int64)
        return Sight(times_s, np.where(hit, 0, NOBODY), seen.length_mm, seen.miss, nearest)

    def level(self, miss_mm: float) -> float:
        """Return the signal level, 0...1, of a beam that returns with a miss as a part of the largest."""
        return float(self._path.clearness * np.exp(-2.0 * miss_mm**2))

    def mount_angular(self, joint: int, lever_mm: float = 60.0, offset_mm: float = 0.0) -> None:
        """Fasten the angular retroreflector to what a joint turns, and lead the beam to it; nothing counts meanwhile.

        Args:
            joint: its number, from 1.
            lever_mm: distance from the joint's axis.
            offset_mm: along the beam, from the plane through that axis in which the retroreflector should stand.

        Raises:
            BenchError: there is no such joint, or it turns nothing.
        """
        links = self._links()
        if not 1 <= joint <= links.shape[1]:
            raise BenchError(f"there is no joint {joint}; the arm has {links.shape[1]}")
        if self._arm.screws.slides(joint):
            raise BenchError(f"joint {joint} slides: angular optics show nothing of it")
        directions, points = self._arm.screws.axes(links)
        home = self._arm.screws.frames(links)[0, joint]
        self._mount(
            mount_angular(joint, home, directions[0, joint - 1], points[0, joint - 1], lever_mm, offset_mm)
        )

    def mount_linear(self, direction: tuple[float, float, float]) -> None:
        """Fasten the linear retroreflector to the tool, with the beam along a direction of the base.

        Args:
            direction: of length 1.
        """
        home = self._arm.screws.frames(self._links())[0, -1]
        target_mm = np.array(self._optics.target_mm)
        self._mount(mount_linear(self._links().shape[1], home, np.array(direction), target_mm))

    def _mount(self, mounting: Mounting) -> None:
        self.observe()
        with self._path.in_hand():
            self.observe()
            sides = self._hands.choice((-1.0, 1.0), 2)
            most_rad = 1e-3 * self._optics.hand_tilt_mrad
            self._tilts_rad = sides * self._hands.uniform(0.4 * most_rad, most_rad, 2)
            self.mounting = mounting
            self._touches += 1
        self.observe()

    def _turn(self, screw: str, turns: float) -> None:
        moved = self._screws[screw].turn(turns)
        self._touches += 1
        self._tilts_rad[SCREWS.index(screw)] += 1e-3 * self._optics.mrad_per_turn * moved

    def _sample_times(self) -> Floats:
        motion = self._arm.motion
        fastest_deg_s = float(np.abs(motion.slopes).max()) * motion.profile.speed
        step_s = min(_STEP_S, _STEP_DEG / fastest_deg_s) if fastest_deg_s else _STEP_S
        duration_s = motion.profile.duration_s + _CALM_S
        times_s: Floats = motion.start_s + np.linspace(0.0, duration_s, int(np.ceil(duration_s / step_s)) + 1)
        return times_s

    def _state(self) -> tuple[int, int]:
        """Return what changes when the beam depends on bench time in another way than before."""
        return self._arm.motions_begun, self._touches

    def _returned(self, times_s: Floats) -> Return:
        if self.mounting is None:
            return Return(np.zeros(times_s.size), np.full(times_s.size, _LOST))
        frames = self._frames(self.mounting.frame, times_s)
        seen = returned(self.mounting, frames, self._tilts_rad, self.spacing_mm, self._optics)
        return Return(seen.length_mm + self._drift_mm(times_s), seen.miss)

    def _links(self) -> Floats:
        return self._arm.links_deg(np.array([self._now()]))

    def _frames(self, joint: int, times_s: Floats) -> Floats:
        return self._arm.screws.last_frame(self._arm.links_deg(times_s)[:, :joint])

    def _drift_mm(self, times_s: Floats) -> Floats:
        """Return what tripods and air add: to the angular optics, whose beams share them, their difference alone."""
        if self.mounting is not None and self.mounting.kind == "linear":
            return self._tripod_mm.at(times_s) + self._turbulence_mm.at(times_s)
        # A tenth of the turbulence differs between two beams beside each other.
        return self.spacing_mm * self._tripod_rad.at(times_s) + 0.1 * self._turbulence_mm.at(times_s)


def _counted(config: EmulationConfig) -> ErrorBudget:
    """Return what counters add: their wavelength is that of the budget, the rest is the optics' own."""
    optics = config.arm_optics
    return replace(
        config.budget,
        environment_um=0.0,
        counter_noise_um=1e-3 * optics.noise_nm,
        counter_resolution_um=1e-3 * optics.resolution_nm,
    )
