"""How the interferometer is mounted on the arm: angle, offset, pitch and height of its beam, and their screws."""

import math

import numpy as np

from catseye.simulators.config import EmulationConfig, Screws


class Screw:
    """A screw with play, turned by hand.

    Args:
        setting_turns: standard deviation with which a turn is set.
        play_turns: what is lost when the sense of turning changes.

    Attributes:
        turns: what the head has turned so far, clockwise positive.
    """

    def __init__(self, rng: np.random.Generator, setting_turns: float, play_turns: float) -> None:
        self.turns = 0.0
        self._rng = rng
        self._setting_turns = setting_turns
        # The screw was turned clockwise last: it pushes what it moves.
        self._slack = self._half_play = play_turns / 2.0

    def turn(self, turns: float) -> float:
        """Turn the head; the play of the thread is taken up first.

        Args:
            turns: as asked for, clockwise positive; 0 leaves the screw alone.

        Returns:
            Turns that reach what the screw moves.
        """
        if not turns:
            return 0.0
        done = turns + self._setting_turns * float(self._rng.standard_normal())
        self.turns += done
        slack = min(self._half_play, max(-self._half_play, self._slack + done))
        moved = done - (slack - self._slack)
        self._slack = slack
        return moved


class Mount:
    """The beam's place and direction on the arm.

    Args:
        config: how the beam lies and what its screws do; what is None is drawn from the seed.
        start_height_mm: height of the arm at bench time 0.

    Attributes:
        offset_mm: lateral offset of the beam from the arm's last axis, positive to its left.
        pitch_rad: angle of the beam above the XY plane.
        height_mm: height of the arm at which the beam, where it starts, lies in the plane of the reflectors.
        turn_rad: angle by which the interferometer is turned about the last axis against its first mounting.
        ahead_mm: how much farther along the beam its length begins than in the first mounting.
        screws: by name: "stage" moves the beam to its side, "level" tilts it.
    """

    def __init__(self, config: EmulationConfig, start_height_mm: float) -> None:
        self._config: Screws = config.screws
        drawn = _as_mounted(config.seed) if config.unaligned else _as_aligned(config.seed)
        offset_mm, pitch_mrad, height_mm = drawn
        self.offset_mm = offset_mm if config.beam_offset_mm is None else config.beam_offset_mm
        self.pitch_rad = 1e-3 * (pitch_mrad if config.beam_pitch_mrad is None else config.beam_pitch_mrad)
        level_mm = config.beam_height_mm
        self.height_mm = start_height_mm + height_mm if level_mm is None else level_mm
        self.turn_rad = 0.0
        self.ahead_mm = 0.0
        self._remounting = config.remounting
        self._hands = np.random.default_rng([config.seed, 15])
        rng = np.random.default_rng([config.seed, 12])
        hand = (rng, self._config.setting_turns, self._config.play_turns)
        self.screws = {"stage": Screw(*hand), "level": Screw(*hand)}

    def remount(self, turned_deg: float) -> None:
        """Take the interferometer off and mount it turned; its beam lies otherwise than before.

        Args:
            turned_deg: angle about the last axis against the first mounting, as asked for.
        """
        scatter = self._remounting
        turn, offset, pitch, height, ahead = (float(value) for value in self._hands.standard_normal(5))
        self.turn_rad = math.radians(turned_deg + scatter.turn_deg * turn)
        self.offset_mm += scatter.offset_mm * offset
        self.pitch_rad += 1e-3 * scatter.pitch_mrad * pitch
        self.height_mm += scatter.height_mm * height
        self.ahead_mm = scatter.ahead_mm * ahead

    def turn(self, screw: str, turns: float) -> None:
        """Turn a screw, clockwise positive.

        Raises:
            KeyError: there is no screw of that name.
        """
        moved = self.screws[screw].turn(turns)
        if screw == "stage":
            self.offset_mm += self._config.stage_mm_per_turn * moved
            return
        tilt_rad = 1e-3 * self._config.level_mrad_per_turn * moved
        self.pitch_rad += tilt_rad
        # The pivot lies behind the place where the beam passes that axis.
        self.height_mm -= self._config.level_lever_mm * tilt_rad


def _as_aligned(seed: int) -> tuple[float, float, float]:
    """Return offset, mm, pitch, mrad, and error of the height, mm, as a good alignment leaves them."""
    offset_mm = float(np.random.default_rng([seed, 5]).normal(0.0, 0.1))
    return offset_mm, float(np.random.default_rng([seed, 11]).normal(0.0, 0.05)), 0.0


def _as_mounted(seed: int) -> tuple[float, float, float]:
    """Return the same of a beam that nobody has aligned yet."""
    rng = np.random.default_rng([seed, 13])
    sides = rng.choice((-1.0, 1.0), 2)
    offset_mm, pitch_mrad = sides * rng.uniform((0.4, 0.6), (0.9, 1.5))
    return float(offset_mm), float(pitch_mrad), float(rng.uniform(-1.5, 1.5))
