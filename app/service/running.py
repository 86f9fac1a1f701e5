"""A procedure on a cell: planned, then run or rehearsed."""

import asyncio
import getpass
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel

from catseye.app.cell.bench import bench_for, system_of
from catseye.app.cell.hands import hands_endpoint
from catseye.app.cell.load import LoadedCell
from catseye.app.cell.model import Cell
from catseye.app.engine.announcer import Publish
from catseye.app.engine.devices import DeviceBuilder
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.engine.handle import OnOpen
from catseye.app.engine.host import run_procedure
from catseye.app.engine.instruments import device_builder
from catseye.app.engine.operator import Answerer
from catseye.app.engine.request import RunOutcome, RunRequest
from catseye.app.engine.signals import SignalInstaller, loop_signals
from catseye.app.engine.simulated_operator import SimulatedOperator
from catseye.app.engine.walked.register import WALK, walk_fact, walked_legs
from catseye.app.engine.walked.rule import WalkRule
from catseye.app.engine.walked.tube import Leg
from catseye.app.errors import ConfigError
from catseye.app.files.documents import read_toml
from catseye.app.protocol.loss import output_policy
from catseye.app.protocol.procedures import Runnable
from catseye.app.service.plan_digest import plan_digest
from catseye.app.service.walk.fed_robot import fed
from catseye.app.service.walk.walk import Walk
from catseye.app.store.aftermath import find_aftermath
from catseye.app.store.basis import find_basis
from catseye.app.store.reader import RunReader
from catseye.app.store.run_names import JOB
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.motion.clear_way import way_check
from catseye.procedures.kit.motion.steps import line_target
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.system import System


@dataclass(frozen=True)
class PlannedRun:
    """A procedure with everything decided before anything moves.

    Attributes:
        loaded: the cell file.
        procedure: what will be done.
        params: what was chosen.
        bench: nominal arm and aim.
        plan: the procedure's own plan.
        aim: where the aim comes from.
        aim_simulated: whether that was a search on emulated devices; None without a search.
        resume: directory of the interrupted run that goes on; None for a new one.
        clock_speed: of the interrupted run, bench seconds in one real second.
        relinked: the interrupted run goes on with other endpoints or time-outs than before.
        walk: the run is this walk-through of a procedure; None for a procedure itself.
        job: id of the job of a campaign that it belongs to; empty for none.
    """

    loaded: LoadedCell
    procedure: Runnable
    params: BaseModel
    bench: Bench
    plan: Any
    aim: str
    aim_simulated: bool | None
    resume: Path | None = None
    clock_speed: float = 1.0
    relinked: bool = False
    walk: Walk | None = None
    job: str = ""

    @property
    def system(self) -> System:
        """What there is to ask of the bench."""
        return system_of(self.bench)

    @property
    def on_client_lost(self) -> Literal["continue", "hold", "stop"]:
        """What becomes of the run when the client with control is lost: nobody walks an arm alone."""
        return "stop" if self.walk is not None else self.loaded.cell.engine.on_client_lost


def plan_run(
    loaded: LoadedCell, procedure: Runnable, params: BaseModel, root: Path, search: str, job: str = ""
) -> PlannedRun:
    """Plan a procedure; every limit is checked here.

    Args:
        root: folder of all runs; the newest search of this cell is looked for there.
        search: "auto", "none" or a search run.
        job: of a campaign that the run belongs to; empty for none.

    Raises:
        ConfigError: the cell file does not describe what the procedure needs.
        ProcedureError: the plan violates a limit or cannot be made.
        UsageError: the search run cannot be used.
    """
    bench = bench_for(loaded.cell, procedure.needs, procedure.name)
    aim = find_basis(procedure.needs.basis, bench, root, search)
    equipped = procedure.equipped(aim.bench, params)
    plan = procedure.plan(equipped, params)
    return PlannedRun(loaded, procedure, params, equipped, plan, aim.source, aim.simulated, job=job)


async def carry_out(
    planned: PlannedRun,
    root: Path,
    publish: Publish,
    *,
    speed: float = 1.0,
    arm: str | None = None,
    answers: Path | None = None,
    keep_drives: bool = False,
    install_signals: SignalInstaller = loop_signals,
    answerer: Answerer | None = None,
    on_open: OnOpen | None = None,
    observe: Callable[[DeviceBuilder], DeviceBuilder] = lambda build: build,
    waive_walk: str | None = None,
    attended: Callable[[], bool] = lambda: False,
    terminal: bool = True,
) -> RunOutcome:
    """Run a planned procedure on the cell's devices.

    Args:
        publish: takes the headless events.
        speed: bench seconds in one real second; above 1 for emulators only.
        arm: the cell's name as typed to allow real hardware to move.
        answers: TOML file of prompt id to answer.
        keep_drives: leave the drives on at the end, unless the run is aborted.
        install_signals: delivers signals to the stop ladder.
        answerer: a front end that answers questions.
        on_open: lets a service reach the run while its record is open.
        observe: returns a builder of the same devices that lets somebody see what passes.
        waive_walk: why a real arm may be driven where it was not walked.
        attended: somebody is there who could let a held run go on.
        terminal: the events are read at a terminal, not by a pipe or a file.
    """
    cell, clock = planned.loaded.cell, SystemClock(speed)
    if (umask := cell.runs.umask) is not None:
        # Of the whole process: databases and logs of the run are made by libraries, too.
        os.umask(umask)
    request = replace(
        _request_of(planned, root, speed),
        arm=arm,
        answers=read_answers(answers),
        answerer=answerer,
        keep_drives=keep_drives,
        on_open=on_open,
        on_output_lost=output_policy(cell.engine.on_output_lost, terminal=terminal),
        hold_limit_s=cell.engine.hold_limit_s,
        attended=attended,
        walk_rule=_walk_rule(planned, root, waive_walk),
    )
    build = observe(device_builder(cell, clock))
    if (walk := planned.walk) is not None:
        request = replace(
            request, override_cap_percent=walk.cap_percent, on_open=walk.opened(on_open), walk_rule=None
        )
        build = fed(build, walk)
    return await run_procedure(request, build, clock, publish, install_signals)


