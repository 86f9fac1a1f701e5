"""Turning a joint by itself and having an artefact on its axis read, place by place."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import OutOfReachError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.records import Json, Row, row_of
from catseye.procedures.kit.stored import integer, number_of, rows_of
from catseye.procedures.kit.tasks import MountArtefact, ReadIndicator, TakeIndicatorOff, Task
from catseye.procedures.scara.motion.arrival import Arrival
from catseye.procedures.scara.questions import ARTEFACT, CENTRE, INDICATOR, INDICATOR_FILE
from catseye.procedures.scara.radial.centring import Centring
from catseye.procedures.scara.radial.radial_plan import NUMBERS, Direction, RadialPlan, Reading, Sweep
from catseye.procedures.scara.radial.recorded import recorded_um
from catseye.procedures.scara.records import RunOutReading

_SURPRISING_UM: Final = 10.0
"""Further from the cycle before, a reading is asked for again: it may be a slip of the pen."""

_CARRIES: Final = {"J1": "the base", "J2": "link 1"}
_TURNS: Final = {"J1": "link 1", "J2": "link 2"}


class RadialRun:
    """Carries the readings out.

    Attributes:
        mounted: artefact and indicator are on an axis.
    """

    def __init__(self, ctx: Context, plan: RadialPlan) -> None:
        self._ctx, self._plan = ctx, plan
        self._arrival = Arrival(ctx, plan.bench)
        self._time = BenchTime(ctx, plan.duration_s)
        self._at: tuple[Sweep, int, float] | None = None
        self._zero, self._new_zero, self._fresh = 0, True, False
        self._before: dict[tuple[int, float, Direction], float] = {}
        self._shift_um: dict[Direction, float] = {}
        self.mounted = False

    async def read(self, reading: Reading) -> list[Row]:
        """Mount, centre and read; return what `RunOutReading` stores.

        Raises:
            AlignmentError: the artefact could not be centred.
            OutOfReachError: the operator ends the run.
        """
        self._before.clear()
        await self._set_up(reading)
        self._time.begin()
        rows: list[Row] = []
        for cycle in range(1, self._plan.cycles + 1):
            self._new_zero = True
            self._shift_um.clear()
            places = [
                _Place(cycle, approach, number, angle_deg)
                for approach in (1, -1)
                for number, angle_deg in enumerate(reading.sweep.order(approach), 1)
            ]
            if self._plan.recorded_s is None:
                for place in places:
                    rows += await self._place(reading, place)
            else:
                rows += await self._recorded(reading, places)
            text = f"{reading.sweep.joint}, cycle {cycle} of {self._plan.cycles}"
            self._time.passed(self._plan.cycle_s(reading), 0.0, text)
        return rows

    async def take_off(self, sweep: Sweep) -> None:
        """Have artefact and indicators taken away from a joint before anything else turns."""
        text = f"Take artefact and indicator off {sweep.joint}; other joints may move next."
        prompt = _question(f"{sweep.joint}/off", text, TakeIndicatorOff(), None)
        await self._ctx.step(
            f"{sweep.joint}/off", f"{sweep.joint}: artefact off", partial(self._asked, prompt)
        )
        self.mounted = False

    async def _set_up(self, reading: Reading) -> None:
        name, sweep, ctx = reading.mounting, reading.sweep, self._ctx
        self._new_zero = True
        if not reading.mounted:
            text = (
                f"Move the indicator to {_side(reading, 'y')} and set it to the turning point there, in the middle "
                "of its range."
            )
            prompt = _question(f"{name}/y", text, None, sweep.start)
            await ctx.step(f"{name}/y", f"{sweep.joint}: indicator in y", partial(self._asked, prompt))
            return
        self._arrival = Arrival(ctx, self._plan.bench)
        await ctx.step(f"{name}/mount", f"{sweep.joint}: artefact mounted", partial(self._mount, reading))
        self.mounted = True
        read = partial(self._read_x, reading)
        await Centring(ctx, reading, self._plan.within_um, read, self._go, lambda: self._fresh).centre()

    async def _mount(self, reading: Reading) -> Row:
        sweep, start = reading.sweep, reading.sweep.start
        await self._go(start)
        again = "Turn the artefact by half a turn and fasten it" if reading.turned else "Fasten the artefact"
        sides = " and ".join(_side(reading, direction) for direction in reading.directions)
        text = (
            f"{again} to {_TURNS[sweep.joint]} on the axis of {sweep.joint}, the indicator's stand to "
            f"{_CARRIES[sweep.joint]}; set the tip to {sides} at the turning point, in the middle of the range. "
            f"{sweep.joint} turns from {sweep.values_deg[0]:g}° to {sweep.values_deg[-1]:g}° next: keep stand and "
            "cables out of its way."
        )
        task = MountArtefact(joint=NUMBERS[sweep.joint] + 1, turned=reading.turned)
        return await self._asked(_question(f"{reading.mounting}/mount", text, task, start))

    async def _asked(self, prompt: Prompt) -> Row:
        if await self._ctx.ask(prompt) != "done":
            raise OutOfReachError(
                "the operator ended the run at the artefact; what is stored stays: continue with catseye resume"
            )
        return {}

    async def _recorded(self, reading: Reading, places: "Sequence[_Place]") -> list[Row]:
        """Return what the indicator's own program has read in a cycle, whose places are driven in one step."""
        cycle, sweep = places[0].cycle, reading.sweep
        name = f"{reading.mounting}/{''.join(reading.directions)}/{cycle}/file"
        title = f"{sweep.joint}, cycle {cycle} of {self._plan.cycles}, recorded by the indicator's program"
        row = await self._ctx.step(name, title, partial(self._record_cycle, reading, places, name))
        rows = rows_of(row, "readings")
        self._zero = max(self._zero, *(integer(each["zero"]) for each in rows))
        return rows

    async def _record_cycle(self, reading: Reading, places: "Sequence[_Place]", name: str) -> Row:
        sweep, stands_s = reading.sweep, self._plan.settle_s + (self._plan.recorded_s or 0.0)
        due_deg = [place.angle_deg for place in places]
        step_deg = abs(due_deg[1] - due_deg[0])
        first = sweep.before(places[0].angle_deg, places[0].approach)
        text = (
            f"Start the indicator's program: {sweep.joint} stands still for {stands_s:g} s at each of {len(places)} "
            f"places, from {due_deg[0]:g}° to {max(due_deg):g}° by {step_deg:g}° and back from the other side; one "
            "reading at each is needed."
        )
        await self._asked(_question(f"{name}/begin", text, None, first))
        reported = [await self._stand(sweep, place, stands_s) for place in places]
        self._zero, self._new_zero = self._zero + 1, False
        rows: list[Json] = []
        for direction in reading.directions:
            asked = _file_question(f"{name}/{direction}", sweep, direction, places[0].cycle)
            read_um = await recorded_um(self._ctx, asked, due_deg, step_deg)
            for place, reported_deg, value_um in zip(places, reported, read_um, strict=True):
                record = RunOutReading(
                    joint=sweep.joint,
                    mounting="turned" if reading.turned else "direct",
                    direction=direction,
                    approach=place.approach,
                    cycle=place.cycle,
                    angle_deg=place.angle_deg,
                    reported_deg=reported_deg,
                    zero=self._zero,
                    reading_um=value_um,
                    clock_s=self._ctx.clock_s,
                )
                self._ctx.record(record)
                rows.append(dict(row_of(record)))
        return {"readings": rows}

    async def _stand(self, sweep: Sweep, place: "_Place", stands_s: float) -> float:
        """Stand still at a place; return what the controller reports of the joint, deg."""
        await self._to(sweep, place.angle_deg, place.approach)
        await self._ctx.pause(stands_s)
        return (await self._ctx.joints())[NUMBERS[sweep.joint]]

    async def _place(self, reading: Reading, place: "_Place") -> list[Row]:
        """Return what the indicators read at a place."""
        along = "".join(reading.directions)
        name = f"{reading.mounting}/{along}/{place.cycle}/{place.side}/{place.number:03d}"
        title = f"{reading.sweep.joint} at {place.angle_deg:g}°, {place.side}, cycle {place.cycle}"
        row = await self._ctx.step(name, title, partial(self._read, reading, place, name))
        rows = rows_of(row, "readings")
        self._zero = max(self._zero, *(integer(each["zero"]) for each in rows))
        for each in rows:
            self._remember(place, "x" if each["direction"] == "x" else "y", number_of(each, "reading_um"))
        return rows

    async def _read(self, reading: Reading, place: "_Place", name: str) -> Row:
        sweep = reading.sweep
        await self._to(sweep, place.angle_deg, place.approach)
        await self._ctx.pause(self._plan.settle_s)
        if self._new_zero:
            self._zero, self._new_zero = self._zero + 1, False
        reported = (await self._ctx.joints())[NUMBERS[sweep.joint]]
        where = f"{place.side}, cycle {place.cycle} of {self._plan.cycles}"
        rows: list[Json] = []
        for direction in reading.directions:
            target = sweep.after(place.angle_deg, place.approach)
            prompt = _prompt(f"{name}/{direction}", sweep, direction, place.angle_deg, where, target)
            record = RunOutReading(
                joint=sweep.joint,
                mounting="turned" if reading.turned else "direct",
                direction=direction,
                approach=place.approach,
                cycle=place.cycle,
                angle_deg=place.angle_deg,
                reported_deg=reported,
                zero=self._zero,
                reading_um=await self._typed(prompt, self._expected(place, direction)),
                clock_s=self._ctx.clock_s,
            )
            self._ctx.record(record)
            rows.append(dict(row_of(record)))
        return {"readings": rows}

    async def _read_x(self, reading: Reading, name: str, angle_deg: float) -> float:
        """Return what indicator x reads at an angle that is come to upwards."""
        self._fresh = True
        await self._to(reading.sweep, angle_deg, 1)
        await self._ctx.pause(self._plan.settle_s)
        prompt = _prompt(name, reading.sweep, "x", angle_deg, "to see whether it is centred", None)
        return await self._typed(prompt, None)

    async def _typed(self, prompt: Prompt, expected: float | None) -> float:
        """Have a reading typed; one that is far from what is expected is asked for once more."""
        value = float(await self._ctx.ask(prompt))
        if expected is not None and abs(value - expected) > _SURPRISING_UM:
            complaint = (
                f"{value:g} µm is far from {expected:.0f} µm, the reading here in the last cycle: read again."
            )
            again = replace(prompt, id=f"{prompt.id}/again", text=f"{complaint} {prompt.text}")
            value = float(await self._ctx.ask(again))
        self._ctx.show(Live("indicator", value, "µm"))
        return value

    def _expected(self, place: "_Place", direction: Direction) -> float | None:
        """Return what the last cycle has here, moved by as much as the last place; None without one."""
        before = self._before.get((place.approach, place.angle_deg, direction))
        shift = self._shift_um.get(direction)
        return None if before is None or shift is None else before + shift

    def _remember(self, place: "_Place", direction: Direction, value_um: float) -> None:
        key = (place.approach, place.angle_deg, direction)
        if key in self._before:
            self._shift_um[direction] = value_um - self._before[key]
        self._before[key] = value_um

    async def _to(self, sweep: Sweep, angle_deg: float, approach: int) -> None:
        """Go to an angle from its proper side."""
        at = self._at
        onwards = at is not None and at[:2] == (sweep, approach) and approach * (angle_deg - at[2]) > 0.0
        if not onwards:
            await self._go(sweep.before(angle_deg, approach))
        await self._ctx.move(sweep.pose(angle_deg))
        self._at = (sweep, approach, angle_deg)

    async def _go(self, pose: Pose) -> None:
        """Go to a pose of the sweep; the first time by a free way from wherever the arm stands."""
        await self._arrival.at(pose)
        await self._ctx.move(pose)
        self._at = None


