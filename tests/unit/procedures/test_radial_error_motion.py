"""The guided measurement of radial error motions: arcs, order of readings, centring, slips of the pen."""

import asyncio
import cmath
import math
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_typed_table
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import AlignmentError, OutOfReachError, PlanError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.motion.clear_way import way_refusal
from catseye.procedures.kit.stored import integer
from catseye.procedures.kit.tasks import MountArtefact, ReadIndicator, TapArtefact
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.radial.radial_error_motion import RadialErrorMotion, RadialParams
from catseye.procedures.scara.radial.radial_plan import RadialPlan
from catseye.procedures.scara.radial.recorded import READINGS
from catseye.procedures.scara.records import RunOutReading
from tests.unit.procedures.benches import IdealContext, bench

ACROSS = {"x": 0.0, "y": math.pi / 2.0}


@dataclass
class GaugedContext(IdealContext):
    """A bench on whose axes a ball stands, off by some 70 µm until it is tapped; the axis moves by 2 µm in order 3.

    Attributes:
        slips: what somebody types instead of what is right, once each.
        yields: what of a tap the ball follows.
        refuses: the question at which the operator ends the run.
    """

    slips: dict[str, str] = field(default_factory=dict)
    yields: float = 1.0
    refuses: str = ""
    joint: int = 0
    side: float = 1.0
    off_um: complex = 0j

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Do what is asked for, and answer."""
        del watch
        self.prompts.append(prompt)
        if prompt.id == self.refuses:
            return "no" if prompt.kind == "confirm" else "stop"
        turn = cmath.exp(1j * math.radians((await self.joints())[self.joint]))
        match prompt.task:
            case MountArtefact():
                self.joint, self.side = prompt.task.joint - 1, -1.0 if prompt.task.turned else 1.0
                self.off_um = complex(-30.0, 60.0)
                turn = cmath.exp(1j * math.radians((await self.joints())[self.joint]))
            case TapArtefact():
                self.off_um += self.yields * self.side * prompt.task.by_um / turn
                return "yes"
            case ReadIndicator():
                if (given := self.slips.pop(prompt.id, None)) is not None:
                    return given
                place = self.off_um * turn + 2.0 * turn**3
                return f"{self.side * (place * cmath.exp(-1j * ACROSS[prompt.task.direction])).real:.6f}"
        return "done"


def planned(base: ScaraBench | None = None, **params: object) -> RadialPlan:
    given = {"joints": ["J1"], "cycles": 2, "resolution_um": 0.0, **params}
    return RadialErrorMotion().plan(base or bench(), RadialParams.model_validate(given))


def run(plan: RadialPlan, ctx: GaugedContext | None = None) -> GaugedContext:
    ctx = ctx or GaugedContext()
    asyncio.run(RadialErrorMotion().run(ctx, plan))
    return ctx


def result(ctx: GaugedContext, joint: str = "J1") -> dict[str, Any]:
    return dict(ctx.stored[f"{joint}/result"])


def test_arcs_are_clear_and_leave_room_for_the_take_up() -> None:
    base = bench()
    plan = planned(joints=["J1", "J2"])
    for reading, (low, high) in zip(
        plan.readings[::2], (base.j1_limits_deg, base.j2_limits_deg), strict=True
    ):
        sweep = reading.sweep
        assert way_refusal(sweep.way, base) is None
        assert sweep.values_deg[0] - base.take_up_deg >= low
        assert sweep.values_deg[-1] + base.take_up_deg <= high
        assert {round(b - a, 6) for a, b in pairwise(sweep.values_deg)} == {20.0}


def test_a_joint_turns_alone_with_the_arm_folded() -> None:
    (reading, _) = planned().readings
    ways = {(pose[1], pose[2], pose[3]) for pose in reading.sweep.way}
    assert len(ways) == 1
    assert abs(reading.sweep.standing[1]) == max(map(abs, bench().nodes2_deg))


@pytest.mark.parametrize(
    ("params", "text"),
    [
        ({"joints": ["J1", "J1"]}, "named twice"),
        ({"j1_deg": [10.0]}, "state both"),
        ({"j1_deg": [-400.0 + 50.0, 0.0]}, "make the arc smaller"),
        ({"j1_deg": [-20.0, 20.0]}, "cannot turn through 120°"),
    ],
)
def test_an_arc_that_cannot_be_is_refused(params: dict[str, Any], text: str) -> None:
    with pytest.raises(PlanError, match=text):
        planned(**params)


def test_the_artefact_is_centred_and_the_motion_found() -> None:
    ctx = run(planned(joints=["J1", "J2"]))
    for joint in ("J1", "J2"):
        found = result(ctx, joint)
        assert found["rms_um"] == pytest.approx(2.0 / math.sqrt(2.0), rel=0.2)
        assert found["eccentricity_um"][0] < 20.0
    taps = [prompt for prompt in ctx.prompts if isinstance(prompt.task, TapArtefact)]
    assert len(taps) == 2


def test_each_place_is_come_to_from_its_own_side() -> None:
    ctx = run(planned(indicators=2))
    rows = [row for table, row in ctx.rows if table == RunOutReading.table]
    assert len(rows) == 2 * 2 * 2 * len(planned().readings[0].sweep.values_deg)
    moves = [pose[0] for pose in ctx.moves]
    for row in rows:
        places = [number for number, value in enumerate(moves) if value == pytest.approx(row["angle_deg"])]
        steps = [moves[number] - moves[number - 1] for number in places if number]
        assert any(integer(row["approach"]) * step > 0.0 for step in steps)


def test_reversal_reads_every_place_from_the_other_side_too() -> None:
    ctx = run(planned(reversal=True))
    found = result(ctx)
    assert found["form_um"] == pytest.approx(0.0, abs=1e-3)
    mounts = [prompt.task for prompt in ctx.prompts if isinstance(prompt.task, MountArtefact)]
    assert [mount.turned for mount in mounts] == [False, True]


def test_a_slip_of_the_pen_is_asked_for_again() -> None:
    name = "J1/direct/x/2/upwards/005/x"
    clean, ctx = run(planned()), run(planned(), GaugedContext(slips={name: "700"}))
    again = [prompt for prompt in ctx.prompts if prompt.id == f"{name}/again"]
    assert len(again) == 1
    assert "read again" in again[0].text
    assert result(ctx)["rms_um"] == pytest.approx(result(clean)["rms_um"])


def test_an_artefact_that_does_not_yield_ends_the_run() -> None:
    with pytest.raises(AlignmentError, match="67 µm off the axis after 8 rounds"):
        run(planned(), GaugedContext(yields=0.0))


@pytest.mark.parametrize(
    ("question", "error"),
    [
        ("J1/direct/mount", OutOfReachError),
        ("J1/direct/tap/1", AlignmentError),
        ("J1/direct/y", OutOfReachError),
    ],
)
def test_who_refuses_ends_the_run_and_is_reminded(question: str, error: type[Exception]) -> None:
    ctx, procedure = GaugedContext(refuses=question), RadialErrorMotion()
    with pytest.raises(error):
        asyncio.run(procedure.run(ctx, planned()))
    asyncio.run(procedure.teardown(ctx))
    mounted = question != "J1/direct/mount"
    assert any("still mounted" in text for text in ctx.warnings) is mounted


def test_a_short_arc_is_warned_of() -> None:
    ctx = run(planned(j1_deg=[-60.0, 60.0], step_deg=15.0))
    assert any("over 120° only" in text for text in ctx.warnings)
    assert replace(planned().readings[0].sweep, values_deg=(0.0, 90.0)).arc_deg == 90.0


def test_questions_say_where_the_joint_goes_next() -> None:
    plan = planned()
    sweep = plan.readings[0].sweep
    targets = {prompt.id: prompt.target for prompt in run(plan).prompts}
    assert targets["J1/direct/x/1/upwards/001/x"] == sweep.pose(sweep.values_deg[1])
    last = f"J1/direct/x/1/upwards/{len(sweep.values_deg):03d}/x"
    assert targets[last] == sweep.before(sweep.values_deg[-1], -1)
    assert targets["J1/direct/x/1/downwards/001/x"] == sweep.pose(sweep.values_deg[-2])


@dataclass
class RecordedContext(GaugedContext):
    """The indicator's program writes a file a cycle: what a reader of the ball would have typed at each place.

    Attributes:
        spoil: makes of the columns of the first file what is wrong with it.
        stood: joint angles at which the arm stood still in this cycle.
    """

    spoil: Callable[[Columns], Columns] | None = None
    in_mm: bool = False
    stood: list[float] = field(default_factory=list)

    async def pause(self, duration_s: float) -> None:
        """Note where the joint stands while the program records."""
        await super().pause(duration_s)
        self.stood.append((await self.joints())[self.joint])

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Begin a recording, or hand it over."""
        if prompt.id.endswith("/begin"):
            self.stood.clear()
        if prompt.kind == "text":
            self.prompts.append(prompt)
            direction = prompt.id.split("/file/")[1][0]
            self.files[prompt.id] = self._recorded(direction)
            return prompt.id
        return await super().ask(prompt, watch)

    def _recorded(self, direction: str) -> Columns:
        turns = [cmath.exp(1j * math.radians(angle)) for angle in self.stood]
        across = cmath.exp(-1j * ACROSS[direction])
        read = [self.side * ((self.off_um * t + 2.0 * t**3) * across).real for t in turns]
        name, factor = ("reading_mm", 1e-3) if self.in_mm else ("reading_um", 1.0)
        values = {"angle_deg": np.array(self.stood), name: factor * np.array(read)}
        table = Columns(values, np.arange(len(read)) + 2)
        spoil, self.spoil = self.spoil, None
        return table if spoil is None else spoil(table)


