"""Radial error motion of J1 and J2: an artefact on the axis, read by an indicator while the joint turns by itself.

The SCARA paper states what its axes have (Table 2) and that it was measured, not with what. This is the test of
ISO 230-7 with what a workshop has: a ball or a cylinder, and an indicator whose readings are typed.
"""

from functools import partial
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

from catseye.calibration.standards.error_motion import Gauging, error_motion
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Row
from catseye.procedures.scara import texts
from catseye.procedures.scara.before import BUDGET, GAUGING, WARM
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.explained import RADIAL_ERROR_MOTION
from catseye.procedures.scara.questions import RADIAL
from catseye.procedures.scara.radial.radial_plan import (
    WHOLE_DEG,
    Direction,
    Joint,
    RadialPlan,
    Reading,
    sweep_of,
)
from catseye.procedures.scara.radial.radial_run import RadialRun
from catseye.procedures.scara.radial.reduction import motion_row, run_out_of
from catseye.procedures.scara.records import RunOutReading

RESULT: Final = "result"
"""After the name of a joint in the name of the step that finds its error motion."""

Arc = Annotated[list[Annotated[float, Field(ge=-360.0, le=360.0)]], Field(max_length=2)]


class RadialParams(BaseModel):
    """What may be chosen for the measurement of radial error motions."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    joints: list[Joint] = Field(
        ["J1", "J2"],
        min_length=1,
        max_length=2,
        title="Joints",
        description="joints to measure, in this order",
    )
    directions: Literal["x", "xy"] = Field(
        "xy",
        title="Directions",
        description="sensitive directions; with x alone the whole first harmonic counts as eccentricity",
    )
    indicators: int = Field(
        1,
        ge=1,
        le=2,
        title="Indicators",
        description="number of indicators read at each position; with 1, first x, then y",
    )
    reversal: bool = Field(
        False,
        title="Reverse the artefact",
        description="measure again with the artefact turned by half a turn, to remove its form",
    )
    cycles: int = Field(
        3, ge=2, le=20, title="Cycles", description="number of readings of each position from either side"
    )
    step_deg: float = Field(
        20.0, ge=1.0, le=45.0, title="Step, deg", description="angle between two positions, deg"
    )
    j1_deg: Arc = Field(
        [],
        title="Arc of J1, deg",
        description="ends of the arc of J1, deg; empty: as far as it turns freely",
    )
    j2_deg: Arc = Field(
        [],
        title="Arc of J2, deg",
        description="ends of the arc of J2, deg; empty: as far as it turns freely",
    )
    centre_within_um: float = Field(
        20.0, gt=0.0, le=500.0, title="Centred within, µm", description="largest accepted eccentricity, µm"
    )
    resolution_um: float = Field(
        1.0,
        ge=0.0,
        le=20.0,
        title="Resolution, µm",
        description="smallest step in which you read the indicator, µm",
    )
    u_indicator_um: float | None = Field(
        None,
        ge=0.0,
        le=20.0,
        title="u of the indicator, µm",
        description="standard uncertainty of a reading, from the indicator's certificate, µm",
    )
    form_um: float | None = Field(
        None,
        ge=0.0,
        le=20.0,
        title="Form of artefact, µm",
        description="roundness deviation of the artefact, from its certificate, µm",
    )
    readings: Literal["typed", "file"] = Field(
        "typed",
        title="Readings",
        description="typed: a person types each; file: after each cycle a CSV of the indicator's program is read, "
        "with the columns angle_deg and reading_um (or reading_mm), one row for each place in the order of driving",
    )
    record_s: float = Field(
        3.0,
        ge=0.5,
        le=60.0,
        title="Recording, s",
        description="standstill at each place for the indicator's program, s; for readings=file",
    )
    settle_s: float = Field(
        1.0, ge=0.0, le=60.0, title="Settling, s", description="wait at standstill before a reading, s"
    )


class RadialErrorMotion(Procedure):
    """Turns J1 and J2 by themselves, step by step in both directions, and has an artefact on their axis read."""

    name = "radial-error-motion"
    title = "Radial error motion of J1 and J2"
    explanation = RADIAL_ERROR_MOTION
    needs = Needs(ScaraBench, after=(WARM,))
    stage = GAUGING
    records = (RunOutReading,)
    analyses = (BUDGET,)
    event_texts = texts.ERROR_MOTION
    questions = RADIAL
    params_type = RadialParams

    def __init__(self) -> None:
        self._run: RadialRun | None = None

    def plan(self, bench: ScaraBench, params: RadialParams) -> RadialPlan:
        """Choose the arcs.

        Raises:
            PlanError: a joint does not turn far enough, or a joint is named twice.
        """
        if len(set(params.joints)) < len(params.joints):
            raise PlanError("a joint is named twice: each is measured once")
        along = _along(params)
        readings: list[Reading] = []
        for joint in params.joints:
            given = params.j1_deg if joint == "J1" else params.j2_deg
            if len(given) == 1:
                raise PlanError(f"{joint.lower()}_deg has one end: state both, or none")
            sweep = sweep_of(bench, joint, given, params.step_deg)
            for turned in (False, True) if params.reversal else (False,):
                readings += [Reading(sweep, turned, one, mounted=n == 0) for n, one in enumerate(along)]
        gauging = Gauging(params.resolution_um, params.u_indicator_um, params.form_um)
        recorded_s = params.record_s if params.readings == "file" else None
        return RadialPlan(
            bench,
            tuple(readings),
            params.cycles,
            params.settle_s,
            params.centre_within_um,
            gauging,
            recorded_s,
        )

    async def run(self, ctx: Context, plan: RadialPlan) -> None:
        """Measure joint after joint.

        Raises:
            AlignmentError: the artefact could not be centred.
            OutOfReachError: the operator ends the run.
        """
        self._run = RadialRun(ctx, plan)
        for sweep in dict.fromkeys(reading.sweep for reading in plan.readings):
            if sweep.arc_deg < WHOLE_DEG:
                await ctx.warn(
                    f"{sweep.joint} is measured over {sweep.arc_deg:g}° only: fitting the centre of a short arc "
                    "absorbs a part of the error motion, so the values hold for this arc and are lower limits for a "
                    "larger one"
                )
            rows = [
                row
                for reading in plan.readings
                if reading.sweep == sweep
                for row in await self._run.read(reading)
            ]
            await self._run.take_off(sweep)
            title = f"{sweep.joint}: radial error motion"
            evaluate = partial(_evaluated, ctx, plan, sweep.joint, rows)
            await ctx.step(f"{sweep.joint}/{RESULT}", title, evaluate)

    async def teardown(self, ctx: Context) -> None:
        """Say so where the artefact is left on its axis."""
        if self._run is not None and self._run.mounted:
            await ctx.warn(
                "artefact and indicator are still mounted: take them off before anything else moves the arm"
            )


def _along(params: RadialParams) -> tuple[tuple[Direction, ...], ...]:
    if params.directions == "x":
        return (("x",),)
    return (("x", "y"),) if params.indicators == 2 else (("x",), ("y",))


async def _evaluated(ctx: Context, plan: RadialPlan, joint: str, rows: list[Row]) -> Row:
    found = error_motion(run_out_of(rows), plan.gauging)
    row = motion_row(joint, found)
    await ctx.event("radial-error-motion", **row)
    return row
