"""A rehearsal of the rest of a run measures nothing, and says nothing against what the run has measured."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from catseye.app.cell.bench import system_of
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.open_loop.open_loop import OpenLoop
from catseye.procedures.scara.open_loop.open_loop_plan import plan_open_loop
from catseye.procedures.scara.path.path_plan import plan_path
from catseye.procedures.scara.path.validation_path import ValidationPath
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.unit.procedures.benches import IdealContext, bench
from tests.unit.procedures.serial_arm.benches import SIX, Room, carried_out

REAL_MM = 0.3
"""By which the distances of a real arm miss the plan's."""


async def rehearsed(procedure: Any, plan: Any, done: Mapping[str, Row]) -> DryRunContext:
    """Rehearse what is left of a plan."""
    system = system_of(plan.bench)
    dry = DryRunContext(system, system.rest, declared=procedure.records, done=done)
    await procedure.run(dry, plan)
    return dry


def first_half(stored: Mapping[str, Row]) -> dict[str, Row]:
    return dict(list(stored.items())[: len(stored) // 2])


def warnings_of(dry: DryRunContext) -> list[str]:
    return [str(data["text"]) for kind, data in dry.notes if kind == "warning"]


async def test_distances_of_a_real_arm_raise_no_alarm() -> None:
    nodes = (-80.0, -40.0, 0.0), (20.0, 60.0, 100.0)
    plan = plan_open_loop(bench(*nodes), reflectors=("P1", "P2"), closures=2)
    context = IdealContext()
    await OpenLoop().run(context, plan)
    done = first_half(context.stored)
    for number, (step, row) in enumerate(done.items()):
        if isinstance(value := row.get("displacement_mm"), float):
            done[step] = {**row, "displacement_mm": value + REAL_MM * math.sin(1.7 * number)}
    dry = await rehearsed(OpenLoop(), plan, done)
    assert dry.steps
    assert warnings_of(dry) == []


async def test_a_tracker_with_a_frame_of_its_own_passes() -> None:
    plan = plan_path(bench(), y_from_mm=-20.0, y_to_mm=20.0, step_mm=20.0)
    context = IdealContext()
    await ValidationPath().run(context, plan)
    done = first_half(context.stored)
    for step, row in done.items():
        if isinstance(x_mm := row.get("x_meas_mm"), float):
            done[step] = {**row, "x_meas_mm": x_mm + 1500.0}
    dry = await rehearsed(ValidationPath(), plan, done)
    assert dry.steps
    assert [prompt.text for prompt in dry.prompts if prompt.id.startswith("target/")] == []


async def test_nests_beside_their_stated_places_raise_no_alarm(tmp_path: Path) -> None:
    plan = TrackerValidation().plan(SIX, ValidationParams(count=6, nests_every=3, settle_s=0.2))
    outcome = await carried_out(Room(tmp_path), TrackerValidation(), plan)
    done = first_half({step.step_id: step.result for step in RunReader(outcome.path).steps()})
    stored: Any = done["nests/00"]["places"]
    found: Any = {name: [x_mm + 5.0, *rest] for name, (x_mm, *rest) in stored.items()}
    dry = await rehearsed(
        TrackerValidation(), plan, {**done, "nests/00": {**done["nests/00"], "places": found}}
    )
    assert dry.steps
    assert warnings_of(dry) == []
