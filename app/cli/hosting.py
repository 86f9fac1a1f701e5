"""A run in the process of the command that starts it: shown and answered on the terminal, and open to clients."""

import asyncio
import getpass
import os
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from catseye.app.cli.event_channel import starter_gone
from catseye.app.cli.narrator import Narrator
from catseye.app.cli.walk_keys import HINT, WalkKeys
from catseye.app.engine.announcer import Publish
from catseye.app.engine.handle import RunHandle
from catseye.app.engine.request import RunOutcome
from catseye.app.engine.waiting import cancel
from catseye.app.service.console import KEYS, Console
from catseye.app.service.hooks import Hooks, RunHooks
from catseye.app.service.lines import Lines, in_foreground
from catseye.app.service.metrics import MetricsFile
from catseye.app.service.run_metrics import metrics_of
from catseye.app.service.run_service import RunService
from catseye.app.service.running import PlannedRun, carry_out
from catseye.app.service.watching.bench_facts import facts_of
from catseye.drivers.roles.clock import SystemClock


@dataclass(frozen=True)
class DriveOptions:
    """How a plan is driven.

    Attributes:
        answers: TOML file of prompt id to answer.
        arm: the cell's name as typed to let real hardware move.
        speed: bench seconds in one real second; None for that of the run that goes on.
        keep_drives: leave the drives on at the end.
        waive_walk: why a real arm may be driven where it was not walked.
        as_json: events as JSON instead of talk.
        telemetry: live values and what happens among them.
        metrics: file that says how the run fares, as OpenMetrics text; None for none.
    """

    answers: Path | None
    arm: str | None
    speed: float | None
    keep_drives: bool
    waive_walk: str | None
    as_json: bool
    telemetry: bool = False
    metrics: Path | None = None


async def serve_and_run(planned: PlannedRun, root: Path, options: DriveOptions) -> RunOutcome:
    """Carry a plan out and serve clients meanwhile."""
    at_terminal = not options.as_json and sys.stdin.isatty() and sys.stderr.isatty()
    # Single keys are read by whoever has the terminal in front of them.
    at_terminal = at_terminal and (planned.walk is None or in_foreground(sys.stdin.fileno()))
    who = getpass.getuser() if at_terminal else None
    service = RunService(planned.on_client_lost, who, root)
    go_on = f"{KEYS}, each with Enter; Ctrl-C again stops" if at_terminal else None
    narrator = Narrator(planned.procedure.name, options.as_json, go_on, telemetry=options.telemetry)
    narrator.interactive = at_terminal
    hooks = Hooks(SystemClock())
    metrics = metrics_of(options.metrics, planned, root, service.telemetry)
    of_run = hooks.of_run(planned.loaded.cell.hooks)
    async with AsyncExitStack() as stack:
        stack.push_async_callback(hooks.end)
        stack.push_async_callback(cancel, asyncio.create_task(_end_with_starter()))
        publish: Publish = narrator.publish
        if who is not None:
            publish = _at_terminal(stack, planned, narrator, Console(service.registry, who, narrator.show))
        elif planned.walk is not None:
            planned.walk.feed.by_itself = True
        if metrics is not None:
            publish = metrics.before(publish)
        return await carry_out(
            planned,
            root,
            service.registry.publisher(of_run.before(publish)),
            speed=planned.clock_speed if options.speed is None else options.speed,
            arm=options.arm,
            answers=options.answers,
            keep_drives=options.keep_drives,
            answerer=service.registry.broker,
            on_open=partial(_serve, service, of_run, metrics),
            attended=lambda: service.registry.attended,
            terminal=(sys.stdout if options.as_json else sys.stderr).isatty(),
            observe=partial(service.telemetry.observe, facts_of(planned.loaded.cell, planned.bench)),
            waive_walk=options.waive_walk,
        )


@asynccontextmanager
async def _serve(
    service: RunService, hooks: RunHooks, metrics: MetricsFile | None, handle: RunHandle
) -> AsyncIterator[None]:
    """Serve clients, and let those who only hear of the run warn of what goes wrong there."""
    async with AsyncExitStack() as stack:
        stack.enter_context(hooks.attending(handle))
        if metrics is not None:
            await stack.enter_async_context(metrics.kept(handle))
        await stack.enter_async_context(service.serve(handle))
        yield


async def _end_with_starter() -> None:
    """End the run, as SIGTERM does, when the program that started it has gone: nobody leads the job any more."""
    await starter_gone()
    os.kill(os.getpid(), signal.SIGTERM)


def _at_terminal(stack: AsyncExitStack, planned: PlannedRun, narrator: Narrator, console: Console) -> Publish:
    """Read what is typed until the stack is left; return what takes the events meanwhile."""
    stdin = sys.stdin.fileno()

    def typed(line: str) -> None:
        narrator.entered()
        console.take(line)

    if planned.walk is None:
        stack.enter_context(Lines(stdin, typed, console.end).read())
        return narrator.publish
    keys = WalkKeys(stdin, planned.walk.feed, console.take, SystemClock())
    stack.enter_context(keys.held())
    stack.enter_context(Lines(stdin, typed, console.end, keys.sort).read())
    narrator.show(HINT)
    return keys.before(narrator.publish)