@dataclass(frozen=True)
class _Place:
    """A place of a cycle.

    Attributes:
        cycle: its number, from 1.
        approach: 1 upwards, -1 downwards.
        number: of the place in its order, from 1.
        angle_deg: of the joint.
    """

    cycle: int
    approach: int
    number: int
    angle_deg: float

    @property
    def side(self) -> str:
        """From which side the place is come to, in words."""
        return "upwards" if self.approach > 0 else "downwards"


def _side(reading: Reading, direction: Direction) -> str:
    """Return on which side of the artefact an indicator stands."""
    sign = "−" if reading.turned else "+"
    frame = "" if reading.sweep.joint == "J1" else " of link 1 (x points from J1 to J2)"
    return f"the {sign}{direction} side of the artefact{frame}"


def _prompt(
    name: str, sweep: Sweep, direction: Direction, angle_deg: float, where: str, target: Pose | None
) -> Prompt:
    """Return the question for a reading; what is typed lets the joint go on."""
    question = CENTRE if CENTRE.asks(name) else INDICATOR
    return question.prompt(
        name,
        f"Type what indicator {direction} reads with {sweep.joint} at {angle_deg:g}°, {where}.",
        task=ReadIndicator(direction=direction),
        target=target,
    )


def _file_question(name: str, sweep: Sweep, direction: Direction, cycle: int) -> Prompt:
    """Return the question for the file of a cycle; what is typed lets the joint go on."""
    return INDICATOR_FILE.prompt(
        name,
        f"Type the path of the CSV with the readings of indicator {direction} in cycle {cycle} of {sweep.joint}: "
        "columns angle_deg and reading_um (or reading_mm), one row for each place in the order of driving.",
        target=sweep.start,
    )


def _question(name: str, text: str, task: Task | None, target: Pose | None) -> Prompt:
    """Return a question after whose answer the arm moves."""
    return ARTEFACT.prompt(name, f"{text} Done (done), or end the run (stop)?", task=task, target=target)
