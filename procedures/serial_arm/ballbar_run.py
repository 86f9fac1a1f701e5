"""Leading nests over a sphere with a ballbar: mounted, read at each place, taken off."""

import math
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, Final

import numpy as np

from catseye.procedures.kit.asked_file import asked_file
from catseye.procedures.kit.columns import ColumnRule, Columns, TableRule
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import OutOfReachError, TableFileError
from catseye.procedures.kit.motion.bench_time import BenchTime
from catseye.procedures.kit.records import Json, Record, Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.kit.tasks import ExportBallbar, MountBallbar, ReadBallbar, TakeBallbarOff, Task
from catseye.procedures.serial_arm.ballbar_plan import BallbarPlan, BarPath
from catseye.procedures.serial_arm.length_scatter import scatter_of
from catseye.procedures.serial_arm.plateaus import plateaus
from catseye.procedures.serial_arm.questions import BALLBAR_MOUNTED, LENGTHS_FILE, READING

LENGTHS: Final = TableRule(
    "lengths",
    "a time and the bar's deviation then",
    (
        (
            ColumnRule("t_s", unit="s"),
            ColumnRule("deviation_mm", unit="mm", largest=10.0, hint="state it in mm"),
        ),
    ),
    source="the export of the ballbar's program, as t_s,deviation_mm",
)

_MOST_TYPED: Final = 3
_RATE_HZ: Final = 10.0

_PLATEAU: Final = 0.65
"""Of the dwell: a plateau lasts so long at least; the arm stops for a shorter time where it only passes.

Slow recordings lose up to two intervals at the ends: of 2 s at 4 Hz 1.5 s may be all that is seen to stand still.
"""


@dataclass(frozen=True, kw_only=True)
class BallbarReading(Record):
    """A length of the bar. `extra` has the commanded joints `q`.

    Attributes:
        nest: of the tool, to which the bar reaches.
        pose: name of the place on the path.
        number: of the place among those of the path that are read, from 1.
        predicted_mm: deviation from the nominal length that the calibration predicts.
        deviation_mm: that was read.
        length_mm: of the bar: nominal length and deviation.
        error_mm: length less what the commands mean, which is the nominal length.
    """

    table: ClassVar[str] = "ballbar"
    is_point: ClassVar[bool] = True
    point_name: ClassVar[str] = "length"
    target_column: ClassVar[str] = "nest"
    nest: str
    pose: str
    number: int
    predicted_mm: float
    deviation_mm: float
    length_mm: float
    error_mm: float


