"""A precision ball on the axis of a joint, and indicators that read it from the link that carries the joint."""

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import BenchError
from catseye.simulators.world.arm import Arm

Direction = Literal["x", "y"]
"""In which an indicator reads, in the frame of what carries the joint."""

_ACROSS: Final[dict[Direction, float]] = {"x": 0.0, "y": 0.5 * math.pi}
_FORM_ORDERS: Final = np.arange(2, 7)


@dataclass(frozen=True)
class _Mounted:
    """A ball with its indicators.

    Attributes:
        joint: number of the joint with which the ball turns, from 1.
        side: 1 with the indicators where they stand first, -1 with them on the other side and the ball turned.
        off_mm: place of the ball's centre beside the axis, in the frame of the link that turns.
        zero_mm: of the indicators, by their directions.
    """

    joint: int
    side: float
    off_mm: complex
    zero_mm: dict[Direction, float]


class AxisGauge:
    """The ball, its indicators, and what hands do with them.

    Args:
        config: how good they and the hands are.
        now: bench time, s.
    """

    def __init__(self, arm: Arm, config: EmulationConfig, now: Callable[[], float]) -> None:
        self._arm, self._quality, self._now = arm, config.axis_gauge, now
        rng = np.random.default_rng([config.seed, 60])
        self._gain = 1.0 + self._quality.gain * float(rng.standard_normal())
        form = rng.standard_normal(_FORM_ORDERS.size) / _FORM_ORDERS
        form *= 1e-3 * self._quality.form_um / float(np.linalg.norm(form))
        self._form_mm = form * np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, form.size))
        self._drift = rng.uniform(0.0, 2.0 * np.pi, 2)
        self._hands = np.random.default_rng([config.seed, 61])
        self._noise = np.random.default_rng([config.seed, 62])
        self._mounted: _Mounted | None = None
        self._arrived_s = -math.inf
        self._astray_mm = 0j

    def mount(self, joint: int, *, turned: bool) -> None:
        """Fasten the ball to what a joint turns, roughly on its axis, and set the indicators to it.

        Args:
            joint: its number, from 1.
            turned: the ball is turned by half a turn, and the indicators stand on the other side.

        Raises:
            BenchError: there is no such joint, or no room for a ball on its axis.
        """
        self._arm.axis_shift_mm(joint)
        x, y, *zero = self._hands.standard_normal(4).tolist()
        off_mm = 1e-3 * self._quality.off_centre_um * complex(x, y)
        zeros: dict[Direction, float] = {"x": 0.05 * zero[0], "y": 0.05 * zero[1]}
        self._mounted = _Mounted(joint, -1.0 if turned else 1.0, off_mm, zeros)

    def take_off(self) -> None:
        """Take ball and indicators away."""
        self._mounted = None

    def tap(self, by_um: float) -> None:
        """Push the ball towards the indicator in x, as it stands now; hands hit it within some of the way.

        Raises:
            BenchError: no ball is mounted.
        """
        ball = self._on_an_axis()
        hit, slip = self._hands.standard_normal(2).tolist()
        way_mm = 1e-3 * (by_um * (1.0 + self._quality.tap_share * hit) + self._quality.tap_um * slip)
        turn = cmath.exp(-1j * math.radians(self._angle_deg(ball)))
        self._mounted = replace(ball, off_mm=ball.off_mm + ball.side * way_mm * turn)

    def reading_um(self, direction: Direction) -> float:
        """Return what an indicator shows now: more where the ball is nearer.

        Raises:
            BenchError: no ball is mounted, or the indicator is out of its range.
        """
        ball = self._on_an_axis()
        turn = cmath.exp(1j * math.radians(self._angle_deg(ball)))
        across = cmath.exp(1j * _ACROSS[direction])
        place_mm = self._arm.axis_shift_mm(ball.joint) + self._astray() + ball.off_mm * turn
        along_mm = ball.side * (place_mm * across.conjugate()).real
        # The same side of the ball faces the indicator in either mounting.
        facing = (across * turn.conjugate()) ** _FORM_ORDERS
        along_mm += float((self._form_mm * facing).real.sum())
        reading_um = 1e3 * (self._gain * along_mm + ball.zero_mm[direction]) + self._wandering_um(direction)
        reading_um += self._quality.noise_um * float(self._noise.standard_normal())
        if abs(reading_um) > self._quality.range_um:
            raise BenchError(
                f"the indicator in {direction} is beyond its range of ±{self._quality.range_um:g} µm"
            )
        step = self._quality.resolution_um
        return step * round(reading_um / step) if step else reading_um

    def _on_an_axis(self) -> _Mounted:
        if self._mounted is None:
            raise BenchError("no ball stands on the axis of a joint: mount it first")
        return self._mounted

    def _angle_deg(self, ball: _Mounted) -> float:
        return self._arm.motion.joints_at(self._now())[ball.joint - 1]

    def _astray(self) -> complex:
        """Return what the axis does otherwise at each arrival, mm."""
        if self._arm.motion.end_s != self._arrived_s:
            self._arrived_s = self._arm.motion.end_s
            x, y = self._noise.standard_normal(2).tolist()
            self._astray_mm = 1e-3 * self._quality.asynchronous_um * complex(x, y)
        return self._astray_mm

    def _wandering_um(self, direction: Direction) -> float:
        """Return what the indicator's stand drifts by."""
        phase = self._drift[0 if direction == "x" else 1]
        turn = 2.0 * math.pi * self._now() / self._quality.drift_period_s
        return math.sqrt(2.0) * self._quality.drift_um * math.sin(turn + float(phase))
