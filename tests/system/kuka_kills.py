"""Whole runs on an emulated KUKA that are killed at random moments of motion, and what its controller saw of it."""

import random
import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tests.system.command import Emulated
from tests.system.guarded import Program, program, until

EXAMPLE: Final = Path(__file__).parents[2] / "docs" / "examples" / "kuka.toml"
SLOW: Final = {"override_cap_percent = 10 ": "override_cap_percent = 1 "}
"""The range check of the optics moves for more than a minute."""

FEW: Final = (
    "joints=A1",
    "positions=K3",
    "directions=[1]",
    "steps=12",
    "standstill_s=15",
    "dwell_s=2",
    "accept_slow_counter=true",
)
"""A short series; at twenty times real speed the emulated counter is asked too seldom for an evaluation."""

LONGEST_WAIT_S: Final = 2.0
REST_WITHIN_S: Final = 0.7
"""The last heartbeat, 0.5 s, a cycle and the deceleration."""


@dataclass(frozen=True)
class Kill:
    """What became of an arm whose program was killed while it moved, by the controller's own notes.

    Attributes:
        stop_s: from the kill to the stop variable's write, bench s; None where the heartbeat alone stopped it.
        rest_s: from the kill to the standstill, bench s.
        orders: that were written after the kill.
        motions: that began after the kill.
    """

    stop_s: float | None
    rest_s: float
    orders: int
    motions: int


class Moving(Program):
    """A program that drives a serial arm."""

    @property
    def moving(self) -> bool:
        return bool(self.bench.ask(op="arm")["moving"])


def killed(bench: Emulated, moments: random.Random, *words: str | Path) -> Kill:
    """Start a run or its resumption in real time, and kill it at a random moment of motion."""
    bench.ask(op="speed", value=1.0)
    with program(bench, *words) as begun:
        run = Moving(bench, begun.process)
        run.until_moving()
        time.sleep(moments.uniform(0.0, LONGEST_WAIT_S))
        # It moves and stands in turns: one look says both that it moves and when.
        while not (seen := bench.ask(op="arm"))["moving"]:
            run.until_moving()
        since_s = float(seen["time_s"])
        run.send(signal.SIGKILL)
        until(lambda: not run.moving)
        # Long enough for whatever might still come.
        time.sleep(REST_WITHIN_S)
    return _seen(bench, since_s)


def measuring(bench: Emulated) -> tuple[str | Path, ...]:
    """Return the words of a run that tests one joint at one place."""
    params = [word for param in FEW for word in ("--param", param)]
    return ("run", "resolution", "--cell", bench.cell, *params)


def newest(bench: Emulated) -> str:
    """Return the name of the newest run."""
    return max(path.name for path in (bench.cell.parent / "catseye-runs").glob("2*_resolution_*"))


def _seen(bench: Emulated, since_s: float) -> Kill:
    entries: list[dict[str, Any]] = bench.ask(op="log", device="robot")["entries"]
    after = [(e["time_s"] - since_s, e["text"]) for e in entries if e["time_s"] >= since_s]
    stops_s = [time_s for time_s, text in after if text == "write CATS_STOP = TRUE"]
    rests_s = [time_s for time_s, text in after if text.startswith("arrival")]
    return Kill(
        stop_s=min(stops_s, default=None),
        rest_s=min(rests_s),
        orders=sum(text.startswith("write CATS_SEQ") for _, text in after),
        motions=sum(text.startswith(("motion to", "way through")) for _, text in after),
    )
