"""Where the cup of a ballbar stands: a nest of the tool is led into it by hand, and the joints tell its place."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.tracker import Place
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import OutOfReachError, PlanError
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Json, Record, Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.kit.tasks import SeatInCup, Task
from catseye.procedures.serial_arm.ballbar import BallbarParams, BallbarTest
from catseye.procedures.serial_arm.before import CUP_TEXTS
from catseye.procedures.serial_arm.bench import Ballbar, SerialBench, ToolTarget, ballbar_of
from catseye.procedures.serial_arm.calibrated import RESULT, calibrated, identified_target
from catseye.procedures.serial_arm.explained import BALLBAR_CUP
from catseye.procedures.serial_arm.pose_params import rest_of
from catseye.procedures.serial_arm.questions import COMPARED, SEATED

if TYPE_CHECKING:
    from catseye.calibration.serial_arm.geometry import Geometry

Floats = NDArray[np.float64]

_PLACE: Final = ("x_mm", "y_mm", "z_mm")

_Look = Callable[[Floats, list[float]], Awaitable[Row | str]]
"""Given the place of the nest and the joints: the row of it, or why it cannot be true."""

_TURNED_DEG: Final = 5.0
"""By which some joint has moved, where a taking says more than the one before."""

_MOST_TRIES: Final = 3
"""Of one taking, before the run ends."""


class CupParams(BaseModel):
    """What may be chosen for finding the cup."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    result: Annotated[dict[str, Any], RESULT] = Field(
        title="Result file",
        description="result of catseye calibrate, with the positions of the tool's nests",
        json_schema_extra={"file": "JSON"},
    )
    nest: str = Field(
        "",
        title="Nest of the tool",
        description="nest whose ball is brought into the cup; empty: the first",
    )
    takings: int = Field(
        2,
        ge=2,
        le=9,
        title="Repeats",
        description="how often you bring the ball into the cup, each time with the tool turned differently",
    )
    agree_mm: float = Field(
        0.5,
        gt=0.0,
        le=5.0,
        title="Agreement, mm",
        description="largest distance of a repeat from the first position, mm",
    )


@dataclass(frozen=True, kw_only=True)
class CupTaking(Record):
    """The place of the cup as the joints tell it. `extra` has the joints `q`.

    Attributes:
        nest: of the tool, whose ball sat in the cup.
        taking: its number, from 1.
        x_mm: in the frame of the arm's base.
        y_mm: likewise.
        z_mm: likewise.
    """

    table: ClassVar[str] = "cup"
    is_point: ClassVar[bool] = True
    point_name: ClassVar[str] = "taking"
    target_column: ClassVar[str] = "nest"
    nest: str
    taking: int
    x_mm: float
    y_mm: float
    z_mm: float


@dataclass(frozen=True)
class CupPlan:
    """What is asked for. Nothing is driven: a person leads the arm.

    Attributes:
        bench: whose arm is led.
        ballbar: with the place of the cup that the cell file states.
        nest: of the tool.
        result: a calibration.
        takings: how often.
        agree_mm: largest distance between a taking and the first.
        rehearsed: how the nominal arm holds the nest at the stated place.
    """

    bench: SerialBench
    ballbar: Ballbar
    nest: str
    result: Mapping[str, Any]
    takings: int
    agree_mm: float
    rehearsed: Pose


class BallbarCup(Procedure):
    """Finds the place of the ballbar's cup: a person leads a nest of the tool into it, several times."""

    name = "ballbar-cup"
    title = "Place of the ballbar's cup"
    explanation = BALLBAR_CUP
    needs = Needs(SerialBench)
    records = (CupTaking,)
    event_texts = CUP_TEXTS
    questions = (SEATED, COMPARED)
    params_type = CupParams

    def plan(self, bench: SerialBench, params: CupParams) -> CupPlan:
        """Check that the cell has a ballbar, the tool the nest, and the result an arm like this.

        Raises:
            PlanError: one of them is missing, or no arm like this holds the nest where the cell file has the cup.
        """
        ballbar, nest = ballbar_of(bench), bench.chosen([params.nest] if params.nest else [])[0]
        geometry = calibrated(bench, params.result)
        rehearsed = _held(bench, identified_target(bench, geometry, nest.name), ballbar)
        return CupPlan(bench, ballbar, nest.name, params.result, params.takings, params.agree_mm, rehearsed)

    async def run(self, ctx: Context, plan: CupPlan) -> None:
        """Take the place several times, have the bar's length compared, and say where the cup stands."""
        await CupRun(ctx, plan).run()


