"""The halves of a measurement: the reflectors as the interferometer is mounted, and again once it is turned."""

from dataclasses import replace
from typing import Final

from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import MostLeftOutError
from catseye.procedures.kit.expanded import EXPANDED
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.counter import CounterWatch
from catseye.procedures.scara.open_loop.campaign import ReflectorCampaign
from catseye.procedures.scara.open_loop.live_knowledge import Knowledge
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, ReflectorPlan
from catseye.procedures.scara.open_loop.remount import Mounting, Remount
from catseye.procedures.scara.open_loop.remount_plan import HALF_TURN_DEG, RemountPlan

_MOST: Final = 0.5
"""A run that leaves out more than this share of its points has not measured."""


class Halves:
    """Measures one half, or two, and keeps what goes on from the one to the other."""

    def __init__(self, ctx: Context, plan: OpenLoopPlan) -> None:
        self._ctx = ctx
        self._plan = plan
        self._time = BenchTime(ctx, plan.duration_s)
        reflectors = tuple(part.reflector for part in plan.reflectors)
        self._knowledge = Knowledge(ctx, plan.bench, reflectors, plan.n_distances)
        self._counter = CounterWatch(plan.bench)
        self._segments: dict[str, int] = {}
        self._left_out: list[str] = []
        self._visited = 0

    async def measure(self, bench: ScaraBench, parts: tuple[ReflectorPlan, ...], *, last: bool) -> None:
        """Measure reflectors.

        Args:
            bench: as the interferometer is mounted.
            last: no other half follows, so it may end as soon as the maps are known well enough.
        """
        rules = self._plan.rules
        plan = replace(self._plan, bench=bench, rules=rules if last else replace(rules, stop_at_mdeg=0.0))
        for part in parts:
            name = part.reflector.name
            segment = self._segments.get(name, -1)
            campaign = ReflectorCampaign(
                self._ctx, plan, part, self._knowledge, self._counter, self._time, segment
            )
            enough = await campaign.run()
            self._segments[name] = campaign.segment
            self._left_out += campaign.left_out
            self._visited += len(part.visits)
            if enough:
                await self._report_enough()
                return

    def remount(self, plan: RemountPlan) -> Remount:
        """Return who has the interferometer turned and aligned."""
        return Remount(self._ctx, self._plan.bench, plan, self._time)

    def turned(self, mounting: Mounting) -> tuple[ScaraBench, tuple[ReflectorPlan, ...]]:
        """Return bench and plans of the second half as the interferometer is really mounted."""
        off_deg = mounting.turned_deg - HALF_TURN_DEG
        bench = replace(self._plan.bench.mounted(mounting.turned_deg), j3_mm=mounting.j3_mm)
        return bench, tuple(part.shifted(-off_deg, mounting.j3_mm) for part in self._plan.turned)

    async def judge(self) -> None:
        """Say what was left out.

        Raises:
            MostLeftOutError: most points were.
        """
        left_out = self._left_out
        if left_out:
            await self._ctx.warn(f"{len(left_out)} points were left out: {'; '.join(left_out)}")
        if len(left_out) > _MOST * self._visited:
            raise MostLeftOutError(
                f"{len(left_out)} of {self._visited} points were left out, so this is not a measurement: see why "
                "in the run (catseye show), correct it and measure again"
            )

    async def _report_enough(self) -> None:
        limit_mdeg = self._plan.rules.stop_at_mdeg
        text = (
            f"both maps are known to u {limit_mdeg:g} mdeg (stop_at_mdeg) = U {EXPANDED * limit_mdeg:g} mdeg: "
            "no more points are needed"
        )
        await self._ctx.event("early-stop", stop_at_mdeg=limit_mdeg, text=text)
        self._time.cut_short(text)
