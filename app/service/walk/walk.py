"""A walk-through: a procedure that drives the motions of another one slowly, without measuring."""

import asyncio
import hashlib
from collections.abc import AsyncIterator, Awaitable, Callable, Collection, Iterable, Sequence
from contextlib import AbstractAsyncContextManager, asynccontextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

import numpy as np
from pydantic import BaseModel

from catseye.app.engine.gate import WHOLE_PERCENT
from catseye.app.engine.handle import OnOpen, RunHandle
from catseye.app.engine.walked.register import WALK, as_row
from catseye.app.engine.walked.tube import (
    FASTEST_MM_S,
    MOST_PERCENT,
    TUBE_DEG,
    TUBE_MM,
    Leg,
    Tubes,
    to_walk,
    walking_percent,
)
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.protocol.procedures import Runnable
from catseye.app.service.walk.feed import Feed, FeedLostError
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.pose import Axes, Pose, is_at, pose_text
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import ArmMovedError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.motion.body_speed import fastest_mm_s
from catseye.procedures.kit.motion.motion_time import move_time_s
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.records import Record, Row
from catseye.procedures.kit.system import System

MotionsFrom = Callable[[Pose], Awaitable[Sequence[Leg]]]
"""Returns every motion of a plan that begins where the arm stands."""

GO_ON: Final = "hold the space bar to walk on; this is not an enabling device"

_MOST_ROUNDS: Final = 6
"""One walks the plan, the next the way from its end back to its beginning; a plan that needs more never ends."""


@dataclass(frozen=True)
class WalkedOverride:
    """What a walk has made of the controller's speed override.

    Attributes:
        before_percent: that stood there before the walk set it first.
        asked_percent: that the controller was asked for last.
        left_percent: that it has read back.
    """

    before_percent: float
    asked_percent: float
    left_percent: float