class CupRun:
    """Asks, reads the joints and looks whether it can be true.

    Args:
        ctx: the bench.
        plan: what is asked for.
    """

    def __init__(self, ctx: Context, plan: CupPlan) -> None:
        self._ctx = ctx
        self._plan = plan
        self._taken: list[Floats] = []
        self._stood: list[list[float]] = []

    async def run(self) -> None:
        """Take the place of the cup.

        Raises:
            OutOfReachError: the operator ends the run, or what the joints tell cannot be true.
        """
        count = self._plan.takings
        for number in range(1, count + 1):
            title = f"the cup, {number} of {count}"
            row = await self._ctx.step(f"cup/{number - 1}", title, partial(self._take, number))
            self._taken.append(np.array([number_of(row, name) for name in _PLACE]))
        centre = np.mean(self._taken, axis=0)
        bar = await self._ctx.step("bar", "the bar's length", partial(self._compare, centre))
        apart = max(float(np.linalg.norm(one - centre)) for one in self._taken)
        x, y, z = (float(value) for value in centre)
        await self._ctx.event(
            "cup-found", nest=self._plan.nest, centre_mm=[x, y, z], apart_mm=apart, bar_off_mm=bar["off_mm"]
        )
        await self._warn_of_reach((x, y, z))

    async def _take(self, number: int) -> Row:
        """Have the nest led into the cup until the place can be true."""
        turned = "" if number == 1 else ", the tool turned by 30° or more from the last time"
        text = (
            f"Lead {self._plan.nest} with its ball into the cup by pendant, slowly, down to its seat{turned}."
        )
        return await self._tried(f"cup/{number}", text, partial(self._seated, number))

    async def _seated(self, number: int, place: Floats, joints: list[float]) -> Row | str:
        """Return the row of a taking, or why it cannot be true."""
        if fault := self._fault(place):
            return fault
        if self._stands_as_before(joints):
            await self._ctx.warn(
                "the arm is in a pose that was measured before, so this repeat proves nothing: lead "
                f"{self._plan.nest} into the cup with the tool turned by 30° or more"
            )
        self._stood.append(joints)
        values = dict(zip(_PLACE, (float(value) for value in place), strict=True))
        extra: dict[str, Json] = {"q": list(joints)}
        self._ctx.record(CupTaking(nest=self._plan.nest, taking=number, extra=extra, **values))
        return {**values}

    def _stands_as_before(self, joints: list[float]) -> bool:
        if tuple(joints) == self._plan.rehearsed:
            # A rehearsal, in which nobody can turn the tool.
            return False
        return any(
            max(abs(a - b) for a, b in zip(one, joints, strict=True)) < _TURNED_DEG for one in self._stood
        )

    def _fault(self, place: Floats) -> str:
        ballbar, name = self._plan.ballbar, self._plan.nest
        away = float(np.linalg.norm(place - np.array(ballbar.centre_mm)))
        if away > ballbar.length_mm:
            return (
                f"By its joints the arm holds {name} {away:.0f} mm from where centre_mm in [ballbar] has the cup, "
                f"which is more than the bar is long ({ballbar.length_mm:g} mm): see whether {name} is the nest in "
                "the cup, and correct centre_mm if the cup stands elsewhere. "
            )
        if self._taken and (apart := float(np.linalg.norm(place - self._taken[0]))) > self._plan.agree_mm:
            return (
                f"This is {apart:.2f} mm from the first taking, and {self._plan.agree_mm:g} mm is the limit: check "
                f"that the ball of {name} sits on its seat, the cup is clamped, and the result was identified with "
                "this tool. "
            )
        return ""

    async def _compare(self, centre: Floats) -> Row:
        """Have the bar hung in by hand: the two nests that it joins are as far apart as it is long."""
        ballbar, name = self._plan.ballbar, self._plan.nest
        text = (
            f"Lead {name} out of the cup by pendant, to about {ballbar.length_mm:g} mm from it, and mount the "
            "ballbar between the two, so that it shows a reading; or leave this out (skip)."
        )

        async def compared(place: Floats, joints: list[float]) -> Row | str:
            del joints
            off = float(np.linalg.norm(place - centre)) - ballbar.length_mm
            if abs(off) <= ballbar.range_mm + self._plan.agree_mm:
                return {"off_mm": off}
            return (
                f"By the joints the cup and {name} are {ballbar.length_mm + off:.1f} mm apart, and the bar is "
                f"{ballbar.length_mm:g} ± {ballbar.range_mm:g} mm long: see whether {name} is the nest with the "
                "bar, the tool's file has this nest where it is, and length_mm in [ballbar] is that of this bar. "
            )

        return await self._tried("bar", text, compared, skip={"off_mm": None})

    async def _tried(self, name: str, text: str, look: _Look, skip: Row | None = None) -> Row:
        """Ask until the place of the nest can be true."""
        complaint = ""
        for attempt in range(1, _MOST_TRIES + 1):
            prompt_id = name if attempt == 1 else f"{name}/{attempt}"
            answer = await self._ctx.ask(
                _skippable(prompt_id, complaint + text)
                if skip is not None
                else _seat(prompt_id, complaint + text, SeatInCup(target=self._plan.nest))
            )
            if answer == "skip" and skip is not None:
                return skip
            if answer != "done":
                raise OutOfReachError(f"the operator ended the run at the cup; {self._then}")
            joints = list(await self._ctx.led_joints(self._plan.rehearsed))
            found = await look(self._place(joints), joints)
            if not isinstance(found, str):
                return found
            complaint = found
            await self._ctx.warn(complaint.strip())
        raise OutOfReachError(f"{complaint}Then {self._then}")

    @property
    def _then(self) -> str:
        """What goes on with an ended run, which replays the takings that are stored."""
        if not self._taken:
            return "continue with catseye resume"
        return (
            "start again if the first taking may be wrong: catseye resume keeps it. Otherwise continue with "
            "catseye resume"
        )

    @cached_property
    def _geometry(self) -> "Geometry":
        return calibrated(self._plan.bench, self._plan.result)

    def _place(self, joints: list[float]) -> Floats:
        from catseye.procedures.serial_arm.ballbar_path import places_mm

        names = [one.name for one in self._plan.bench.targets]
        found: Floats = places_mm(self._geometry, names.index(self._plan.nest), np.array([joints]))[0]
        return found

    async def _warn_of_reach(self, centre_mm: Place) -> None:
        """Say when the arm cannot lead the bar about this place with what ballbar does by default."""
        plan = self._plan
        bench = replace(plan.bench, ballbar=replace(plan.ballbar, centre_mm=centre_mm))
        params = BallbarParams(result=dict(plan.result), nests=[plan.nest])
        try:
            await asyncio.to_thread(BallbarTest().plan, bench, params)
        except (PlanError, OutOfReachError) as error:
            await self._ctx.warn(f"ballbar cannot move about this cup on its default path: {error}")


