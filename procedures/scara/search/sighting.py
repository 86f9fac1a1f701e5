"""Looking for a reflector from one pose: by a scan of J4, or by a technician who jogs it."""

import math
from collections import Counter
from dataclasses import dataclass
from statistics import median
from typing import Final

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.beam.loss import Cause, LossLog
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.scara.beam.beam_scan import (
    Looks,
    ReturnWindow,
    find_return,
    half_window_deg,
    signal_live,
)
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.motion.arrival import Arrival
from catseye.procedures.scara.questions import JOG
from catseye.procedures.scara.records import SeenReflector
from catseye.procedures.scara.search.search_plan import Jogging, SearchPlan, SearchPose

_REMEDY = "check that the beam is free, and the rough place and theta40_deg in the cell file"

_MOST_QUESTIONS = 500
"""So many answers at one pose mean that nobody is there who looks at the signal."""

POSE_S: Final = 15.0
"""Expected time of a look; the run's own pace corrects it."""


SCAN_J4: Final = "scan_j4_deg"
SCAN_SIGNAL: Final = "scan_signal"
"""What a step keeps of a scan: where J4 stood, and the signal there, in the order of looking."""


@dataclass(frozen=True)
class Sighting:
    """A pose from which a reflector was found.

    Attributes:
        pose: the pose.
        j4_deg: middle of the return window.
    """

    pose: SearchPose
    j4_deg: float

    @property
    def offset_deg(self) -> float:
        """What the rough aim was wrong by, -180...180."""
        return (self.j4_deg - self.pose.j4_deg + 180.0) % 360.0 - 180.0


class SightingRun:
    """Looks for reflectors from one pose after the other and keeps what was found.

    Attributes:
        sightings: found so far, in order.
        looked: how often each reflector was looked for.
    """

    def __init__(self, ctx: Context, plan: SearchPlan) -> None:
        self.sightings: list[Sighting] = []
        self.looked: Counter[str] = Counter()
        self._ctx = ctx
        self._plan = plan
        self._nests = Nests(ctx, plan.bench)
        self._arrival = Arrival(ctx, plan.bench)
        self._visits: list[str] = []
        self._losses = LossLog(ctx)
        self._last: SearchPose | None = None

    @property
    def just_seen(self) -> Sighting | None:
        """What was seen from the pose looked from last; None when nothing was."""
        last = self.sightings[-1] if self.sightings else None
        return last if last is not None and last.pose is self._last else None

    async def look(self, pose: SearchPose, said: "Announcement | None" = None) -> None:
        """Look from a pose, in a step of its own.

        Args:
            said: why the pose was added, published when the step runs.
        """
        name, number = pose.reflector.name, self.looked.total()
        self.looked[name] += 1
        self._last = pose
        if not self._visits or self._visits[-1] != name:
            self._visits.append(name)
        visit = self._visits.count(name)

        async def action() -> Row:
            if said is not None:
                await said.publish(self._ctx)
            await self._nests.place(pose.reflector, visit, self._aim(pose)[0])
            return await self._find(pose, number)

        title = f"{name}: look from θ1 {pose.theta1_deg:g}°, θ2 {pose.theta2_deg:g}°"
        result = await self._ctx.step(f"sight/{name}/{number:02d}", title, action)
        if result["found"]:
            self.sightings.append(Sighting(pose, number_of(result, "j4_deg")))

    async def _find(self, pose: SearchPose, number: int) -> Row:
        start, half_range = self._aim(pose)
        await self._arrival.at(_within(start, self._plan.bench.j4_limits_deg))
        name, where = pose.reflector.name, f"θ1 = {pose.theta1_deg:g}°, θ2 = {pose.theta2_deg:g}°"
        looks: Looks = []
        if self._plan.jogging is None:
            window = await self._scan(start, pose, half_range, looks)
        else:
            window = await _Jog(self._ctx, self._plan, self._plan.jogging, pose, number).window(start)
        if window is None:
            if self._plan.jogging is None:
                missing = f"not found within ±{half_range:g}° of J4 = {start[3]:.2f}°"
                cause = Cause(
                    "no-return", f"reflector {name} {missing}: {_REMEDY}", {"half_range_deg": half_range}
                )
                await self._losses.note(cause, where, reflector=name, where=where)
            else:
                await self._ctx.warn(f"reflector {name} left out by the operator at {where}: {_REMEDY}")
            return {"found": False, **_kept(pose, looks)}
        self._ctx.record(
            SeenReflector(
                reflector=pose.reflector.name,
                theta1_deg=pose.theta1_deg,
                theta2_deg=pose.theta2_deg,
                j4_deg=window.centre_deg,
                lower_deg=window.lower_deg,
                upper_deg=window.upper_deg,
                signal=window.signal,
            )
        )
        return {"found": True, "j4_deg": window.centre_deg, **_kept(pose, looks)}

    def _aim(self, pose: SearchPose) -> tuple[Pose, float]:
        """Return where the scan begins, as well as is known by now, and its half range."""
        same = [seen.offset_deg for seen in self.sightings if seen.pose.reflector == pose.reflector]
        expected = same or [seen.offset_deg for seen in self.sightings] or [0.0]
        plan, bench = self._plan, self._plan.bench
        half_range = plan.later_half_range_deg if self.sightings else plan.half_range_deg
        aim_deg = _on_a_branch(pose.j4_deg + median(expected), bench.j4_limits_deg)
        return (pose.theta1_deg, pose.theta2_deg, bench.j3_mm, aim_deg), half_range

    async def _scan(
        self, start: Pose, pose: SearchPose, half_range_deg: float, looks: Looks
    ) -> ReturnWindow | None:
        optics, limits = self._plan.bench.optics, self._plan.bench.j4_limits_deg
        half_window = half_window_deg(optics.acceptance_mm, pose.beam_mm)
        return await find_return(
            self._ctx, start, half_range_deg, half_window, limits, optics.signal_min, looks
        )