class Walk:
    """Drives what has not been walked yet, and ends where the procedure can begin without leaving a tube.

    Args:
        walked: what this walk has driven before it was interrupted.
        before: returns what other walks of an arm have driven.
        feed: keeps the arm going.

    Attributes:
        procedure: that is walked.
        feed: keeps the arm going.
        override: what has become of the speed override; None as long as the walk has set none.
    """

    name = WALK

    def __init__(
        self,
        procedure: Runnable,
        system: System,
        motions_from: MotionsFrom,
        walked: Iterable[Leg],
        before: Callable[[Identity], Sequence[Leg]],
        feed: Feed,
    ) -> None:
        self.procedure = procedure
        self.feed = feed
        self._system = system
        self._bench = system.bench
        self._axes = self._bench.arm.axes
        self._motions_from = motions_from
        self._walked = list(walked)
        self._before = before
        self.override: WalkedOverride | None = None
        self._arm: Identity | None = None
        self._handle: RunHandle | None = None
        self._percent = self.cap_percent
        self._total_s = self._done_s = 0.0

    @property
    def title(self) -> str:
        """One line for people."""
        return f"Walk-through of {self.procedure.name}"

    @property
    def needs(self) -> Needs:
        """It is planned as the procedure is, and needs no device but the robot: nothing is measured."""
        return Needs(self.procedure.needs.bench, basis=self.procedure.needs.basis)

    @property
    def records(self) -> Collection[type[Record]]:
        """Nothing is measured."""
        return ()

    @property
    def sets_up_anew(self) -> bool:
        """A walk sets nothing up."""
        return False

    @property
    def params_type(self) -> type[BaseModel]:
        """What may be chosen for the procedure."""
        return self.procedure.params_type

    @property
    def cap_percent(self) -> float:
        """Highest override of this walk."""
        return min(MOST_PERCENT, self._bench.arm.override_percent)

    def equipped(self, bench: Bench, params: Any) -> Bench:
        """Return the procedure's own bench."""
        return self.procedure.equipped(bench, params)

    def plan(self, bench: Bench, params: Any) -> Any:
        """Plan the procedure."""
        return self.procedure.plan(bench, params)

    def meet(self, arm: Identity) -> None:
        """Learn which arm is walked.

        Raises:
            UsageError: it is real and nobody can keep it going.
        """
        if self.feed.by_itself and not arm.simulated:
            raise UsageError(
                "a real arm is walked while somebody holds a key: run this at a terminal, without --json, or walk "
                "from catseye tui; nothing was moved"
            )
        self._arm = arm

    def note_override(self, override: WalkedOverride) -> None:
        """Keep what has become of the speed override."""
        self.override = override

    def opened(self, outer: OnOpen | None) -> OnOpen:
        """Return what reaches the run while its record is open, this walk included."""

        @asynccontextmanager
        async def enter(handle: RunHandle) -> AsyncIterator[None]:
            self._handle, handle.feed = handle, self.feed.take
            inner: AbstractAsyncContextManager[None] = nullcontext() if outer is None else outer(handle)
            async with inner:
                yield

        return enter

    async def run(self, ctx: Context, plan: object) -> None:
        """Walk until a procedure that begins where the arm stands would leave no tube.

        Args:
            plan: of the procedure; its motions are planned again, since the first ones depend on where the arm is.

        Raises:
            SafetyError: a motion cannot be slow enough.
            WayBlockedError: there is no free way to a motion.
            MeasurementRejectedError: the procedure drives elsewhere each time it is gone through.
        """
        del plan
        if self._arm is not None:
            self._walked += await asyncio.to_thread(self._before, self._arm)
        for _ in range(_MOST_ROUNDS):
            motions = await self._motions_from(await ctx.joints())
            legs = await asyncio.to_thread(to_walk, self._axes, motions, self._walked)
            if not legs:
                await ctx.event("walked", motions=len(self._walked))
                return
            _require_walkable(self._axes, legs)
            await self._round(ctx, legs)
        raise MeasurementRejectedError(
            f"{self.procedure.name} drives other motions each time it is gone through: after {_MOST_ROUNDS} rounds "
            f"{len(legs)} of them are not walked, the first to {pose_text(self._axes, legs[0].end)}; what was walked "
            "counts"
        )

    async def teardown(self, ctx: Context) -> None:
        """Leave the arm where it stands, and say what a walk leaves behind."""
        planned_percent = self._bench.arm.override_percent
        if self._percent <= planned_percent - WHOLE_PERCENT:
            await ctx.warn(
                f"the speed override stays at {self._percent:g} % or less and runs are planned with "
                f"{planned_percent:g} %: after a walk in catseye tui = on Jog (F5) sets again what stood there "
                "before, else raise it at the controller before the next run"
            )

    async def _round(self, ctx: Context, legs: Sequence[Leg]) -> None:
        tubes = Tubes(self._axes, self._walked)
        # One speed for the whole round: the override is never raised again.
        self._slow_down(min(walking_percent(self._bench, leg, self.cap_percent) for leg in legs))
        self._total_s, self._done_s = sum(map(self._time_s, legs)), 0.0
        for number, leg in enumerate(legs, 1):
            await self._lead_to(ctx, leg.start, tubes)
            self._show_leg(ctx, leg, f"motion {number} of {len(legs)}")
            await self._go(ctx, leg, tubes)
            self._done_s += self._time_s(leg)
        self._show_leg(ctx, legs[-1], f"{len(legs)} motions")

    async def _lead_to(self, ctx: Context, start: Pose, tubes: Tubes) -> None:
        """Bring the arm to where a motion begins."""
        here = await ctx.joints()
        if is_at(here, start):
            return
        for target in self._system.way_in(here, start):
            await self._go(ctx, Leg(here, target), tubes)
            here = target

    async def _go(self, ctx: Context, leg: Leg, tubes: Tubes) -> None:
        """Drive a motion; one that is not covered yet becomes a step."""
        self._slow_down(walking_percent(self._bench, leg, self.cap_percent))
        if tubes.covers(leg):
            await self._drive(ctx, leg)
            return
        await ctx.step(_step_id(leg), f"to {pose_text(self._axes, leg.end)}", partial(self._walk, ctx, leg))
        tubes.add(leg)
        self._walked.append(leg)

    async def _walk(self, ctx: Context, leg: Leg) -> Row:
        await self._drive(ctx, leg)
        return as_row(leg)

    async def _drive(self, ctx: Context, leg: Leg) -> None:
        """Move while somebody feeds; after each stop go on from where the arm stands."""
        while True:
            try:
                await ctx.move(leg.end)
            except FeedLostError:
                await ctx.wait_until(GO_ON, self.feed.back)
                await self._require_on_way(ctx, leg)
            else:
                return

    async def _require_on_way(self, ctx: Context, leg: Leg) -> None:
        here = await ctx.joints()
        if not Tubes(self._axes, [leg]).covers(Leg(here, leg.end)):
            raise ArmMovedError(
                f"the arm was moved while the walk was let go: it stands at {pose_text(self._axes, here)}, beside "
                f"the way to {pose_text(self._axes, leg.end)}; continue with catseye resume, and leave the arm alone "
                "meanwhile"
            )

    def _slow_down(self, percent: float) -> None:
        """Lower the override before the next motion; it is read back there."""
        self._percent = min(self._percent, percent)
        gate = None if self._handle is None else self._handle.gate
        if self._handle is not None and gate is not None and self._percent < gate.override_percent:
            self._handle.lower_override(self._percent)

    def _time_s(self, leg: Leg) -> float:
        arm = replace(self._bench.arm, override_percent=self._percent)
        travel = np.abs(np.subtract(leg.end, leg.start))
        full_speed_s = max(way / axis.speed for way, axis in zip(travel, arm.axes, strict=True))
        return max(float(move_time_s(arm, travel[None])[0]), float(full_speed_s) * 100.0 / self._percent)

    def _show_leg(self, ctx: Context, leg: Leg, text: str) -> None:
        fastest = fastest_mm_s(self._bench, leg.start, leg.end, self._percent)
        ctx.progress(self._done_s, self._total_s, f"{text}, {self._percent:g} %")
        ctx.show(Live("speed, at most", fastest, "mm/s", high=FASTEST_MM_S))


def _require_walkable(axes: Axes, legs: Sequence[Leg]) -> None:
    """Refuse corners so wide that no walk along their legs would cover them.

    Raises:
        MeasurementRejectedError: names the first one.
    """
    wide = next((leg for leg in legs if not Tubes(axes, [leg]).covers(leg)), None)
    if wide is not None:
        raise MeasurementRejectedError(
            f"the arm cuts the corners on its way to {pose_text(axes, wide.end)} by more than the {TUBE_DEG:g}° and "
            f"{TUBE_MM:g} mm within which a motion counts as walked: take a driver that stops at every target, or "
            "smaller steps"
        )


def _step_id(leg: Leg) -> str:
    text = " ".join(f"{value:.4f}" for value in (*leg.start, *leg.end))
    return f"{WALK}/{hashlib.sha256(text.encode()).hexdigest()[:12]}"