def _held(bench: SerialBench, nest: ToolTarget, ballbar: Ballbar) -> Pose:
    """Return how the nominal arm holds a nest in the cup, as it would hold it on top of a bar.

    Args:
        nest: where it was identified on the flange.
    """
    from catseye.procedures.serial_arm.ballbar_path import SpherePoint, nominal_path

    below = np.array(ballbar.centre_mm) - [0.0, 0.0, ballbar.length_mm]
    top = SpherePoint(0.0, 90.0, measured=True, towards_deg=0.0)
    try:
        joints = nominal_path(bench, nest, below, ballbar.length_mm, [top], rest_of(bench, []))
    except PlanError as error:
        place = ", ".join(f"{value:g}" for value in ballbar.centre_mm)
        raise PlanError(
            f"the arm cannot hold {nest.name} in a cup at {place} mm, where centre_mm in [ballbar] places it: "
            "state the cup's position to a few centimetres, give another nest, or place the cup elsewhere"
        ) from error
    return tuple(joints[0].tolist())


def _seat(prompt_id: str, text: str, task: Task) -> Prompt:
    return SEATED.prompt(prompt_id, f"{text} Done (done), or end the run (stop)?", task=task)


def _skippable(prompt_id: str, text: str) -> Prompt:
    return COMPARED.prompt(prompt_id, f"{text} Leave it out (skip), done (done), or end the run (stop)?")