@dataclass(frozen=True)
class Announcement:
    """What is published when a pose is added.

    Attributes:
        warnings: about sightings that were left out.
        reflector: whose aim does not hold; empty when there is no aim yet.
        u_mm: its worst standard uncertainty.
        room_mm: what twice that may be.
        poses: poses looked from so far.
    """

    warnings: tuple[str, ...]
    reflector: str
    u_mm: float | None
    room_mm: float
    poses: int

    async def publish(self, ctx: Context) -> None:
        """Publish warnings and event."""
        for text in self.warnings:
            await ctx.warn(text)
        if self.u_mm is None:
            await ctx.event("aim", reflector=self.reflector, poses=self.poses, holds=False)
            return
        ctx.show(
            Live(
                f"aim at {self.reflector}, k = 2",
                2.0 * self.u_mm,
                "mm",
                high=self.room_mm,
                text="another pose is looked from",
            )
        )
        await ctx.event(
            "aim",
            reflector=self.reflector,
            worst_uncertainty_mm=self.u_mm,
            room_mm=self.room_mm,
            poses=self.poses,
            holds=False,
        )


class _Jog:
    """One pose at which the technician turns J4 and watches the signal."""

    def __init__(
        self, ctx: Context, plan: SearchPlan, jogging: Jogging, pose: SearchPose, number: int
    ) -> None:
        self._ctx = ctx
        self._plan = plan
        self._jogging = jogging
        self._pose = pose
        self._number = number

    async def window(self, start: Pose) -> ReturnWindow | None:
        """Ask and turn until the beam is back and centred; None when the pose is left out."""
        at = _within(start, self._plan.bench.j4_limits_deg)
        await self._ctx.move(at)
        complaint = ""
        for question in range(1, _MOST_QUESTIONS + 1):
            beam = await self._ctx.beam()
            if beam.beam_ok and self._jogging.auto_centre:
                return await self._centred(at)
            answer = (await self._ctx.ask(self._prompt(question, at[3], complaint), self._watch)).strip()
            if answer == "skip":
                return None
            if answer == "here":
                window, complaint = await self._taken(at[3])
                if window is not None:
                    return window
                continue
            turn_deg, complaint = self._turn(answer, at[3])
            if turn_deg is not None:
                at = (*at[:3], at[3] + turn_deg)
                await self._ctx.move(at)
        return None

    def _prompt(self, question: int, j4_deg: float, complaint: str) -> Prompt:
        name, largest = self._pose.reflector.name, self._jogging.largest_deg
        goal = (
            "until the signal returns"
            if self._jogging.auto_centre
            else "until the signal is largest, then here"
        )
        return JOG.prompt(
            f"jog/{name}/{self._number}/{question}",
            f"{complaint}Type by how many degrees J4 should turn towards {name}, −{largest:g} to {largest:g} "
            f"(now at {j4_deg:.3f}°), {goal}; skip leaves this pose out.",
        )

    def _turn(self, answer: str, j4_deg: float) -> tuple[float | None, str]:
        """Return the turn that an answer asks for, or what is wrong with it."""
        largest, (low, high) = self._jogging.largest_deg, self._plan.bench.j4_limits_deg
        try:
            turn = float(answer.replace("−", "-").replace(",", "."))
        except ValueError:
            turn = math.nan
        if not math.isfinite(turn):
            return None, f"{answer!r} is neither a number of degrees nor here or skip. "
        if abs(turn) > largest:
            return None, f"{turn:g}° is more than {largest:g}° at a time; nothing was moved. "
        if not low <= j4_deg + turn <= high:
            return None, f"J4 = {j4_deg + turn:.2f}° is outside {low:g}…{high:g}°; nothing was moved. "
        return turn, ""

    async def _taken(self, j4_deg: float) -> tuple[ReturnWindow | None, str]:
        """Take the present angle for the middle of the window if the beam returns."""
        beam, least = await self._ctx.beam(), self._plan.bench.optics.signal_min
        if beam.returns(least):
            return ReturnWindow(j4_deg, j4_deg, beam.signal), ""
        return None, f"The beam does not return here (signal {beam.signal:.2f}, {least:g} is needed). "

    async def _centred(self, at: Pose) -> ReturnWindow | None:
        optics, limits = self._plan.bench.optics, self._plan.bench.j4_limits_deg
        half_window = half_window_deg(optics.acceptance_mm, self._pose.beam_mm)
        return await find_return(self._ctx, at, 0.5 * half_window, half_window, limits, optics.signal_min)

    async def _watch(self) -> Live:
        least = self._plan.bench.optics.signal_min
        return signal_live((await self._ctx.beam()).signal, least)


def _kept(pose: SearchPose, looks: Looks) -> Row:
    """Return the looks of a scan as a step keeps them; nothing where somebody jogged."""
    if not looks:
        return {}
    return {
        "reflector": pose.reflector.name,
        "theta1_deg": pose.theta1_deg,
        "theta2_deg": pose.theta2_deg,
        SCAN_J4: [j4_deg for j4_deg, _ in looks],
        SCAN_SIGNAL: [signal for _, signal in looks],
    }


def _within(pose: Pose, j4_limits_deg: tuple[float, float]) -> Pose:
    """Return a pose with J4 brought inside its limits."""
    low, high = j4_limits_deg
    return (*pose[:3], min(max(pose[3], low), high))


def _on_a_branch(j4_deg: float, limits_deg: tuple[float, float]) -> float:
    """Return J4 by whole turns inside its limits; unchanged where none fits, and the scan starts beside it."""
    low, high = limits_deg
    fitting = [j4_deg + turn for turn in (0.0, 360.0, -360.0) if low <= j4_deg + turn <= high]
    return fitting[0] if fitting else j4_deg