@pytest.mark.parametrize("in_mm", [False, True])
@pytest.mark.parametrize("indicators", [1, 2])
def test_recorded_readings_give_what_typed_ones_give(indicators: int, *, in_mm: bool) -> None:
    typed = result(run(planned(indicators=indicators)))
    ctx = run(planned(indicators=indicators, readings="file"), RecordedContext(in_mm=in_mm))
    found = result(ctx)
    for name in ("rms_um", "eccentricity_um"):
        assert found[name] == pytest.approx(typed[name], abs=1e-4)
    rows = [row for table, row in ctx.rows if table == RunOutReading.table]
    assert len(rows) == 2 * 2 * 2 * len(planned().readings[0].sweep.values_deg)
    # Centring is typed; of the cycles no single reading is.
    assert not [p for p in ctx.prompts if isinstance(p.task, ReadIndicator) and "/centre/" not in p.id]


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (lambda table: table.first(len(table) - 1), "stood still"),
        (
            lambda table: replace(
                table, values={**table.values, "angle_deg": table["angle_deg"][::-1] + 20.0}
            ),
            "is due: give the readings in the order",
        ),
        (lambda _table: "line 3: 'abc' is no number", "is no number"),
    ],
)
def test_an_unusable_file_is_refused_and_asked_for_again(
    spoil: Callable[[Columns], Columns], text: str
) -> None:
    ctx = run(planned(readings="file"), RecordedContext(spoil=spoil))
    assert any(text in warning for warning in ctx.warnings)
    again = [prompt for prompt in ctx.prompts if prompt.id == "J1/direct/x/1/file/x/2"]
    assert len(again) == 1
    assert text in again[0].text
    assert result(ctx)["rms_um"] == pytest.approx(2.0 / math.sqrt(2.0), rel=0.2)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("angle_deg,reading\n0,1\n", "reading_um"),
        ("angle_deg,reading_um,reading_mm\n0,1,1\n", "keep one of"),
        ("angle_deg,reading_mm\n0,12\n", "call the column reading_um"),
        ("angle_deg,reading_um\n0,x\n", ":2: reading_um"),
        ("", "empty"),
    ],
)
def test_a_table_without_a_named_unit_is_refused(tmp_path: Path, text: str, fault: str) -> None:
    file = tmp_path / "readings.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(UsageError, match=fault):
        read_typed_table(str(file), READINGS)
