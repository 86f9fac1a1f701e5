"""What the instrument itself is worth: repeats, both faces, a scale bar, and the tool as it was measured before.

Six-axis paper, section 2 (scale bar) and Table V (nests of the tool against a coordinate measuring machine).
"""

import math
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import ClassVar, Final

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from catseye.drivers.roles.errors import HiddenTargetError
from catseye.drivers.roles.tracker import Face, Place
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Record, Row
from catseye.procedures.kit.tasks import SetUpScaleBar
from catseye.procedures.serial_arm.before import CHECK_TEXTS, CHECKING, NESTS, TRACKER
from catseye.procedures.serial_arm.bench import Instrument, SerialBench
from catseye.procedures.serial_arm.explained import INSTRUMENT_CHECK
from catseye.procedures.serial_arm.questions import BAR
from catseye.procedures.serial_arm.records import MeasuredNest, coordinates
from catseye.procedures.serial_arm.turning import near_mm

NEST: Final = "nest/"
"""Before the name of a nest in the name of the step that measures it."""

_FACES: Final[tuple[Face, Face]] = (1, 2)

_TURNS_DEG: Final = (90.0, 45.0, 135.0)
"""Of the scale bar against the line of sight; along it one end would hide the other."""

_LOWEST_MM: Final = 300.0
_HIGHER_MM: Final = 150.0
"""Heights above the arm's base at which the bar is laid."""


@dataclass(frozen=True, kw_only=True)
class CheckedLength(Record):
    """A length between two points, measured and known.

    Attributes:
        what: a scale bar or the tool.
        from_point: name of one end.
        to_point: name of the other.
        laid: place at which the scale bar lay, from 1; 0 of the tool.
        measured_mm: mean of the repeats.
        reference_mm: of the certificate, or of the tool's description.
        error_mm: measured less known.
    """

    table: ClassVar[str] = "lengths"
    is_point: ClassVar[bool] = True
    point_name: ClassVar[str] = "length"
    target_column: ClassVar[str] = "what"
    what: str
    from_point: str
    to_point: str
    laid: int
    measured_mm: float
    reference_mm: float
    error_mm: float


