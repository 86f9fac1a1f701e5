"""The interferometer is turned by half a turn on the flange of J4, and its beam is aligned anew."""

import math
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from typing import Final

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import AlignmentError, BeamLostError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.kit.tasks import MountInterferometer
from catseye.procedures.scara.alignment.beam_level import fitted_height, levelling
from catseye.procedures.scara.alignment.beam_to_j4 import centring
from catseye.procedures.scara.beam.beam_scan import ReturnWindow, find_return, half_window_deg, signal_live
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.arrival import Arrival
from catseye.procedures.scara.open_loop.remount_plan import HALF_TURN_DEG, MOST_OFF_DEG, RemountPlan
from catseye.procedures.scara.search.search_plan import SearchPose

_TRIES: Final = 3
"""So often hands are sent before it is given up."""

_STRIDES: Final = (1.0, 0.4)
"""Steps of the scan in half widths of the return window: a beam at the wrong height has a narrower one."""

_DOUBT_MM: Final = 3.0
"""What a place that was searched may be wrong by at most, for the range of a scan."""

_HEIGHT_SHARE: Final = 0.1
"""Of the acceptance: a beam that lies higher or lower by less is measured with as it is."""


@dataclass(frozen=True)
class Mounting:
    """How the interferometer is mounted from now on.

    Attributes:
        turned_deg: angle about the J4 axis against the first mounting.
        j3_mm: height at which its beam meets the reflectors.
    """

    turned_deg: float
    j3_mm: float


