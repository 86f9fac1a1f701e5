"""What is to be run and within which bounds, and how it ended."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from catseye.app.cell.model import Air, Conditions
from catseye.app.engine.ending import EndStatus
from catseye.app.engine.gate import WayCheck
from catseye.app.engine.halt import HaltLimits
from catseye.app.engine.handle import OnOpen
from catseye.app.engine.operator import Answerer
from catseye.app.engine.simulated_operator import SimulatedOperator
from catseye.app.engine.stepping import LineTarget
from catseye.app.engine.timekeeping import StepTime
from catseye.app.engine.walked.rule import WalkRule
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.loss import OutputPolicy
from catseye.app.protocol.procedures import Executable
from catseye.app.store.run_store import DEFAULT_RESERVE_BYTES
from catseye.procedures.kit.bench import Arm
from catseye.procedures.kit.records import Json


@dataclass(frozen=True)
class RunRequest:
    """What is to be run, and within which bounds.

    Attributes:
        procedure: what happens.
        plan: what the procedure's own `plan()` returned.
        root: directory of all runs.
        cell: name of the cell.
        driven: the arm that is driven, with the ranges that the cell allows.
        blocked: returns why bodies are in the way of a motion.
        line_target: returns where a straight shift of the tool ends.
        override_cap_percent: highest speed override.
        meta: resolved configuration with origins, operator, parameters; stored with the run.
        arm: the cell's name as typed by the operator; None when nothing was typed.
        answers: answers file, by prompt id.
        answerer: a front end that answers prompts.
        hands: do on an emulated bench what prompts ask for.
        resume: directory of a run to go on with, instead of a new one.
        air: how the program corrects for the air where the instrument does not.
        air_limits: ranges of the air in which a measurement goes on.
        reserve_bytes: free disk space needed.
        halt_limits: how long a halt may take, real time.
        teardown_limit_s: how long the teardown, and the closing of the devices, may take, real s.
        unconfirmed: dimensions of bodies that nobody has confirmed; they are named before a real arm moves.
        aim_simulated: whether the search that the plan aims with was made on emulated devices; None without one.
        clock_speed: bench seconds in one real second; anything but 1 is for emulated devices only.
        keep_drives: leave the drives on at the end, unless the run is aborted.
        on_open: gives a service access to the run while its record is open.
        walk_rule: what a real arm has to be walked first; None where nothing has to be.
        on_output_lost: what becomes of the run when nobody takes its events any more.
        hold_limit_s: how long it waits, held, suspended or with a question, while nobody is there, real s; None for
            ever.
        attended: somebody is there who could let it go on.
        aftermath: what an earlier run has left the bench like, said at the start and with a failure; empty for none.
    """

    procedure: Executable
    plan: object
    root: Path
    cell: str
    driven: Arm
    blocked: WayCheck
    line_target: LineTarget
    override_cap_percent: float
    meta: Mapping[str, Json] = field(default_factory=dict)
    arm: str | None = None
    answers: Mapping[str, str] = field(default_factory=dict)
    answerer: Answerer | None = None
    hands: SimulatedOperator | None = None
    resume: Path | None = None
    air: Air = field(default_factory=Air)
    air_limits: Conditions = field(default_factory=Conditions)
    reserve_bytes: int = DEFAULT_RESERVE_BYTES
    halt_limits: HaltLimits = field(default_factory=HaltLimits)
    teardown_limit_s: float = 60.0
    clock_speed: float = 1.0
    aim_simulated: bool | None = None
    unconfirmed: Sequence[str] = ()
    keep_drives: bool = False
    on_open: OnOpen | None = None
    walk_rule: WalkRule | None = None
    on_output_lost: OutputPolicy = "hold"
    hold_limit_s: float | None = None
    attended: Callable[[], bool] = lambda: False
    aftermath: str = ""


@dataclass(frozen=True)
class RunOutcome:
    """How a run ended.

    Attributes:
        path: the run's directory.
        status: complete, stopped, aborted or failed.
        exit_code: of the process.
        text: why it did not complete; empty otherwise.
        step_times: where the time of each step that ran went.
        drives_on: the drives were left on, or are not certain to be off; None where this run left them as they were.
        unacknowledged: why nothing may move before somebody has acknowledged it; empty otherwise.
    """

    path: Path
    status: EndStatus
    exit_code: ExitCode
    text: str
    step_times: list[StepTime]
    drives_on: bool | None = None
    unacknowledged: str = ""
