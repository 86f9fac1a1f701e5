"""Distances with the interferometer turned on J4's flange, from geometry written down here, not by the program.

Loops and plain trigonometry on purpose. J4's axis displaces with J4's own angle, in the frame of link 2: J4 stands at
the beam's angle less what the interferometer is turned.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.points import Points, concatenated
from tests.unit.calibration.scara.diagnostics.bench import (
    Extra,
    Pose,
    commands_on_nodes,
    measured,
    with_noise,
)
from tests.unit.calibration.scara.paper import Truth

Wave = list[tuple[float, float]]
"""Cosine and sine amplitudes of orders 1, 2, …, mm."""

HALF_TURN = math.pi


@dataclass(frozen=True)
class AxisMotion:
    """What J4's axis does in x and y of link 2's frame."""

    x: Wave
    y: Wave

    @classmethod
    def drawn(cls, rng: np.random.Generator, odd_mm: float, even_mm: float, orders: int = 5) -> "AxisMotion":
        """Draw a motion whose odd orders share one rms displacement, and its even orders another's share."""
        sizes = [(odd_mm if k % 2 else even_mm) / math.sqrt(orders) for k in range(1, orders + 1)]
        x, y = ([(rng.normal(0.0, s), rng.normal(0.0, s)) for s in sizes] for _ in "xy")
        return cls(x, y)

    def longer(self, beam: float, mount: float) -> float:
        """Return by how much a beam grows that leaves at an angle against link 2."""
        j4 = beam - mount
        x, y = (
            sum(a * math.cos(k * j4) + b * math.sin(k * j4) for k, (a, b) in enumerate(wave, 1))
            for wave in (self.x, self.y)
        )
        return -x * math.cos(beam) - y * math.sin(beam)

    def along_first_beam(self, order: int) -> tuple[float, float]:
        """Return the cosine and sine of an order in what it adds to beams of the first mounting, mm."""
        angles = [2.0 * math.pi * i / 64 for i in range(64)]
        cosine, sine = (
            2.0 / 64.0 * sum(self.longer(angle, 0.0) * wave(order * angle) for angle in angles)
            for wave in (math.cos, math.sin)
        )
        return cosine, sine


def mounted(
    truth: Truth,
    longer: Callable[[float, float], float],
    mounts: Sequence[float],
    noise_mm: float = 0.0,
    seed: int = 1,
    commands: list[tuple[float, float, int, int]] | None = None,
) -> Points:
    """Return the paper's plan once in each mounting, each with segments of its own.

    Args:
        longer: by how much a beam grows, by its angle against link 2 and the mounting.
        mounts: of each pass, rad.
    """
    parts = []
    for number, mount in enumerate(mounts):

        def length(pose: Pose, mount: float = mount) -> float:
            return longer(pose.beam, mount)

        part = measured(truth, commands or commands_on_nodes(), Extra(length=length))
        parts.append(
            replace(
                part,
                dead_path=part.dead_path + 3 * number,
                dead_paths=tuple((name, n) for n in range(len(mounts)) for name in part.reflector_names),
                mount_rad=np.full(len(part), mount),
            )
        )
    return with_noise(concatenated(parts), noise_mm, seed)


def jacobian(points: Points, truth: Truth) -> tuple[Floats, Floats]:
    """Return derivatives of the distances by links, node values, places and dead paths, and the beams' angles.

    By geometry at the nominal commands on nodes; columns in an order of its own.
    """
    commands = points.commands
    nodes1 = sorted(set(np.round(commands.theta1_rad, 9).tolist()))
    nodes2 = sorted(set(np.round(commands.theta2_rad, 9).tolist()))
    maps = 2 * len(nodes1) + 2 * len(nodes2)
    reflectors, paths = len(points.reflector_names), len(points.dead_paths)
    rows, beams = np.zeros((len(points), 2 + maps + 2 * reflectors + paths)), np.zeros(len(points))
    for i in range(len(points)):
        a, b = float(commands.theta1_rad[i]), float(commands.theta2_rad[i])
        elbow = truth.link1_mm * math.cos(a), truth.link1_mm * math.sin(a)
        fore = truth.link2_mm * math.cos(a + b), truth.link2_mm * math.sin(a + b)
        px, py = truth.reflectors[points.reflector[i]].tolist()
        x, y = elbow[0] + fore[0] - px, elbow[1] + fore[1] - py
        length = math.hypot(x, y)
        ux, uy = x / length, y / length
        beams[i] = math.atan2(-uy, -ux) - a - b
        rows[i, 0] = ux * math.cos(a) + uy * math.sin(a)
        rows[i, 1] = ux * math.cos(a + b) + uy * math.sin(a + b)
        up1, up2 = int(commands.direction1[i] < 0), int(commands.direction2[i] < 0)
        k1 = 2 + up1 * len(nodes1) + nodes1.index(round(a, 9))
        k2 = 2 + 2 * len(nodes1) + up2 * len(nodes2) + nodes2.index(round(b, 9))
        rows[i, k1] = uy * (elbow[0] + fore[0]) - ux * (elbow[1] + fore[1])
        rows[i, k2] = uy * fore[0] - ux * fore[1]
        place = 2 + maps + 2 * int(points.reflector[i])
        rows[i, place], rows[i, place + 1] = -ux, -uy
        rows[i, 2 + maps + 2 * reflectors + int(points.dead_path[i])] = -1.0
    return rows, beams
