"""A run in the process of the command that starts it: told on the terminal, answered there, and open to clients."""

import getpass
import sys
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from app.bench.facts import facts_of
from app.commands.narrator import Narrator
from app.engine.host import RunOutcome
from app.running import PlannedRun, carry_out
from app.service.console import KEYS, Console
from app.service.lines import Lines
from app.service.run_service import RunService


async def serve_and_run(
    planned: PlannedRun, root: Path, answers: Path | None, arm: str | None, speed: float, *, as_json: bool
) -> RunOutcome:
    """Carry a plan out and serve clients meanwhile."""
    at_terminal = not as_json and sys.stdin.isatty() and sys.stderr.isatty()
    who = getpass.getuser() if at_terminal else None
    service = RunService(planned.loaded.cell.engine.on_client_lost, who, root)
    go_on = f"{KEYS}, each with Enter; Ctrl-C again stops" if at_terminal else None
    narrator = Narrator(planned.procedure.name, as_json, go_on)
    narrator.interactive = at_terminal
    with ExitStack() as stack:
        if who is not None:
            console = Console(service.hub, who, narrator.tell)

            def typed(line: str) -> None:
                narrator.entered()
                console.take(line)

            stack.enter_context(Lines(sys.stdin.fileno(), typed, console.end).read())
        return await carry_out(
            planned,
            root,
            service.hub.publisher(narrator.publish),
            speed=speed,
            arm=arm,
            answers=answers,
            answerer=service.hub.desk,
            on_open=service.serve,
            observe=partial(service.telemetry.observe, facts_of(planned.loaded.cell, planned.bench)),
        )
