"""Running a procedure in a test: on an ideal bench, of which the test makes whatever it likes."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.service.running import plan_run
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Row


@dataclass
class IdealContext(DryRunContext):
    """The engine as a procedure sees it, in front of an ideal bench: limits and records are checked as in a run.

    Every value is that of an ideal bench. A test that needs another one overrides the method that returns it.

        class Drifting(IdealContext):
            async def joints(self) -> Pose:
                return tuple(angle + 0.05 for angle in await super().joints())

    Attributes:
        answers: to questions, by their ids; others have the answer that goes on.
        results: of the steps, by their ids.
        lives: the values that were shown.
    """

    answers: Mapping[str, str] = field(default_factory=dict)
    results: dict[str, Row] = field(default_factory=dict)
    lives: list[Live] = field(default_factory=list)

    @property
    def rehearsing(self) -> bool:
        """What a test returns counts as measured."""
        return False

    async def step(self, step_id: str, title: str, action: Callable[[], Awaitable[Row]]) -> Row:
        """Run a step and keep its result."""
        self.results[step_id] = await super().step(step_id, title, action)
        return self.results[step_id]

    async def ask(self, prompt: Prompt, watch: Callable[[], Awaitable[Live]] | None = None) -> str:
        """Keep the question and return its answer.

        Raises:
            ValueError: the test gives something that is no answer to it.
        """
        usual = await super().ask(prompt, watch)
        answer = self.answers.get(prompt.id, usual)
        if fault := prompt.fault_of(answer):
            raise ValueError(f"{prompt.id!r} was answered by {answer!r}: {fault}")
        return answer

    def show(self, live: Live) -> None:
        """Keep a value."""
        self.lives.append(live)


def run_ideal(
    procedure: Procedure,
    *,
    cell: Path | None = None,
    context: type[IdealContext] = IdealContext,
    answers: Mapping[str, str] | None = None,
    done: Mapping[str, Row] | None = None,
    **params: Any,
) -> IdealContext:
    """Plan a procedure and run it to its end, teardown included; whatever it raises comes out.

    Args:
        procedure: to be tested.
        cell: file that describes the bench; None for that of `catseye init`.
        context: with the values of the test.
        answers: to questions, by their ids.
        done: results of steps that an interrupted run has done: it is resumed.
        params: as on the command line.

    Returns:
        What has happened: `records`, `results`, `prompts`, `notes` (events and warnings), `motions`, `steps`.

    Raises:
        pydantic.ValidationError: a parameter is wrong.
        ConfigError: the cell file does not describe what the procedure needs.
    """
    chosen = procedure.params_type.model_validate(params)
    with TemporaryDirectory() as folder:
        if cell is None:
            cell = Path(folder) / "cell.toml"
            cell.write_text(TEMPLATE, encoding="utf-8")
        planned = plan_run(load_cell(cell), procedure, chosen, Path(folder), "none")
    made = context(
        planned.system, planned.system.rest, procedure.records, answers=answers or {}, done=done or {}
    )
    asyncio.run(_to_the_end(procedure, made, planned.plan))
    return made


async def _to_the_end(procedure: Procedure, context: IdealContext, plan: Any) -> None:
    await procedure.run(context, plan)
    await procedure.teardown(context)
    context.require_clear_ways()
