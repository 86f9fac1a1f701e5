"""Recordings made by hand as files: a joint that goes to its next plateau within 0.4 s of each move."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.calibration.core.types import Floats

STILL_S = 60.0
DWELL_S = 5.0
RATIO = 1.072267


@dataclass(frozen=True)
class Files:
    """Files of one test."""

    recording: Path
    moves: Path


def write_test(
    folder: Path,
    command_deg: Sequence[float],
    moved_deg: Sequence[float],
    *,
    spacing_mm: float = 30.0,
    noise_deg: float = 1e-6,
    ahead_s: float = 0.0,
    rate_hz: float = 50.0,
    zero_deg: float = 0.0,
) -> Files:
    """Write recording and moves of a test.

    Args:
        folder: to write to.
        command_deg: what was commanded.
        moved_deg: what the joint did.
        spacing_mm: of the angular optics; the displacement is S · sin θ.
        noise_deg: standard deviation of a sample.
        ahead_s: the recording's clock minus that of the moves.
        rate_hz: samples a second.
        zero_deg: angle of the optics from parallel at the beginning, where the displacement is 0.
    """
    times_s: Floats = STILL_S + DWELL_S * np.arange(len(command_deg), dtype=np.float64)
    t_s = np.arange(0.0, float(times_s[-1]) + DWELL_S + 2.0, 1.0 / rate_hz)
    angle_deg = angles(t_s, times_s, np.array(moved_deg))
    angle_deg = angle_deg + np.random.default_rng(1).normal(0.0, noise_deg, t_s.size)
    zero_rad = np.radians(zero_deg)
    displacement_mm = spacing_mm * (np.sin(np.radians(angle_deg) + zero_rad) - np.sin(zero_rad))
    recording, moves = folder / "recording.csv", folder / "moves.csv"
    _write(recording, "t_s,displacement_mm", t_s + ahead_s, displacement_mm)
    _write(moves, "t_s,command_deg", times_s, np.array(command_deg))
    return Files(recording, moves)


def decaying_commands(count: int = 109, direction: int = 1) -> Floats:
    """Return the commands of the paper's test, deg."""
    commands: Floats = direction * 0.1 / RATIO ** np.arange(count, dtype=np.float64)
    return commands


def angles(t_s: Floats, times_s: Floats, moved_deg: Floats) -> Floats:
    """Return where a joint is that goes to its next plateau smoothly and within 0.4 s, shape of `t_s`."""
    since_s = np.clip(t_s[:, None] - times_s, 0.0, 0.4)
    angle_deg: Floats = (0.5 * (1.0 - np.cos(np.pi * since_s / 0.4))) @ moved_deg
    return angle_deg


def _write(path: Path, header: str, first: Floats, second: Floats) -> None:
    rows = (f"{a:.6f},{b:.12g}" for a, b in zip(first, second, strict=True))
    path.write_text("\n".join([header, *rows]) + "\n", "utf-8")