class CheckParams(BaseModel):
    """What may be chosen for the check of an instrument."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    repeats: int = Field(5, ge=2, le=100, title="Repeats", description="number of measurements of each point")
    bar_mm: float = Field(
        0.0,
        ge=0.0,
        le=5000.0,
        title="Scale bar, mm",
        description="calibrated length of the scale bar, mm; 0: no bar",
    )
    bar_ends: list[str] = Field(
        ["bar1", "bar2"],
        min_length=2,
        max_length=2,
        title="Nests of the bar",
        description="names of the bar's two nests in the instrument's program",
    )
    bar_places: int = Field(
        3,
        ge=1,
        le=50,
        title="Positions of the bar",
        description="number of positions at which the bar is measured",
    )
    settle_s: float = Field(
        0.5, ge=0.0, le=60.0, title="Settling, s", description="wait at standstill before a measurement, s"
    )
    dwell_s: float = Field(
        4.0, ge=0.1, le=120.0, title="Averaging, s", description="time that the instrument averages over, s"
    )


@dataclass(frozen=True)
class CheckPlan:
    """What is checked.

    Attributes:
        bench: what it was made from.
        params: as chosen.
    """

    bench: SerialBench
    params: CheckParams


class InstrumentCheck(Procedure):
    """Measures nests again and again and in both faces, a scale bar, and the nests of the tool; the arm stands."""

    name = "instrument-check"
    title = "Check of a laser tracker"
    explanation = INSTRUMENT_CHECK
    needs = Needs(SerialBench, TRACKER, tracker=("points",), equipment=(NESTS,))
    stage = CHECKING
    records = (MeasuredNest, CheckedLength)
    event_texts = CHECK_TEXTS
    questions = (BAR,)
    params_type = CheckParams

    def plan(self, bench: SerialBench, params: CheckParams) -> CheckPlan:
        """Plan the check.

        Raises:
            PlanError: there is nothing to measure.
        """
        if not bench.instrument.nests and not params.bar_mm and len(bench.targets) < 2:
            raise PlanError(
                "there is nothing to check the instrument with: add [[tracker.nest]], state bar_mm "
                "of a scale bar, or "
                "two targets of the tool"
            )
        return CheckPlan(bench, params)

    async def run(self, ctx: Context, plan: CheckPlan) -> None:
        """Measure; the arm does not move."""
        check = _Check(ctx, plan)
        for nest in plan.bench.instrument.nests:
            await ctx.step(
                f"{NEST}{nest.name}", f"nest {nest.name}", partial(check.nest, nest.name, nest.place_mm)
            )
        for place in range(1, plan.params.bar_places + 1 if plan.params.bar_mm else 1):
            await ctx.step(f"bar/{place - 1}", f"scale bar, place {place}", partial(check.bar, place))
        if len(plan.bench.targets) > 1:
            await ctx.step("tool", "distances on the tool", check.tool)


class _Check:
    def __init__(self, ctx: Context, plan: CheckPlan) -> None:
        self._ctx = ctx
        self._plan = plan

    async def nest(self, name: str, near: Place) -> Row:
        """Measure a nest again and again, and in both faces where the instrument has them."""
        faces = _FACES if self._plan.bench.instrument.abilities.two_faces else _FACES[:1]
        places: dict[Face, np.ndarray] = {}
        for face in faces:
            found = await self._repeated(name, near, face)
            if found is None:
                return {"hidden": True}
            places[face] = found
            for number, place in enumerate(found.tolist()):
                values = coordinates((place[0], place[1], place[2]), None)
                self._ctx.record(
                    MeasuredNest(
                        nest=name,
                        nests_round=number,
                        face=face,
                        **values,  # type: ignore[arg-type]  # the keys are those of coordinates
                    )
                )
        spread = float(np.sqrt(np.mean([places[face].var(axis=0, ddof=1).sum() for face in faces])))
        apart = (
            float(np.linalg.norm(places[2].mean(axis=0) - places[1].mean(axis=0))) if len(faces) > 1 else None
        )
        row: Row = {"hidden": False, "nest": name, "repeatability_mm": spread, "two_face_mm": apart}
        await self._ctx.event("nest-checked", **row)
        return row

    async def bar(self, place: int) -> Row:
        """Have the scale bar laid, then measure both ends."""
        params = self._plan.params
        laid = _laid(self._plan.bench.instrument, place)
        answer = await self._ctx.ask(_bar_prompt(place, params, laid))
        if answer != "laid":
            return {"hidden": True}
        near = _bar_ends(self._plan.bench.instrument, laid, params.bar_mm)
        ends = [await self._repeated(name, end, 1) for name, end in zip(params.bar_ends, near, strict=True)]
        if ends[0] is None or ends[1] is None:
            return {"hidden": True}
        one, other = params.bar_ends
        length_mm = float(np.linalg.norm(ends[1].mean(axis=0) - ends[0].mean(axis=0)))
        return await self._kept("scale bar", one, other, place, length_mm, params.bar_mm)

    async def tool(self) -> Row:
        """Measure the tool's nests where the arm stands, and compare their distances with its description."""
        bench = self._plan.bench
        here = await self._ctx.joints()
        found: dict[str, np.ndarray] = {}
        for target in bench.targets:
            places = await self._repeated(
                target.name, near_mm(bench, bench.instrument.base, here, target.name), 1
            )
            if places is not None:
                found[target.name] = places.mean(axis=0)
        for one, other in combinations(found, 2):
            stated = np.subtract(bench.target(other).place_mm, bench.target(one).place_mm)
            length_mm = float(np.linalg.norm(found[other] - found[one]))
            await self._kept("tool", one, other, 0, length_mm, float(np.linalg.norm(stated)))
        if len(found) < 2:
            seen = "".join(f"only {name}" for name in found) or "none"
            await self._ctx.warn(
                f"no distance on the tool is checked, because {seen} of its targets is visible: jog the arm "
                "to where several face the instrument, and check again"
            )
        return {"hidden": len(found) < 2, "seen": list(found)}

    async def _kept(
        self, what: str, one: str, other: str, place: int, length_mm: float, known_mm: float
    ) -> Row:
        length = CheckedLength(
            what=what,
            from_point=one,
            to_point=other,
            laid=place,
            measured_mm=length_mm,
            reference_mm=known_mm,
            error_mm=length_mm - known_mm,
        )
        self._ctx.record(length)
        row: Row = {"hidden": False, "what": f"{what} {one}–{other}", "error_mm": length.error_mm}
        await self._ctx.event("length-checked", **row)
        return row

    async def _repeated(self, name: str, near: Place | None, face: Face) -> np.ndarray | None:
        """Return the places of repeats, shape (repeats, 3); None where the point is hidden."""
        params = self._plan.params
        try:
            found = [
                await self._ctx.measure_target(name, params.settle_s, params.dwell_s, near, face)
                for _ in range(params.repeats)
            ]
        except HiddenTargetError as error:
            await self._ctx.warn(f"{name} is hidden, so it is left out of the check: {error}")
            return None
        return np.array([one.place_mm for one in found])


def _laid(instrument: Instrument, place: int) -> SetUpScaleBar:
    """Return where the bar is laid: half-way to the instrument, across the line of sight or aslant of it."""
    x_mm, y_mm, _ = instrument.station_mm.tolist()
    middle = (0.5 * x_mm, 0.5 * y_mm, _LOWEST_MM + _HIGHER_MM * ((place - 1) // len(_TURNS_DEG)))
    turn_deg = math.degrees(math.atan2(y_mm, x_mm)) + _TURNS_DEG[(place - 1) % len(_TURNS_DEG)]
    return SetUpScaleBar(place_mm=middle, turn_deg=turn_deg)


def _bar_ends(instrument: Instrument, laid: SetUpScaleBar, bar_mm: float) -> list[Place]:
    """Return roughly where the ends of the bar are, in the instrument's frame."""
    turn = math.radians(laid.turn_deg)
    along = 0.5 * bar_mm * np.array([math.cos(turn), math.sin(turn), 0.0])
    ends = [np.append(np.array(laid.place_mm) + sense * along, 1.0) for sense in (-1.0, 1.0)]
    found = [(instrument.base @ end)[:3].tolist() for end in ends]
    return [(x, y, z) for x, y, z in found]


def _bar_prompt(place: int, params: CheckParams, laid: SetUpScaleBar) -> Prompt:
    x_mm, y_mm, z_mm = laid.place_mm
    return BAR.prompt(
        f"bar/{place}",
        f"Place the scale bar of {params.bar_mm:.10g} mm at its place {place} of {params.bar_places}: level, its "
        f"middle about at {x_mm:.0f}, {y_mm:.0f}, {z_mm:.0f} mm from the arm's base, from {params.bar_ends[0]} to "
        f"{params.bar_ends[1]} turned by {laid.turn_deg:.0f}° about z, both nests in sight. Answer when it is in "
        "place (laid), or leave it out (skip).",
        task=laid,
    )
