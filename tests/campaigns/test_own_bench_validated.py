"""The emulated bench measured, identified and validated by its tracker, seed by seed, without sockets.

What is left on the path is as large as expected: the probabilities of all seeds are uniform. The arm with
what it does between nodes, its scatter and its error motions are the simulator's, not the program's.

`CATSEYE_VALIDATED_SEEDS` sets how many [40].
"""

import cmath
import math
import os
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.results.scara.validation import (
    ModelOnPath,
    PathMeasurement,
    established_rows,
    validate_on_path,
)
from catseye.app.service.scara.emulation import emulation_config
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import identify
from catseye.calibration.scara.points import Commands, Points
from catseye.procedures.scara.motion.approach import Command, with_take_up
from catseye.procedures.scara.open_loop.off_node import measuring_sequence, usual_count
from catseye.procedures.scara.path.path_plan import plan_path
from catseye.procedures.scara.path.tracked_path import PathPoint
from catseye.simulators.config import Joints
from catseye.simulators.world.scara.arm import ScaraArm
from catseye.simulators.world.scara.truth import draw_truth
from catseye.simulators.world.tracker import Tracker

SEEDS = int(os.environ.get("CATSEYE_VALIDATED_SEEDS", "40"))
PASSES = 5
SETTLED_S = 1.0
HEIGHT_MM = 50.0


class Driven:
    """A true arm on its bench."""

    def __init__(self, folder: Path, seed: int) -> None:
        file = folder / "cell.toml"
        file.write_text(TEMPLATE, encoding="utf-8")
        self.cell = load_cell(file).cell
        self.bench = scara_bench_of(self.cell)
        config = emulation_config(self.cell, 1.0, seed, None)
        self.truth = draw_truth(seed, config)
        self._arm, self._now_s = ScaraArm(self.truth, config), 0.0

    def axis_at(self, joints: Joints) -> complex:
        """Drive there and return where the J4 axis comes to rest."""
        self._arm.move_to(joints, self._now_s, 0.2, 1.0)
        self._now_s = self._arm.motion.end_s + SETTLED_S
        return complex(self._arm.poses(np.array([self._now_s])).axis_mm[0])

    def j4_deg(self, command: Command, place: complex) -> float:
        """Return the J4 angle that aims at a place, as the nominal arm has it."""
        one, both = (
            math.radians(angle) for angle in (command.theta1_deg, command.theta1_deg + command.theta2_deg)
        )
        beam = place - cmath.rect(325.0, one) - cmath.rect(225.0, both)
        aim = math.degrees(cmath.phase(beam) - both - self.truth.theta40_rad)
        return (aim + 180.0) % 360.0 - 180.0


def commands_of(rows: "list[Command] | list[PathPoint]") -> Commands:
    theta = np.deg2rad([(row.theta1_deg, row.theta2_deg) for row in rows])
    states = np.array([(row.direction1, row.direction2) for row in rows], dtype=np.int64)
    return Commands(theta[:, 0], theta[:, 1], states[:, 0], states[:, 1])


def distances(driven: Driven) -> Points:
    """Return what a perfect counter on the beam sees of the arm, a dead path a reflector."""
    bench, names = driven.bench, tuple(driven.truth.reflectors)
    count = usual_count(bench.nodes1_deg)
    stops = with_take_up(measuring_sequence(bench.nodes1_deg, bench.nodes2_deg, count), bench.take_up_deg)
    rows: list[Command] = []
    index: list[int] = []
    lengths: list[float] = []
    for number, place in enumerate(complex(*xy) for xy in driven.truth.reflectors.values()):
        for stop in stops:
            target = stop.command or Command(0, stop.theta1_deg, stop.theta2_deg, 1, 1)
            angles = (stop.theta1_deg, stop.theta2_deg, HEIGHT_MM, driven.j4_deg(target, place))
            length = abs(driven.axis_at(angles) - place)
            if stop.command is not None:
                rows.append(stop.command)
                index.append(number)
                lengths.append(length)
    reflector = np.array(index, dtype=np.int64)
    dead_paths = tuple((name, 0) for name in names)
    return Points(commands_of(rows), reflector, reflector.copy(), np.array(lengths), None, names, dead_paths)


def tracked(driven: Driven, seed: int) -> PathMeasurement:
    """Return what the bench's tracker sees of the paper's path, the mean of its passes."""
    plan, tracker = plan_path(driven.bench), Tracker(seed)
    points = list(plan.points)
    seen = np.zeros((len(points), 2))
    for _ in range(PASSES):
        driven.axis_at((plan.run_in[0], plan.run_in[1], HEIGHT_MM, 0.0))
        for place, point in enumerate(points):
            axis = driven.axis_at((point.theta1_deg, point.theta2_deg, HEIGHT_MM, 0.0))
            seen[place] += np.array(tracker.measure((axis.real, axis.imag))) / PASSES
    commands = commands_of(points)
    return PathMeasurement(
        commands=commands,
        command_mm=np.array([(point.x_mm, point.y_mm) for point in points]),
        travel=np.ones(len(points), dtype=np.int64),
        measured_mm=seen,
        u_mm=np.full(len(points), tracker.u_mm / math.sqrt(PASSES)),
        established=established_rows(commands, math.radians(driven.bench.take_up_deg)),
        arrivals=PASSES,
    )


def validated(folder: Path, seed: int) -> ModelOnPath:
    driven = Driven(folder, seed)
    bench = driven.bench
    found = identify(
        distances(driven),
        "error-map",
        np.deg2rad(bench.nodes1_deg),
        np.deg2rad(bench.nodes2_deg),
        bench.link1_mm,
        bench.link2_mm,
        np.array([reflector.xy_mm for reflector in bench.reflectors]),
        driven.cell.uncertainty.budget,
    )
    (model,) = validate_on_path(tracked(driven, seed), [found.arm], (bench.link1_mm, bench.link2_mm)).models
    return model


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> list[ModelOnPath]:
    folder = tmp_path_factory.mktemp("validated")
    return [validated(folder, seed) for seed in range(1, SEEDS + 1)]


def normalised(models: list[ModelOnPath]) -> Floats:
    values = np.concatenate([model.agreement.normalised.ravel() for model in models])
    return np.asarray(values[np.isfinite(values)], dtype=np.float64)


@pytest.mark.timeout(60 + 60 * SEEDS)
def test_probabilities_of_the_own_bench_are_uniform(models: list[ModelOnPath]) -> None:
    found = stats.kstest([model.agreement.probability for model in models], "uniform")
    print(f"\n{SEEDS} seeds: KS p = {found.pvalue:.3f}")  # noqa: T201  # the figure
    assert found.pvalue > 0.01


def test_path_points_lie_within_what_is_stated(models: list[ModelOnPath]) -> None:
    errors = normalised(models)
    rms, within = float(np.sqrt(np.mean(errors**2))), float(np.mean(np.abs(errors) <= 2.0))
    print(f"\npath points: z rms {rms:.2f}, {100.0 * within:.1f} % within ±2 u")  # noqa: T201  # the figure
    assert 0.8 < rms < 1.2
    assert within >= 0.93
