"""The automated open-loop tracking measurement."""

from dataclasses import replace
from typing import TYPE_CHECKING

from pydantic import BaseModel, ConfigDict, Field

from catseye.procedures.kit.context import Context
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.scara import texts
from catseye.procedures.scara.aiming import SEARCHED
from catseye.procedures.scara.before import (
    ALIGNED,
    COMPENSATE,
    CONVENTIONAL,
    COUNTER,
    DOSSIER,
    IDENTIFY,
    MEASURING,
    REFLECTORS,
    REPORT,
    WARM,
)
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.explained import OPEN_LOOP
from catseye.procedures.scara.open_loop.off_node import usual_count
from catseye.procedures.scara.open_loop.open_loop_plan import OpenLoopPlan, Rules, plan_open_loop
from catseye.procedures.scara.questions import MOUNT, TRACKED
from catseye.procedures.scara.records import (
    AlignmentRound,
    ClosureVisit,
    Distance,
    Overlap,
    ScrewTurn,
)

if TYPE_CHECKING:
    from catseye.procedures.scara.open_loop.remount import Remount


class OpenLoopParams(BaseModel):
    """What may be chosen for a measurement."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    reflectors: list[str] = Field(
        [], title="Reflectors", description="names of the reflectors to measure to; empty: all"
    )
    subdivide: bool = Field(
        True,
        title="Split long moves",
        description="split moves so that the beam is kept; false shows where it would be lost",
    )
    take_up: bool = Field(
        True,
        title="Take up the backlash",
        description="approach each node from the intended side; false shows the effect of backlash",
    )
    closures: int = Field(
        2,
        ge=0,
        le=20,
        title="Returns (closures)",
        description="returns to an early pose for each reflector, which show drift",
    )
    off_node: int | None = Field(
        None,
        ge=0,
        le=50,
        title="Points between nodes",
        description="commands between the nodes, which show how far the joints deviate from the map there; by "
        "default 12, fewer where J1 has few nodes",
    )
    drift_limit_um: float = Field(
        30.0,
        gt=0.0,
        le=1000.0,
        title="Warn of drift, µm",
        description="drift beyond which a warning is given, µm",
    )
    recovery_attempts: int = Field(
        3,
        ge=1,
        le=20,
        title="Tries to find the beam",
        description="consecutive failed attempts to find a lost beam before you are asked",
    )
    j4_reversal: bool = Field(
        False,
        title="Reversal of J4",
        description="measure everything twice, the second time with the interferometer turned by half a turn on "
        "the flange of J4; this separates odd orders of J4's radial error motion from the maps",
    )
    stop_at_mdeg: float = Field(
        0.0,
        ge=0.0,
        le=100.0,
        title="Stop early at u, mdeg",
        description="stop once the largest standard uncertainty u of both maps is below this, mdeg (screens show U "
        "= 2 u); 0: never; with j4_reversal in the turned half only",
    )


class OpenLoop(Procedure):
    """Visits every node from both sides, and a few places between them, with the beam on each reflector in turn."""

    name = "open-loop"
    title = "Automated open-loop tracking measurement"
    explanation = OPEN_LOOP
    needs = Needs(ScaraBench, COUNTER, equipment=(REFLECTORS,), after=(ALIGNED, WARM), basis=SEARCHED)
    stage = MEASURING
    records = (Distance, Overlap, ClosureVisit, AlignmentRound, ScrewTurn)
    analyses = (IDENTIFY, CONVENTIONAL, COMPENSATE, REPORT, DOSSIER)
    event_texts = texts.MEASUREMENT
    demo = ()
    questions = (*TRACKED, MOUNT)
    params_type = OpenLoopParams

    def __init__(self) -> None:
        self._remount: Remount | None = None

    def equipped(self, bench: ScaraBench, params: OpenLoopParams) -> ScaraBench:
        """Return the bench; where the interferometer is to be turned its head is kept clear both ways."""
        return bench.with_turned_head() if params.j4_reversal else bench

    def plan(self, bench: ScaraBench, params: OpenLoopParams) -> OpenLoopPlan:
        """Plan the measurement; see plan_open_loop."""
        plan = plan_open_loop(
            bench,
            subdivide=params.subdivide,
            take_up=params.take_up,
            reflectors=tuple(params.reflectors),
            closures=params.closures,
            off_node=usual_count(bench.nodes1_deg) if params.off_node is None else params.off_node,
            j4_reversal=params.j4_reversal,
        )
        rules = Rules(params.recovery_attempts, params.drift_limit_um * 1e-3, params.stop_at_mdeg)
        return replace(plan, rules=rules)

    async def run(self, ctx: Context, plan: OpenLoopPlan) -> None:
        """Measure all reflectors, and once more with the interferometer turned where that is planned.

        Raises:
            BeamLostError: the beam stays away and the operator ends the run.
            WayBlockedError: the arm cannot be led to a point from where it stands.
            CounterError: sign or scale of the counter are wrong.
            AlignmentError: the interferometer was not turned, or its beam could not be aligned.
            MostLeftOutError: most points were left out.
        """
        from catseye.procedures.scara.open_loop.halves import Halves

        for text in plan.warnings:
            await ctx.warn(text)
        halves = Halves(ctx, plan)
        await halves.measure(plan.bench, plan.reflectors, last=plan.remount is None)
        if plan.remount is not None:
            self._remount = halves.remount(plan.remount)
            await self._remount.turn()
            mounting = await self._remount.align()
            await halves.measure(*halves.turned(mounting), last=True)
        await halves.judge()

    async def teardown(self, ctx: Context) -> None:
        """Say how the interferometer is mounted, if it was turned."""
        turned_deg = 0.0 if self._remount is None else self._remount.turned_deg
        if turned_deg:
            await ctx.warn(
                f"the interferometer stays turned by {turned_deg:.1f}° against the beginning of the run: "
                "mount it as it was before another search, or add that to theta40_deg in [optics]; then align the "
                "beam (beam-level, beam-to-j4) and search again"
            )