class BallbarRun:
    """Carries the paths out.

    Args:
        ctx: the bench.
        plan: the paths.
    """

    def __init__(self, ctx: Context, plan: BallbarPlan) -> None:
        self._ctx = ctx
        self._plan = plan
        self._at = -1
        self._mountings = 0
        self._time = BenchTime(ctx, sum(map(plan.path_s, plan.paths)))

    async def run(self) -> None:
        """Lead every nest over its path.

        Raises:
            OutOfReachError: the operator ends the run, or readings are beyond the bar's range.
            TableFileError: no file of lengths could be used.
        """
        for path in self._plan.paths:
            self._at = -1
            rows = []
            for count, number in enumerate(path.measured, 1):
                title = f"{path.nest}, place {count} of {len(path.measured)}"
                step_id = f"bar/{path.nest}/{count - 1:04d}"
                rows.append(await self._ctx.step(step_id, title, partial(self._read, path, count, number)))
                self._time.passed(self._plan.path_s(path) / len(path.measured), 0.0, title)
            await self._ctx.step(f"off/{path.nest}", f"{path.nest}: bar off", partial(self._off, path))
            if self._plan.readings == "file":
                read = await self._ctx.step(
                    f"file/{path.nest}", f"{path.nest}: lengths", partial(self._file, path)
                )
                deviations = [float(str(value)) for value in _listed(read["deviation_mm"])]
            else:
                deviations = [number_of(row, "deviation_mm") for row in rows]
            await self._summary(path, deviations)

    async def _read(self, path: BarPath, count: int, number: int) -> Row:
        """Go on to a place and read the bar."""
        self._time.begin()
        if self._at < 0:
            await self._enter(path, number)
        for pose in path.commands[self._at + 1 : number + 1]:
            await self._ctx.move(pose)
        self._at = number
        await self._ctx.pause(self._plan.dwell_s)
        if self._plan.readings == "file":
            return {"deviation_mm": None}
        deviation_mm = await self._typed(path, count, number)
        self._ctx.record(self._reading(path, count, number, deviation_mm))
        return {"deviation_mm": deviation_mm}

    async def _enter(self, path: BarPath, number: int) -> None:
        """Lead the nest to where the path goes on, without the bar, and have the bar mounted there."""
        self._mountings += 1
        where = f"{path.nest}/{self._mountings}"
        if self._ctx.resumed or self._mountings > 1:
            await self._confirmed(
                f"bare/{where}",
                f"Take the ballbar off {path.nest}: the arm moves without it.",
                path,
                TakeBallbarOff(),
            )
        await self._ctx.move(self._plan.rest)
        for pose in path.commands[: number + 1]:
            await self._ctx.move(pose)
        self._at = number
        await self._confirmed(
            f"mount/{where}",
            f"Mount the ballbar between the cup and {path.nest}: by the calibration it reads "
            f"{path.deviation_mm[number]:+z.2f} mm here, and no more than "
            f"±{_rounded_up(path.largest_mm):.2f} mm while the arm leads it over the sphere.",
            path,
            MountBallbar(target=path.nest, centre_mm=self._plan.ballbar.centre_mm),
        )

    async def _confirmed(self, prompt_id: str, text: str, path: BarPath, task: Task) -> None:
        prompt = BALLBAR_MOUNTED.prompt(
            prompt_id,
            f"{text} Done (done), or end the run (stop)?",
            task=task,
            target=path.commands[max(self._at, 0)],
        )
        if await self._ctx.ask(prompt) != "done":
            raise OutOfReachError(
                "the operator ended the run at the ballbar; what is stored stays; take the bar off, then continue "
                "with catseye resume"
            )

    async def _off(self, path: BarPath) -> Row:
        """Have the bar taken off before the arm leaves the sphere."""
        self._mountings += 1
        text = f"Take the ballbar off {path.nest}: the arm drives away."
        await self._confirmed(f"off/{path.nest}/{self._mountings}", text, path, TakeBallbarOff())
        await self._ctx.move(self._plan.rest)
        return {}

    async def _typed(self, path: BarPath, count: int, number: int) -> float:
        """Have the deviation typed; one that no bar can have is asked for again."""
        complaint = ""
        for attempt in range(1, _MOST_TYPED + 1):
            read = await self._ctx.ask(self._reading_prompt(path, count, number, attempt, complaint))
            if abs(float(read)) <= self._plan.ballbar.range_mm:
                return float(read)
            complaint = f"{read} mm is beyond the bar's range of ±{self._plan.ballbar.range_mm:g} mm. "
        raise OutOfReachError(
            f"{path.nest}, place {count}: {complaint}Take the bar off, see whether the deviation in mm is stated and "
            "whether the cup sits where centre_mm says, then continue with catseye resume"
        )

    def _reading_prompt(self, path: BarPath, count: int, number: int, attempt: int, complaint: str) -> Prompt:
        name = f"reading/{path.nest}/{count:04d}"
        return READING.prompt(
            name if attempt == 1 else f"{name}/{attempt}",
            f"{complaint}What does the ballbar read at place {count} of {len(path.measured)} of {path.nest}, as "
            f"deviation from {self._plan.ballbar.length_mm:g} mm?",
            task=ReadBallbar(),
            target=path.commands[min(number + 1, len(path.commands) - 1)],
        )

    def _reading(self, path: BarPath, count: int, number: int, deviation_mm: float) -> BallbarReading:
        ballbar = self._plan.ballbar
        extra: dict[str, Json] = {"q": list(path.commands[number])}
        return BallbarReading(
            nest=path.nest,
            pose=f"{path.nest}-{count:04d}",
            number=count,
            predicted_mm=path.deviation_mm[number],
            deviation_mm=deviation_mm,
            length_mm=ballbar.length_mm + deviation_mm,
            error_mm=deviation_mm,
            extra=extra,
        )

    async def _file(self, path: BarPath) -> Row:
        """Ask for the file of lengths until its plateaus are those of the path."""
        prompt = LENGTHS_FILE.prompt(
            f"lengths/{path.nest}",
            f"Type the path of the ballbar's CSV of {path.nest}, with the columns t_s,deviation_mm.",
            task=ExportBallbar(),
        )
        found_in = partial(self._plateaus, path)
        file, found = await asked_file(self._ctx, prompt, LENGTHS, self._rehearsed(path), found_in)
        for count, (number, deviation_mm) in enumerate(zip(path.measured, found, strict=True), 1):
            self._ctx.record(self._reading(path, count, number, deviation_mm))
        return {"file": file, "deviation_mm": list(found)}

    def _plateaus(self, path: BarPath, file: str, table: Columns) -> list[float]:
        found = plateaus(
            table["t_s"], table["deviation_mm"], _PLATEAU * self._plan.dwell_s, places=len(path.measured)
        )
        if len(found) != len(path.measured):
            raise TableFileError(
                f"{file}: it shows {len(found)} plateaus of at least {_PLATEAU * self._plan.dwell_s:g} s, "
                "and the path of "
                f"{path.nest} has {len(path.measured)} places: give the whole recording of this path alone"
            )
        return found

    def _rehearsed(self, path: BarPath) -> Columns:
        """Return what an ideal bar records."""
        ideal = [path.deviation_mm[number] for number in path.measured]
        each = int(_RATE_HZ * self._plan.dwell_s) + 1
        # Between two places it moves.
        levels = np.concatenate([np.append(np.full(each, value), np.nan) for value in ideal])
        moving = np.isnan(levels)
        levels[moving] = np.where(np.arange(moving.sum()) % 2, 5.0, -5.0)
        return Columns(
            {"t_s": np.arange(len(levels)) / _RATE_HZ, "deviation_mm": levels}, np.arange(len(levels)) + 2
        )

    async def _summary(self, path: BarPath, deviations: list[float]) -> None:
        errors = np.array(deviations)
        await self._ctx.event(
            "ballbar",
            nest=path.nest,
            places=len(errors),
            mean_mm=float(errors.mean()),
            std_mm=scatter_of(errors),
            max_mm=float(np.abs(errors).max()),
        )


def _rounded_up(value_mm: float) -> float:
    """Return a bound in hundredths of a millimetre that holds: 0.00 would promise what no bar does."""
    return max(1, math.ceil(100.0 * value_mm)) / 100.0


def _listed(value: object) -> list[object]:
    return value if isinstance(value, list) else []
