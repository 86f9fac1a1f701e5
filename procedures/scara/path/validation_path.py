"""A straight path both ways (Sec. 4.3 of the SCARA paper), or the lines of a file, measured independently."""

from dataclasses import replace
from functools import partial
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator

from catseye.calibration.scara.planar import Hand, forward
from catseye.drivers.roles.pose import Pose, is_at
from catseye.drivers.roles.tracker import Position
from catseye.procedures.kit.asked_file import asked_file
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import ArmMovedError, PlanError
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Row
from catseye.procedures.scara import texts
from catseye.procedures.scara.aiming import SEARCHED
from catseye.procedures.scara.before import ALIGNED, COUNTER, DRIVING_A_PATH, REFLECTORS, TRACKER, VALIDATE
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.explained import VALIDATION_PATH
from catseye.procedures.scara.motion.entry import way_in
from catseye.procedures.scara.path.followed_target import FollowedTarget
from catseye.procedures.scara.path.given_path import plan_given_path, plan_joint_rows
from catseye.procedures.scara.path.instrument_file import POSITIONS, mapping_of
from catseye.procedures.scara.path.measured_path import commands_as_measured, matched_positions
from catseye.procedures.scara.path.path_plan import Instrument, PathPlan, plan_path, take_up_of
from catseye.procedures.scara.path.rows import JointRow, PathRow
from catseye.procedures.scara.path.tables import JOINT_ROWS, MEASURED, PATH
from catseye.procedures.scara.path.tracked_path import PathPoint, TrackedCampaign
from catseye.procedures.scara.questions import MEASURED_FILE, POINT, TARGET, TRACKED
from catseye.procedures.scara.records import Overlap, PathPosition

_ATTEMPTS = 3
"""So often a point is measured anew when the arm was moved meanwhile."""


