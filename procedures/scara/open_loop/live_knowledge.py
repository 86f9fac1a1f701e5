"""What the points so far say about the maps, published while measuring."""

import math
from collections import deque
from collections.abc import Sequence

import numpy as np

from catseye.calibration.scara.live_map import Changes, LiveMap, MapKnowledge
from catseye.calibration.scara.radial import RadialBudget
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.expanded import EXPANDED
from catseye.procedures.kit.live import Live
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.approach import Command
from catseye.procedures.scara.texts import MAP_KNOWN

_COVERAGE = 3.0
"""An innovation is expected within so many of its standard uncertainties."""

_JUDGED, _CONTRADICTING = 10, 8
"""So many of the last distances to a reflector that lie outside are no chance."""

_LEAST_WHITE_MM = 1e-6

_MEANINGLESS_MDEG = 1000.0
"""A map that is known to a degree only is not known: no arm is that wrong, and derivatives do not reach that far."""


def new_map(bench: ScaraBench, reflectors: Sequence[Reflector], expected: int) -> LiveMap:
    """Return the map of an arm of which nothing is measured yet.

    Args:
        expected: distances planned; drifts count by the share of them that has passed.
    """
    noise = bench.noise
    return LiveMap(
        np.deg2rad(bench.nodes1_deg),
        np.deg2rad(bench.nodes2_deg),
        bench.link1_mm,
        bench.link2_mm,
        {reflector.name: (reflector.x_mm, reflector.y_mm) for reflector in reflectors},
        max(noise.white_mm, _LEAST_WHITE_MM),
        RadialBudget(*noise.radial_mm, noise.radial_orders),
        Changes(noise.changing, expected),
    )


class Knowledge:
    """Takes the points of a run in, fresh and stored ones, and reports what they are good for.

    Args:
        expected: distances planned; drifts count by the share of them that has passed.
    """

    def __init__(
        self,
        ctx: Context,
        bench: ScaraBench,
        reflectors: tuple[Reflector, ...],
        expected: int,
    ) -> None:
        self._ctx = ctx
        self._outside: dict[str, deque[bool]] = {}
        self._warned: set[str] = set()
        self._number = -1
        self._nodes1_deg, self._nodes2_deg = bench.nodes1_deg, bench.nodes2_deg
        self._map = new_map(bench, reflectors, expected)

    async def take(
        self,
        reflector: str,
        command: Command,
        segment: int,
        displacement_mm: float,
        mount_deg: float = 0.0,
        *,
        fresh: bool,
    ) -> None:
        """Take a point in and show what it says beyond all points before; a stored or rehearsed one is not shown.

        Points between the nodes are left out: what lies there is not in the maps, and its size is not known yet.
        """
        self._number += 1
        if command.theta1_deg not in self._nodes1_deg or command.theta2_deg not in self._nodes2_deg:
            return
        found = self._map.add(
            math.radians(command.theta1_deg),
            math.radians(command.theta2_deg),
            command.direction1,
            command.direction2,
            reflector,
            segment,
            displacement_mm,
            math.radians(mount_deg),
            self._number,
        )
        if found is None or not fresh or self._ctx.rehearsing:
            return
        band_um = _COVERAGE * found.u_mm * 1e3
        live = Live(
            "innovation",
            found.value_mm * 1e3,
            "µm",
            -band_um,
            band_um,
            "measured minus predicted from all points before; outside again and again: the reflector has moved, "
            "or the arm does not repeat",
        )
        self._ctx.show(live)
        await self._judge(reflector, outside=not live.accepted)

    async def _judge(self, reflector: str, *, outside: bool) -> None:
        """Warn once for each reflector whose distances contradict the points before."""
        lately = self._outside.setdefault(reflector, deque(maxlen=_JUDGED))
        lately.append(outside)
        if reflector in self._warned or sum(lately) < _CONTRADICTING:
            return
        self._warned.add(reflector)
        await self._ctx.warn(
            f"{reflector} or the interferometer seems to have been moved: {sum(lately)} of the last {len(lately)} "
            f"distances lie outside ±{_COVERAGE:g}u of what all points before predict; hold the run and look; what "
            "was moved needs a new search and a new run; if nothing was, the arm does not repeat: diagnose shows more"
        )

    async def row_done(self, reflector: str, command: Command, stop_at_mdeg: float, *, fresh: bool) -> bool:
        """Report how well the maps are known after a row of J2; return whether that is good enough to end with.

        Args:
            command: last one of the row.
            stop_at_mdeg: standard uncertainty of both maps that is good enough; 0 never is.
            fresh: a point of the row was measured now.
        """
        if not fresh and not stop_at_mdeg:
            return False
        known = self._map.known()
        u1_mdeg, u2_mdeg = _mdeg(known.u1_rad), _mdeg(known.u2_rad)
        if fresh:
            text = _text(known, u1_mdeg, u2_mdeg)
            await self._ctx.event(
                MAP_KNOWN,
                reflector=reflector,
                theta1_deg=command.theta1_deg,
                direction1=command.direction1,
                u_theta1_mdeg=u1_mdeg,
                u_theta2_mdeg=u2_mdeg,
                text=text,
            )
            for name, u_mdeg in (("Δθ1", u1_mdeg), ("Δθ2", u2_mdeg)):
                if u_mdeg is not None:
                    high = EXPANDED * stop_at_mdeg or None
                    self._ctx.show(
                        Live(f"largest U({name})", EXPANDED * u_mdeg, "mdeg", high=high, text=text)
                    )
        if u1_mdeg is None or u2_mdeg is None or not stop_at_mdeg:
            return False
        return max(u1_mdeg, u2_mdeg) <= stop_at_mdeg


def _mdeg(u_rad: float | None) -> float | None:
    u_mdeg = math.inf if u_rad is None else math.degrees(u_rad) * 1e3
    return u_mdeg if u_mdeg < _MEANINGLESS_MDEG else None


def _text(known: MapKnowledge, u1_mdeg: float | None, u2_mdeg: float | None) -> str:
    if u1_mdeg is None or u2_mdeg is None:
        reason = known.reason or "the points so far leave it uncertain by whole degrees"
        return f"the map is not determined yet: {reason}"
    return f"Δθ1 known to ±{EXPANDED * u1_mdeg:.1f} mdeg, Δθ2 ±{EXPANDED * u2_mdeg:.1f} mdeg (k = 2)"
