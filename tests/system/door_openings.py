"""A door that is opened at random moments of motion: what reached the controller, and in which order."""

import json
import random
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.store.reader import RunReader
from tests.system.command import Emulated, begun
from tests.system.test_ways_of_following import ALL_THETA2, FEW_NODES

SLOW = {
    **FEW_NODES,
    ALL_THETA2: "theta2_deg = [20.0, 40.0]",
    "[tracker]": '[io]\nendpoint = "tcp://127.0.0.1:10503"\n\n[tracker]',
    "override_cap_percent = 20 ": "override_cap_percent = 3 ",
}
"""Edits of the template: a small plan, driven so slowly that every motion takes a second or more."""

_LONGEST_S = 20.0
_OF_A_RUN = 12
"""Openings of one run, which ends by itself and has motions to spare."""

_POLL_S = 0.005


@dataclass
class Opening:
    """One opening of the door while the arm moved.

    Attributes:
        stop_s: from the opening to STOP at the controller, real s.
        after: what was asked of the controller from the STOP until the door was closed.
    """

    stop_s: float
    after: list[str] = field(default_factory=list)

    @property
    def motions(self) -> int:
        """How many motions were begun before the door was closed."""
        return sum(text.startswith("motion to") for text in self.after)


def requests(bench: Emulated, since_s: float) -> list[tuple[float, str]]:
    """Return what the controller was asked and what it did since a bench time."""
    entries: list[dict[str, Any]] = bench.ask(op="log", device="robot")["entries"]
    return [(entry["time_s"], entry["text"]) for entry in entries if entry["time_s"] >= since_s]


def open_once(bench: Emulated, wait_s: float, speed: int) -> Opening | None:
    """Open the door while the arm moves and close it when it stands; None when no motion was met in time."""
    end_s = time.monotonic() + _LONGEST_S
    while not bench.ask(op="state")["moving"]:
        if time.monotonic() > end_s:
            return None
        time.sleep(_POLL_S)
    time.sleep(wait_s)
    state = bench.ask(op="state")
    if not state["moving"]:
        return None
    before_s = state["time_s"]
    bench.ask(op="fault", name="door", open=True)
    while bench.ask(op="state")["moving"]:
        time.sleep(_POLL_S)
    time.sleep(0.3)
    asked = requests(bench, before_s)
    bench.ask(op="fault", name="door", open=False)
    stops = [number for number, (_, text) in enumerate(asked) if "STOP" in text]
    if not stops:
        # The motion was over in the moment in which the door was opened.
        return None
    return Opening((asked[stops[0]][0] - before_s) / speed, [text for _, text in asked[stops[0] :]])


def open_at_random(
    bench: Emulated, folder: Path, count: int, seed: int, speed: int
) -> tuple[list[Opening], list[RunReader]]:
    """Measure again and again; open the door at random moments of motion.

    Args:
        bench: with the door's block.
        folder: where the runs are kept.
        count: openings that met a motion.
        seed: of the moments.
        speed: bench seconds in one real second; the door is looked at in real time.
    """
    moments, found, records = random.Random(seed), list[Opening](), list[RunReader]()
    options = ["--speed", str(speed), "--search", "none", "--json", "--param", 'reflectors=["P2"]']
    while len(found) < count:
        with begun("run", "open-loop", "--cell", bench.cell, *options, cwd=folder) as (process, output):
            while json.loads(output.readline())["event"] != "step-started":
                pass
            for _ in range(min(_OF_A_RUN, count - len(found))):
                opening = open_once(bench, moments.uniform(0.0, 1.0 / speed), speed)
                if opening is not None:
                    found.append(opening)
            event = [json.loads(line) for line in output][-1]
            process.wait(_LONGEST_S)
            assert event["event"] == "run-ended"
            assert event["status"] == "complete", event
            records.append(RunReader(folder / event["path"]))
    return found, records


def require_acknowledged(record: RunReader) -> int:
    """Check that each interruption ended by an acknowledgement, and return how many there were."""
    order: list[str] = []
    for event in record.events():
        if event.kind == "state" and event.data["state"] in {"SUSPENDING", "EXECUTE"}:
            order.append(str(event.data["state"]))
    answered = [prompt for prompt in record.prompts() if str(prompt["id"]).startswith("acknowledge/")]
    interruptions = order.count("SUSPENDING")
    assert order == ["EXECUTE", *["SUSPENDING", "EXECUTE"] * interruptions]
    assert len(answered) >= interruptions
    assert {prompt["answer"] for prompt in answered} <= {"yes"}
    return interruptions


assert all(old in TEMPLATE for old in SLOW)
