"""An ideal arm whose beam has an offset, a pitch and a height of its own, and screws that move it."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from catseye.procedures.kit.context import Measurement, Prompt
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.tasks import TurnScrew
from catseye.procedures.scara.bench import Alignment, ScaraBench
from tests.unit.procedures.benches import STILL_AIR, IdealContext, arm_xy, bench, with_axes


def mounted_bench(**alignment: Any) -> ScaraBench:
    """Return the paper's bench with a range of J3 and screws."""
    base = bench()
    optics = replace(base.optics, signal_min=0.1)
    lifted = with_axes(base, j3_mm=(40.0, 60.0))
    return replace(
        lifted, j3_mm=50.0, j3_range_mm=(40.0, 60.0), optics=optics, alignment=Alignment(**alignment)
    )


@dataclass
class MountContext(IdealContext):
    """Hands turn screws as they are asked; the mount follows as its true screws have it.

    Attributes:
        offset_mm: the beam passes the J4 axis so far on its left.
        pitch_mrad: the beam rises.
        height_mm: J3 at which the beam starts at the height of the reflectors.
        stage_mm: what one clockwise turn adds to the offset.
        level_mrad: what one clockwise turn adds to the pitch.
        noise_mm: of a distance.
        hands: what hands do when they are asked for a turn of so many turns.
        turned: what was turned.
    """

    offset_mm: float = 0.0
    pitch_mrad: float = 0.0
    height_mm: float = 50.0
    stage_mm: float = 0.5
    level_mrad: float = 2.0
    noise_mm: float = 3e-5
    hands: Callable[[float], float] = lambda turns: turns
    turned: list[tuple[str, float]] = field(default_factory=list)
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(5))

    def length_mm(self) -> float | None:
        """Return the length along the beam from abreast of the J4 axis to abreast of a reflector it hits."""
        if self.blocked(self.pose):
            return None
        one, two, three, four = self.pose
        x, y = arm_xy(one, two)
        world = math.radians(one + two + four + self.theta40_deg)
        cosine, sine = math.cos(world), math.sin(world)
        for px, py in self.places.values():
            ahead = (px - x) * cosine + (py - y) * sine
            left = (py - y) * cosine - (px - x) * sine
            above = three + math.tan(self.pitch_mrad * 1e-3) * ahead - self.height_mm
            if ahead > 0.0 and math.hypot(left - self.offset_mm, above) <= self.acceptance_mm:
                return ahead
        return None

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Return the distance with its noise."""
        measured = await super().measure(settle_time_s, dwell_time_s, readings)
        noisy = measured.displacement_mm + float(self.rng.normal(0.0, self.noise_mm))
        return replace(measured, displacement_mm=noisy, air=STILL_AIR)

    async def zero(self, dead_path_mm: float) -> None:
        """Begin a new count."""
        assert dead_path_mm > 0.0
        length = self.length_mm()
        self.zeros += 1
        self.lost = length is None
        self.zero_mm = length or 0.0

    async def ask(self, prompt: Prompt, watch: Any = None) -> str:
        """Let hands do what the prompt asks for, then answer it."""
        self.prompts.append(prompt)
        if watch is not None:
            shown: Live = await watch()
            self.show(shown)
        if isinstance(prompt.task, TurnScrew):
            self.turn(prompt.task.screw, prompt.task.turns)
        answer = self.answers.get(prompt.id, "yes" if prompt.kind == "confirm" else prompt.safe_answer)
        assert answer is not None, f"nobody answers {prompt.id}"
        return answer(prompt) if callable(answer) else answer

    def turn(self, screw: str, turns: float) -> None:
        """Turn a screw, as these hands do."""
        done = self.hands(turns)
        self.turned.append((screw, done))
        if screw == "stage":
            self.offset_mm += done * self.stage_mm
        else:
            self.pitch_mrad += done * self.level_mrad
        # The beam wanders over the reflector while the mount is touched.
        self.lost = True
