"""Runs of an arm that is written down here, with the errors of Table 2, which the program does not know.

Twice in each series the arm returns to its first pose.
"""

import math
from pathlib import Path

import numpy as np

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Json, Row
from tests.unit.app.engine.fakes import point
from tests.unit.app.test_path_comparison import stored
from tests.unit.calibration.scara.paper import (
    NAMES,
    NODES1_DEG,
    NODES2_DEG,
    Truth,
    random_truth,
    sequence,
    true_position,
)

WHITE_MM = 0.010
RADIAL_MM = (0.005, 0.005, 0.010)
ORDERS = 5

AFTER = (175, 351)
"""Points of a series, from 0, behind which the arm returns to the first one."""


def rows_of_arm(seed: int) -> list[tuple[str, Row]]:
    """Return the paper's distances to three reflectors, one segment each, and the returns, with their tables."""
    rng, truth = np.random.default_rng([seed, 5]), random_truth(seed)
    motions = [_Motion(rng, rms_mm) for rms_mm in RADIAL_MM]
    commands = sequence()
    rows: list[tuple[str, Row]] = []
    for j in range(len(NAMES)):
        for i, command in enumerate(commands):
            rows.append(("points", _distance(rng, truth, motions, j, command)))
            if i in AFTER:
                rows.append(("records", closure(_distance(rng, truth, motions, j, commands[0]))))
    return rows


def _distance(
    rng: np.random.Generator,
    truth: Truth,
    motions: list["_Motion"],
    j: int,
    command: tuple[int, int, int, int],
) -> Row:
    error_mm = _radial_mm(truth, command, j, motions) + float(rng.normal(0.0, WHITE_MM))
    length_mm = math.dist(true_position(truth, command), truth.reflectors[j]) + error_mm
    return {
        **point(),
        "reflector": NAMES[j],
        "segment": j,
        "theta1_deg": NODES1_DEG[command[0]],
        "theta2_deg": NODES2_DEG[command[1]],
        "direction1": command[2],
        "direction2": command[3],
        "displacement_mm": length_mm - 400.0,
    }


def closure(distance: Row) -> Row:
    """Return what is stored of a visit to a reference pose."""
    visit: Row = {"number": 1, "point": 0, "reference_displacement_mm": 0.0, "overlaps": 0, "drift_um": 0.0}
    return {"kind": "closure", **visit, **distance}


class _Motion:
    """Where an axis stands while it turns, in the frame of the link that carries it: harmonics 1…5, even rms."""

    def __init__(self, rng: np.random.Generator, rms_mm: float) -> None:
        self.factors = rng.normal(0.0, rms_mm / math.sqrt(ORDERS), (2, ORDERS, 2))

    def at(self, angle_rad: float) -> tuple[float, float]:
        x, y = (
            sum(c * math.cos(k * angle_rad) + s * math.sin(k * angle_rad) for k, (c, s) in enumerate(axis, 1))
            for axis in self.factors
        )
        return x, y


def _radial_mm(truth: Truth, command: tuple[int, int, int, int], j: int, motions: list[_Motion]) -> float:
    """Return what the radial error motions add to a distance, mm."""
    place = true_position(truth, command)
    away = (place[0] - truth.reflectors[j][0], place[1] - truth.reflectors[j][1])
    unit = (away[0] / math.hypot(*away), away[1] / math.hypot(*away))
    one, two = math.radians(NODES1_DEG[command[0]]), math.radians(NODES2_DEG[command[1]])
    beam = math.atan2(-unit[1], -unit[0]) - one - two
    turned = (0.0, one, one + two)
    added = 0.0
    for motion, frame, angle in zip(motions, turned, (one, two, beam), strict=True):
        x, y = motion.at(angle)
        cosine, sine = math.cos(frame), math.sin(frame)
        added += unit[0] * (cosine * x - sine * y) + unit[1] * (sine * x + cosine * y)
    return added


async def measured_run(folder: Path, seed: int, **meta: Json) -> RunReader:
    """Store a measurement below folder/runs and write a cell file that fits it."""
    (folder / "cell.toml").write_text(TEMPLATE, encoding="utf-8")
    compensation: Json = {"by": "instrument", "sentence": "The instrument corrects its lengths."}
    rows = rows_of_arm(seed)
    return await stored(folder / "runs", "open-loop", rows, **{"compensation": compensation, **meta})