def _walk_rule(planned: PlannedRun, root: Path, reason: str | None) -> WalkRule:
    walked = partial(walked_legs, root, planned.loaded.cell)
    blended = planned.bench.arm.following == "blended"
    return WalkRule(planned.bench.arm.axes, partial(motions_from, planned), walked, blended, reason)


def _request_of(planned: PlannedRun, root: Path, speed: float) -> RunRequest:
    """Return what the plan and its cell ask for."""
    cell, bench = planned.loaded.cell, planned.bench
    return RunRequest(
        procedure=planned.procedure,
        plan=planned.plan,
        root=root,
        cell=cell.name,
        driven=bench.arm,
        blocked=way_check(bench),
        line_target=partial(line_target, bench),
        override_cap_percent=cell.robot.override_cap_percent,
        air=cell.air,
        air_limits=cell.conditions,
        meta=run_meta(planned, speed) if planned.resume is None else _meta_of_resumption(planned, speed),
        clock_speed=speed,
        aim_simulated=planned.aim_simulated,
        unconfirmed=bench.workspace.unconfirmed,
        resume=planned.resume,
        hands=_hands(cell),
        aftermath=find_aftermath(planned.procedure.needs.aftermath, cell.name, root),
    )


async def rehearse(planned: PlannedRun, here: Pose | None = None) -> DryRunContext:
    """Run a planned procedure without any device and return what it would do; what is done already is left out.

    Args:
        here: where the arm stands; at rest when nobody knows.
    """
    system = planned.system
    steps = [] if planned.resume is None else RunReader(planned.resume).steps()
    context = DryRunContext(
        system,
        pose=here or system.rest,
        declared=planned.procedure.records,
        done={step.step_id: step.result for step in steps},
    )
    await planned.procedure.run(context, planned.plan)
    await planned.procedure.teardown(context)
    context.require_clear_ways()
    return context


async def motions_from(planned: PlannedRun, here: Pose) -> list[Leg]:
    """Return every straight motion that a planned run would drive from where the arm stands."""
    # A rehearsal takes seconds, in which the loop has to go on.
    context = await asyncio.to_thread(lambda: asyncio.run(rehearse(planned, here)))
    return context.motions


def stored_cell(cell: Cell) -> dict[str, Json]:
    """Return what of a cell file belongs to a run; commands do not: a record is data, whoever it comes from."""
    return cell.model_dump(mode="json", exclude={"hooks"})


def run_meta(planned: PlannedRun, speed: float) -> dict[str, Json]:
    """Return what a new run stores about itself: everything that going on with it needs."""
    loaded, walk = planned.loaded, planned.walk
    belongs: dict[str, Json] = {JOB: planned.job} if planned.job else {}
    walked: dict[str, Json] = {} if walk is None else {WALK: walk_fact(walk.procedure.name, loaded.cell)}
    return {
        **walked,
        **belongs,
        "configuration": stored_cell(loaded.cell),
        "configuration_origins": dict(loaded.origins),
        "configuration_file": str(loaded.path),
        "configuration_sha256": loaded.sha256,
        "params": planned.params.model_dump(mode="json"),
        "aim": planned.aim,
        "aimed": {**planned.system.aim_facts(), "simulated": planned.aim_simulated},
        "plan_sha256": plan_digest(planned.plan),
        "operator": getpass.getuser(),
        "clock_speed": speed,
    }


def _meta_of_resumption(planned: PlannedRun, speed: float) -> dict[str, Json]:
    """Return what is stored with the reopening of a run."""
    meta: dict[str, Json] = {"operator": getpass.getuser(), "clock_speed": speed}
    if planned.relinked:
        meta["configuration"] = stored_cell(planned.loaded.cell)
        meta["configuration_file"] = str(planned.loaded.path)
    return meta


def _hands(cell: Cell) -> SimulatedOperator | None:
    """Return the hands of the emulated operator; None on a bench without a control port."""
    endpoint = hands_endpoint(cell)
    return None if endpoint is None else SimulatedOperator(endpoint)


def read_answers(path: Path | None) -> dict[str, str]:
    """Return the answers of a file by the id of their prompt.

    Raises:
        ConfigError: the file cannot be used; the text says what a line looks like.
    """
    if path is None:
        return {}
    try:
        table = read_toml(path)
    except ConfigError as error:
        raise ConfigError(
            f'the answers cannot be read: {error}; a line of such a file is: "beam/P1/0042" = "retry"'
        ) from error
    return {key: answer_text(value) for key, value in table.items()}


def answer_text(value: object) -> str:
    """Return an answer as a TOML file may give it: true stands for yes."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return str(value)
