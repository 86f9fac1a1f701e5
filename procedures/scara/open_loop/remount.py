"""The interferometer is turned by half a turn on the flange of J4, and its beam is aligned anew."""

import math
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from typing import Final

from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import AlignmentError, BeamLostError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.kit.tasks import MountInterferometer
from catseye.procedures.scara.alignment.beam_level import fitted_height, levelling
from catseye.procedures.scara.alignment.beam_to_j4 import centring
from catseye.procedures.scara.beam.beam_scan import find_narrow_return, signal_live
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.arrival import Arrival
from catseye.procedures.scara.open_loop.remount_plan import HALF_TURN_DEG, MOST_OFF_DEG, RemountPlan
from catseye.procedures.scara.open_loop.turned_beam import DOUBT_MM, Seen, TurnedBeam
from catseye.procedures.scara.questions import MOUNT

_TRIES: Final = 3
"""So often hands are sent before it is given up."""

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

    Attributes:
        turned_deg: how far the interferometer is turned as hands say or its beam shows; 0 where they disagree.
    """

    def __init__(self, ctx: Context, bench: ScaraBench, plan: RemountPlan, time: BenchTime) -> None:
        self.turned_deg = 0.0
        self._ctx = ctx
        self._bench = bench
        self._plan = plan
        self._time = time
        self._beam = TurnedBeam(ctx, bench, plan)
        self._seen_mm = bench.j3_mm
        self._stands = False
        self._looked = False

    async def turn(self) -> None:
        """Have the interferometer turned; what is done already is not asked for again.

        Raises:
            AlignmentError: it was not turned, or is not turned any more.
        """
        name = self._plan.pose.reflector.name
        await self._ctx.step(
            "turned/stand", f"arm where the turned beam meets {name}", self._begun(self._stand)
        )
        row = await self._ctx.step(
            "turned/mount", "interferometer turned by half a turn", self._begun(self._mount)
        )
        self._seen_mm = number_of(row, "j3_mm")
        await self._known(number_of(row, "turned_deg"))
        if not self._looked:
            await self._require_turned()

    async def align(self) -> Mounting:
        """Have the beam of the turned interferometer aligned; what is done already is not asked for again.

        Raises:
            AlignmentError: the beam could not be aligned.
            BeamLostError: the beam is lost during the alignment.
        """
        level_plan = replace(self._plan.level, bench=replace(self._plan.level.bench, j3_mm=self._seen_mm))
        level = await levelling(self._ctx, level_plan, alone=False).align()
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
        await self._known(mounting.turned_deg)
        self._time.passed(self._plan.duration_s, 0.0, "interferometer turned and aligned")
        return mounting

    def _begun(self, action: Callable[[], Awaitable[Row]]) -> Callable[[], Awaitable[Row]]:
        async def begun() -> Row:
            self._time.begin()
            return await action()

        return begun

    async def _require_turned(self) -> None:
        """Look whether the interferometer is still turned: whoever interrupted the run may have put it back."""
        await self._stand()
        seen = await self._look(self._seen_mm)
        if not seen.turned:
            raise AlignmentError(
                f"{seen.trouble}. It was turned before the interruption: mount it turned again, then continue with "
                "catseye resume; if its seat was touched, start a new run"
            )

    async def _stand(self) -> Row:
        """Stand where the turned beam meets the reflector."""
        if not self._stands:
            await Nests(self._ctx, self._bench).place(self._plan.pose.reflector, target=self._beam.stand)
            await Arrival(self._ctx, self._bench).at(self._beam.stand)
        self._stands = True
        return {"reflector": self._plan.pose.reflector.name}

    async def _mount(self) -> Row:
        """Send hands, and look where the beam comes back."""
        self._looked = True
        if self._stands:
            tried, seen = 1, await self._tried(1, "")
        else:
            # Whoever was asked before the interruption may have turned it since.
            await self._stand()
            tried, seen = 0, await self._look(self._bench.j3_mm)
        for number in range(tried + 1, _TRIES + 1):
            if not seen.turned:
                seen = await self._tried(number, seen.trouble)
        if seen.turned:
            return {"turned_deg": seen.turned_deg, "j3_mm": seen.j3_mm}
        raise AlignmentError(
            f"the interferometer was not turned by half a turn after {_TRIES} tries; at last: {seen.trouble}. All "
            "points so far are kept: continue with catseye resume"
        )

    async def _tried(self, number: int, trouble: str) -> Seen:
        """Send hands once; return what they have done.

        Args:
            trouble: what the look before has found to be wrong; empty where there was none.
        """
        await self._ask(number, trouble)
        # Until its beam is found it is taken to be mounted as it was asked for.
        await self._known(HALF_TURN_DEG)
        seen = await self._look(self._bench.j3_mm)
        if not seen.turned:
            await self._ctx.warn(seen.trouble)
        return seen

    async def _known(self, turned_deg: float) -> None:
        self.turned_deg = turned_deg
        await self._ctx.remounted(turned_deg)

    async def _look(self, likely_mm: float) -> Seen:
        """Look for the beam, and take note of a mounting that is not as it has to be."""
        seen = await self._beam.look(likely_mm)
        if seen.former_deg is not None:
            await self._known(0.0)
        elif seen.again and seen.turned_deg is not None and not seen.turned:
            await self._known(seen.turned_deg)
        elif not seen.turned:
            self.turned_deg = 0.0
        return seen

    async def _ask(self, number: int, trouble: str) -> None:
        pose = self._plan.pose
        what = "Take the interferometer off the flange of J4, mount it turned by half a turn (180°) about the J4 axis"
        if trouble:
            # Who is asked for half a turn again would turn back what is 9° off only.
            what = (
                f"{trouble[0].upper()}{trouble[1:]}. Mount it turned by 180° against the beginning of the run"
            )
        answer = await self._ctx.ask(
            MOUNT.prompt(
                f"mount/{number}",
                f"{what}, within {MOST_OFF_DEG:g}°, with its cable free, step back, then confirm. The arm "
                f"stands where its beam then meets {pose.reflector.name}: the signal comes back. Then it looks for "
                "the beam with J4, also from elsewhere and at other heights.",
                task=MountInterferometer(turned_deg=HALF_TURN_DEG),
            ),
            self._watch,
        )
        if answer != "yes":
            raise AlignmentError(
                "the interferometer was not turned; all points so far are kept: continue with catseye resume when it "
                "can be"
            )

    async def _watch(self) -> Live:
        return signal_live((await self._ctx.beam()).signal, self._bench.optics.signal_min)

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
                f"j3_range_mm ({low:g} to {high:g} mm): check how it is seated"
            )
        return height_mm

    async def _result(self, level: Row, stage: Row) -> Row:
        """Look from all over the workspace where the aligned beam comes back: its angle is what fits them best."""
        near, j3_mm, offset_mm = self._plan.stage.pose, self._height_mm(level), number_of(stage, "value")
        shift_deg = number_of(stage, "j4_deg") - near.j4_deg
        doubt_deg = math.degrees(DOUBT_MM / near.beam_mm)
        off, weight, nests = 0.0, 0.0, Nests(self._ctx, self._bench)
        for pose in self._plan.sights:
            at = (pose.theta1_deg, pose.theta2_deg, j3_mm, pose.j4_deg + shift_deg)
            await nests.place(pose.reflector, target=at)
            await Arrival(self._ctx, replace(self._bench, j3_mm=j3_mm)).at(at)
            window = await find_narrow_return(self._ctx, at, doubt_deg, pose.beam_mm, self._bench)
            if window is not None:
                # A beam that passes the axis on its left is aimed to the right of what its angle says. What is aimed
                # wrong misses in proportion to the length of the beam.
                beside_deg = math.degrees(offset_mm / pose.beam_mm)
                off += pose.beam_mm**2 * (pose.j4_deg - window.centre_deg - beside_deg)
                weight += pose.beam_mm**2
        if not weight:
            raise BeamLostError(
                "the aligned beam returns from no reflector: keep it free, and check whether they stand where they "
                "were found; then continue with catseye resume"
            )
        return {
            "mount_deg": HALF_TURN_DEG + off / weight,
            "j3_mm": j3_mm,
            "offset_mm": offset_mm,
            "pitch_mrad": number_of(level, "value"),
        }