class Remount:
    """Guides the turning of the interferometer; each of its parts is a step, or steps, of its own.

    Args:
        bench: as it is in the first half.
    """

    def __init__(self, ctx: Context, bench: ScaraBench, plan: RemountPlan, time: BenchTime) -> None:
        self._ctx = ctx
        self._bench = bench
        self._plan = plan
        self._time = time
        self._asked = False

    async def guide(self) -> Mounting:
        """Have the interferometer turned and its beam aligned; what is done already is not asked for again.

        Raises:
            AlignmentError: it was not turned, is not turned any more, or the beam could not be aligned.
            BeamLostError: the beam is lost during the alignment.
        """
        turned = await self._ctx.step(
            "turned/mount", "interferometer turned by half a turn", self._begun(self._turned)
        )
        if not self._asked:
            await self._ctx.remounted(number_of(turned, "turned_deg"))
            await self._require_turned()
        level = await levelling(self._ctx, self._plan.level, alone=False).align()
        stage_plan = replace(
            self._plan.stage, bench=replace(self._plan.stage.bench, j3_mm=self._height_mm(level))
        )
        stage = await centring(self._ctx, stage_plan, alone=False).align()
        row = await self._ctx.step(
            "turned/result",
            "angle of the turned interferometer",
            self._begun(lambda: self._result(level, stage)),
        )
        mounting = Mounting(number_of(row, "mount_deg"), number_of(row, "j3_mm"))
        await self._ctx.remounted(mounting.turned_deg)
        self._time.passed(self._plan.duration_s, 0.0, "interferometer turned and aligned")
        return mounting

    def _begun(self, action: Callable[[], Awaitable[Row]]) -> Callable[[], Awaitable[Row]]:
        async def begun() -> Row:
            self._time.begin()
            return await action()

        return begun

    async def _require_turned(self) -> None:
        """Look whether the interferometer is still turned: whoever interrupted the run may have put it back."""
        j4_deg = await self._stood()
        if await self._sought(j4_deg) is None:
            raise AlignmentError(
                f"{await self._trouble(None)}. It was turned before the interruption: mount it so again, then go on "
                "with catseye resume; if its seat was touched, start a new run"
            )

    async def _stood(self) -> float:
        """Stand where the turned beam meets the reflector; return J4 there."""
        pose = self._plan.pose
        await Nests(self._ctx, self._bench).place(pose.reflector, target=self._at(pose.j4_deg))
        await Arrival(self._ctx, self._bench).at(self._at(pose.j4_deg))
        return pose.j4_deg

    async def _turned(self) -> Row:
        """Send hands, and look where the beam comes back."""
        self._asked = True
        pose, trouble = self._plan.pose, ""
        await self._stood()
        for number in range(1, _TRIES + 1):
            await self._ask(number)
            # The beam is looked for where a good mounting has it.
            await self._ctx.remounted(HALF_TURN_DEG)
            window = await self._sought(pose.j4_deg)
            turned_deg = None if window is None else HALF_TURN_DEG + pose.j4_deg - window.centre_deg
            if turned_deg is not None and abs(turned_deg - HALF_TURN_DEG) <= MOST_OFF_DEG:
                return {"turned_deg": turned_deg}
            trouble = await self._trouble(turned_deg)
            await self._ctx.warn(trouble)
            await self._ctx.move(self._at(pose.j4_deg))
        raise AlignmentError(
            f"the interferometer was not turned by half a turn after {_TRIES} tries; at last: {trouble}. All points "
            "so far are kept: go on with catseye resume"
        )

    async def _ask(self, number: int) -> None:
        pose = self._plan.pose
        answer = await self._ctx.ask(
            Prompt(
                id=f"mount/{number}",
                kind="confirm",
                text="Take the interferometer off the flange of J4, mount it turned by half a turn (180°) about the "
                f"J4 axis, within {MOST_OFF_DEG:g}°, with its cable free, step back, then confirm. The arm stands "
                f"where its beam then meets {pose.reflector.name}: the signal comes back.",
                task=MountInterferometer(turned_deg=HALF_TURN_DEG),
                motion=True,
                target=self._at(pose.j4_deg),
            ),
            self._watch,
        )
        if answer != "yes":
            raise AlignmentError(
                "the interferometer was not turned; all points so far are kept: go on with catseye resume when it "
                "can be"
            )

    async def _watch(self) -> Live:
        return signal_live((await self._ctx.beam()).signal, self._bench.optics.signal_min)

    async def _sought(self, j4_deg: float) -> ReturnWindow | None:
        """Look for the beam of the interferometer where it is turned, about an angle of J4."""
        return await self._found(self._plan.pose, self._at(j4_deg), self._plan.level.params.half_range_deg)

    async def _found(self, pose: SearchPose, at: Pose, half_range_deg: float) -> ReturnWindow | None:
        optics = self._bench.optics
        half_window = half_window_deg(optics.acceptance_mm, pose.beam_mm)
        for stride in _STRIDES:
            window = await find_return(
                self._ctx,
                at,
                half_range_deg,
                stride * half_window,
                self._bench.j4_limits_deg,
                optics.signal_min,
            )
            if window is not None:
                return window
        return None

    async def _trouble(self, turned_deg: float | None) -> str:
        """Return what is wrong with a mounting.

        Args:
            turned_deg: as far as it was found turned; None where the beam was not found.
        """
        name, former_deg = self._plan.pose.reflector.name, self._plan.former_j4_deg
        if turned_deg is not None:
            more_deg = HALF_TURN_DEG - turned_deg
            way = "anticlockwise" if more_deg > 0.0 else "clockwise"
            return (
                f"the interferometer is turned by {turned_deg:.1f}°: turn it by {abs(more_deg):.1f}° {way}, as "
                "seen from above"
            )
        if former_deg is not None and await self._sought(former_deg) is not None:
            return (
                f"the interferometer is not turned: its beam returns from {name} at J4 = {former_deg:.1f}°, where "
                "it did before; turn it by half a turn"
            )
        return (
            f"the beam returns from {name} neither where an interferometer turned by half a turn has it nor where it "
            "was before: look that it is turned by 180°, that its seat is clean, so that the beam keeps its height, "
            "and that nothing stands in the beam"
        )

    def _height_mm(self, level: Row) -> float:
        """Return the height at which the levelled beam meets the reflectors."""
        nearest_mm, farthest_mm = self._plan.level.distances_mm
        height_mm = round(fitted_height(level).height_mm(0.5 * (nearest_mm + farthest_mm)), 2)
        bench = self._bench
        if abs(height_mm - bench.j3_mm) <= _HEIGHT_SHARE * bench.optics.acceptance_mm:
            return bench.j3_mm
        low, high = self._plan.level.j3_range_mm
        if not low <= height_mm <= high:
            raise AlignmentError(
                f"the beam of the turned interferometer meets the reflectors at J3 = {height_mm:g} mm, outside of "
                f"j3_range_mm ({low:g} to {high:g} mm): look how it is seated"
            )
        return height_mm

    async def _result(self, level: Row, stage: Row) -> Row:
        """Look from all over the workspace where the aligned beam comes back: its angle is what fits them best."""
        near, j3_mm, offset_mm = self._plan.stage.pose, self._height_mm(level), number_of(stage, "value")
        shift_deg = number_of(stage, "j4_deg") - near.j4_deg
        doubt_deg = math.degrees(_DOUBT_MM / near.beam_mm)
        off, weight, nests = 0.0, 0.0, Nests(self._ctx, self._bench)
        for pose in self._plan.sights:
            at = (pose.theta1_deg, pose.theta2_deg, j3_mm, pose.j4_deg + shift_deg)
            await nests.place(pose.reflector, target=at)
            await Arrival(self._ctx, replace(self._bench, j3_mm=j3_mm)).at(at)
            window = await self._found(pose, at, doubt_deg)
            if window is not None:
                # A beam that passes the axis on its left is aimed to the right of what its angle says. What is aimed
                # wrong misses in proportion to the length of the beam.
                beside_deg = math.degrees(offset_mm / pose.beam_mm)
                off += pose.beam_mm**2 * (pose.j4_deg - window.centre_deg - beside_deg)
                weight += pose.beam_mm**2
        if not weight:
            raise BeamLostError(
                "the aligned beam returns from no reflector: keep it free, and look whether they stand where they "
                "were found; then go on with catseye resume"
            )
        return {
            "mount_deg": HALF_TURN_DEG + off / weight,
            "j3_mm": j3_mm,
            "offset_mm": offset_mm,
            "pitch_mrad": number_of(level, "value"),
        }

    def _at(self, j4_deg: float) -> Pose:
        pose = self._plan.pose
        return (pose.theta1_deg, pose.theta2_deg, self._bench.j3_mm, j4_deg)
