"""Something that stands in the beam at random moments of a run, and what the distances would be by the truth."""

import json
import math
import random
import subprocess
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from catseye.calibration.core.types import Floats
from tests.patience import HANG_S
from tests.system.command import Emulated, start


@dataclass(frozen=True)
class Block:
    """When the beam is blocked, and for how long.

    Attributes:
        after_step: number of steps that are done before.
        delay_s: from that moment on, bench s.
        duration_s: bench s; None until somebody clears the beam.
    """

    after_step: int
    delay_s: float
    duration_s: float | None


def random_blocks(seed: int, count: int, steps: int, lasting: int) -> list[Block]:
    """Return blocks at random moments, `lasting` of them until somebody clears the beam; none at the very end.

    The delay reaches over the whole of a point: motion, settling and dwell.
    """
    rng = random.Random(seed)
    after = sorted(rng.sample(range(1, steps - 2), count))
    forever = set(rng.sample(range(count), lasting))
    return [
        Block(step, rng.uniform(0.0, 2.0), None if i in forever else rng.uniform(0.2, 3.0))
        for i, step in enumerate(after)
    ]


@dataclass(frozen=True)
class Story:
    """What a run wrote to its stdout.

    Attributes:
        code: of its exit.
        events: as JSON.
        stderr: what it wrote for people.
    """

    code: int
    events: list[dict[str, Any]]
    stderr: str


def run_blocked(bench: Emulated, blocks: Iterable[Block], speed: str, *options: str) -> Story:
    """Run open-loop and block the beam; the emulated operator clears what does not go away by itself."""
    arguments = ["--cell", str(bench.cell), "--speed", speed, "--json", *options]
    process = start("run", "open-loop", *arguments, cwd=bench.cell.parent)
    due = {block.after_step: block for block in blocks}
    try:
        events = list(_watched(process, bench, due, float(speed)))
        _, stderr = process.communicate(timeout=HANG_S)
    finally:
        process.kill()
        process.communicate()
    return Story(process.returncode, events, stderr)


def _watched(
    process: "subprocess.Popen[str]", bench: Emulated, due: Mapping[int, Block], speed: float
) -> Iterable[dict[str, Any]]:
    assert process.stdout is not None
    done = 0
    for line in process.stdout:
        event: dict[str, Any] = json.loads(line)
        yield event
        if event["event"] != "step-done":
            continue
        done += 1
        if (block := due.get(done)) is not None:
            time.sleep(block.delay_s / speed)
            bench.ask(op="fault", name="block_beam", duration_s=block.duration_s)


def misfits_um(points: list[dict[str, Any]], truth: Mapping[str, Any]) -> Floats:
    """Return how far each distance is from the true arm's, each segment with a dead path of its own, µm.

    One is left with the best dead path of its segment: its median, so that one wrong point does not hide in it.
    """
    off = np.array([float(point["displacement_mm"]) - _length_mm(point, truth) for point in points])
    segments = [(point["reflector"], point["segment"]) for point in points]
    for segment in set(segments):
        rows = [i for i, own in enumerate(segments) if own == segment]
        off[rows] -= np.median(off[rows])
    return np.asarray(off * 1e3)


def _length_mm(point: Mapping[str, Any], truth: Mapping[str, Any]) -> float:
    """Return the true length of the beam at a command, from links, flanks of the maps and the reflector."""
    one = math.radians(point["theta1_deg"]) + _deviation_rad(
        truth["theta1_map"], point["theta1_deg"], point["direction1"]
    )
    two = math.radians(point["theta2_deg"]) + _deviation_rad(
        truth["theta2_map"], point["theta2_deg"], point["direction2"]
    )
    link1, link2 = truth["link1_mm"]["value"], truth["link2_mm"]["value"]
    x = link1 * math.cos(one) + link2 * math.cos(one + two)
    y = link1 * math.sin(one) + link2 * math.sin(one + two)
    place = next(place for place in truth["reflectors"] if place["name"] == point["reflector"])
    return math.hypot(place["x_mm"]["value"] - x, place["y_mm"]["value"] - y)


def _deviation_rad(table: Mapping[str, Any], theta_deg: float, direction: int) -> float:
    flank = table["positive_mdeg" if direction > 0 else "negative_mdeg"]
    return math.radians(1e-3 * float(np.interp(theta_deg, table["node_deg"], flank)))


def still_truth(folder: Path, places: Mapping[str, tuple[float, float]]) -> Path:
    """Write a true arm with links and maps of its own whose reflectors stand where the cell file has them."""
    nodes = [float(node) for node in range(-170, 171, 10)]
    maps = {
        f"theta{joint}_map": {
            "node_deg": nodes,
            "positive_mdeg": [12.0 * math.sin(math.radians(joint * node)) - 10.0 for node in nodes],
            "negative_mdeg": [12.0 * math.sin(math.radians(joint * node)) + 10.0 for node in nodes],
        }
        for joint in (1, 2)
    }
    document = {
        "format": "catseye-result/1",
        "link1_mm": {"value": 325.02},
        "link2_mm": {"value": 224.97},
        **maps,
        "theta40_deg": 0.0,
        "reflectors": [
            {"name": name, "x_mm": {"value": x}, "y_mm": {"value": y}} for name, (x, y) in places.items()
        ],
    }
    path = folder / "truth.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    return path