class PathParams(BaseModel):
    """What may be chosen for a validation path."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    # The bounds hold for any arm; whether this one reaches is found out by the plan.
    x_mm: float = Field(
        200.0, ge=-5000.0, le=5000.0, title="Path at x, mm", description="x of the straight path, mm"
    )
    y_from_mm: float = Field(
        -500.0, ge=-5000.0, le=5000.0, title="From y, mm", description="y of the path's first end, mm"
    )
    y_to_mm: float = Field(
        500.0, ge=-5000.0, le=5000.0, title="To y, mm", description="y of the path's other end, mm"
    )
    step_mm: float = Field(
        10.0,
        ge=0.1,
        le=500.0,
        title="Largest step, mm",
        description="largest distance between two points, mm",
    )
    hand: Hand = Field("right", title="Hand of the arm", description="right: θ2 >= 0; left: θ2 < 0")
    passes: int = Field(1, ge=1, le=100, title="Passes", description="how often the whole path is driven")
    instrument: Instrument | None = Field(
        None,
        title="Measured by",
        description="tracker, interferometer, or file for a tracker's own CSV; by default the cell's tracker, or "
        "the interferometer if there is none",
    )
    reflector: str = Field(
        "",
        title="Reflector",
        description="reflector that the interferometer measures to; by default the one visible from most of the path",
    )
    hold_time_s: float = Field(
        2.0,
        ge=0.0,
        le=600.0,
        title="Hold at a point, s",
        description="with file: standstill at each point, s",
    )
    confirm_each: bool = Field(
        False, title="Confirm each point", description="with file: wait at each point until you confirm it"
    )
    path: Annotated[list[PathRow], PATH] = Field(
        [],
        title="Path file",
        description="path file (CSV or TOML) to drive instead of the straight path",
        json_schema_extra={"file": "CSV"},
    )
    joints: Annotated[list[JointRow], JOINT_ROWS] = Field(
        [],
        title="Commands as they are",
        description="CSV of catseye compensate whose commands are driven unchanged instead of the straight path",
        json_schema_extra={"file": "CSV"},
    )
    mapping: Annotated[dict[str, Any], POSITIONS] = Field(
        {},
        description="mapping of a file written by the tracker's own program, as catseye validate --preview "
        "suggests it; without it the file is a measured CSV",
        json_schema_extra={"file": "TOML"},
    )

    @field_validator("mapping")
    @classmethod
    def _maps_positions(cls, value: dict[str, Any]) -> dict[str, Any]:
        if value:
            mapping_of(value)
        return value


class ValidationPath(Procedure):
    """Drives the path and records where an instrument sees the arm, or how far it is from a reflector."""

    name = "validation-path"
    title = "Validation path"
    explanation = VALIDATION_PATH
    needs = Needs(ScaraBench, COUNTER, equipment=(REFLECTORS, TRACKER), after=(ALIGNED,), basis=SEARCHED)
    stage = DRIVING_A_PATH
    records = (PathPosition, Overlap)
    analyses = (VALIDATE,)
    event_texts = texts.FOLLOWING
    demo = ("passes=5",)
    questions = (*TRACKED, POINT, TARGET, MEASURED_FILE)
    params_type = PathParams

    def plan(self, bench: ScaraBench, params: PathParams) -> PathPlan:
        """Plan the path; see plan_path, plan_given_path for a file, plan_joint_rows for given commands.

        Raises:
            PlanError: two files are given, or a mapping of none; also as those say.
        """
        if params.joints and params.path:
            raise PlanError("path and joints both say what is driven: give one of them")
        plan = self._path(bench, params)
        if not params.mapping:
            return plan
        if plan.instrument != "file":
            raise PlanError(
                f"mapping is for --param instrument=file, and the {plan.instrument} measures this path: leave it out"
            )
        return replace(plan, mapping=mapping_of(params.mapping))

    def _path(self, bench: ScaraBench, params: PathParams) -> PathPlan:
        chosen = {"passes", "instrument", "hold_time_s", "confirm_each"}
        if params.joints:
            return plan_joint_rows(bench, params.joints, **params.model_dump(include=chosen))
        if params.path:
            return plan_given_path(
                bench, params.path, **params.model_dump(include=chosen | {"hand", "reflector"})
            )
        return plan_path(bench, **params.model_dump(exclude={"joints", "path", "mapping"}))

    async def run(self, ctx: Context, plan: PathPlan) -> None:
        """Drive and measure.

        Args:
            ctx: the bench; it has the instrument that the plan names.

        Raises:
            HiddenTargetsError: the tracker does not follow the arm, and the operator ends the run.
            BeamLostError: the operator ends the run since the beam does not come back.
            ArmMovedError: the arm was moved again and again while a point was measured.
            TableFileError: no file that was given can be used.
            WayBlockedError: the arm cannot be led to the path.
        """
        if plan.tracked is not None:
            await TrackedCampaign(ctx, plan.bench, plan.tracked, plan.points).run()
            return
        drive = _Drive(ctx, plan)
        for pass_number in range(plan.passes):
            title = f"pass {pass_number + 1}: approach the first point"
            await ctx.step(f"run-in/{pass_number}", title, drive.run_in)
            for number, point in enumerate(plan.points):
                title = f"x {point.x_mm:g} mm, y {point.y_mm:g} mm"
                step_id = f"path/{pass_number}/{number:04d}"
                drive.recall(
                    point, await ctx.step(step_id, title, partial(drive.visit, point, pass_number, number))
                )
                drive.report_progress(pass_number, number)
        if plan.instrument == "file":
            await ctx.step(
                "measured-file", "positions from the instrument's file", partial(_take_file, ctx, plan)
            )


class _Drive:
    """Drives the path; knows where it left the arm, with the directions of approach of the points."""

    def __init__(self, ctx: Context, plan: PathPlan) -> None:
        self._ctx = ctx
        self._plan = plan
        self._left: Pose | None = None
        self._next: Pose | None = None
        self._target = FollowedTarget(ctx, plan.bench.timing.settle_time_s)

    async def run_in(self) -> Row:
        """Go to where the first point is approached from."""
        await self._enter(self._plan.run_in)
        return {}

    async def visit(self, point: PathPoint, pass_number: int, number: int) -> Row:
        """Stand at a point and let it be measured."""
        self._next = self._joints_of(number + 1)
        for attempt in range(_ATTEMPTS):
            if not await self._undisturbed():
                # The arm may stand anywhere, and came there from any side.
                await self._enter(take_up_of(point, self._plan.bench))
            elif self._plan.come_from and (beyond := self._plan.come_from[number]) is not None:
                await (self._enter if number in self._plan.entered else self._move)(beyond)
            await self._move(point.pose(self._plan.bench))
            found = await self._measured(point, f"point/{pass_number}/{number:04d}", attempt)
            if await self._undisturbed():
                return self._kept(point, pass_number, found)
            await self._ctx.warn(
                f"the arm no longer stands at x {point.x_mm:g} mm, y {point.y_mm:g} mm, where it was sent: somebody "
                "has moved it; the point is approached and measured again, leave the arm alone"
            )
        raise ArmMovedError(
            f"the arm was moved {_ATTEMPTS} times while x {point.x_mm:g} mm, y {point.y_mm:g} mm was measured: find "
            "out who or what moves it, then continue with catseye resume"
        )

    def recall(self, point: PathPoint, row: Row) -> None:
        """Have the next point compared with one that is done, perhaps before a resume."""
        match row:
            case {"x_meas_mm": int() | float() as x_mm, "y_meas_mm": int() | float() as y_mm}:
                self._target.recall(self._commanded_mm(point), (x_mm, y_mm))

    def report_progress(self, pass_number: int, number: int) -> None:
        """Report how far the path is driven, in expected bench seconds."""
        total = self._plan.passes * len(self._plan.points)
        done = pass_number * len(self._plan.points) + number + 1
        duration_s = self._plan.duration_s
        self._ctx.progress(duration_s * done / total, duration_s, f"path point {done}/{total}")

    def _joints_of(self, number: int) -> Pose | None:
        """Return the joints at a point; None after the last one of a pass."""
        if number >= len(self._plan.points):
            return None
        return self._plan.points[number].pose(self._plan.bench)

    async def _enter(self, target: Pose) -> None:
        for pose in way_in(await self._ctx.joints(), target, self._plan.bench):
            await self._move(pose)

    async def _move(self, target: Pose) -> None:
        await self._ctx.move(target)
        self._left = target

    async def _undisturbed(self) -> bool:
        """Return whether the arm stands where this process left it."""
        return self._left is not None and is_at(await self._ctx.joints(), self._left)

    async def _measured(self, point: PathPoint, prompt_id: str, attempt: int) -> Position | None:
        """Let the instrument measure; None when its file gives the position later."""
        question = prompt_id + (f"/again{attempt}" if attempt else "")
        if self._plan.instrument != "file":
            return await self._target.at(self._commanded_mm(point), question, self._next)
        await self._hold(point, question)
        return None

    def _commanded_mm(self, point: PathPoint) -> tuple[float, float]:
        """Return where a point's commands lead; given commands are corrected and need not lead to its x and y."""
        bench, angles = self._plan.bench, np.deg2rad([point.theta1_deg, point.theta2_deg])
        x_mm, y_mm = forward(angles[0], angles[1], bench.link1_mm, bench.link2_mm).tolist()
        return x_mm, y_mm

    def _kept(self, point: PathPoint, pass_number: int, found: Position | None) -> Row:
        if found is None:
            return {}
        self._ctx.record(point.position(pass_number, (found.x_mm, found.y_mm), found.u_mm))
        return {"x_meas_mm": found.x_mm, "y_meas_mm": found.y_mm}

    async def _hold(self, point: PathPoint, prompt_id: str) -> None:
        """Stand still for the instrument; a "no" of the operator gives it more time."""
        await self._ctx.pause(self._plan.hold_time_s)
        number = 1
        while (
            self._plan.confirm_each
            and await self._ctx.ask(_point_prompt(point, prompt_id, number, self._next)) != "yes"
        ):
            await self._ctx.pause(self._plan.hold_time_s)
            number += 1


def _point_prompt(point: PathPoint, prompt_id: str, number: int, target: Pose | None) -> Prompt:
    return POINT.prompt(
        prompt_id if number == 1 else f"{prompt_id}/{number}",
        f"Measure the arm at x {point.x_mm:g} mm, y {point.y_mm:g} mm with the instrument; "
        "is the point taken? The arm then moves on.",
        target=target,
    )


async def _take_file(ctx: Context, plan: PathPlan) -> Row:
    """Ask for the instrument's file until one can be used."""
    ideal = commands_as_measured(plan.points * plan.passes)
    prompt = MEASURED_FILE.prompt("measured-file", "Type the path of the tracker's file of these points.")

    def positions_in(file: str, rows: Columns) -> list[PathPosition]:
        return matched_positions(file, plan.points, plan.passes, rows, plan.mapping)

    file, positions = await asked_file(ctx, prompt, plan.mapping or MEASURED, ideal, positions_in)
    for position in positions:
        ctx.record(position)
    return {"file": file, "points": len(positions)}
