"""The bench and the mathematics agree: an arm measured without noise is identified without error."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import identify
from catseye.calibration.scara.points import Commands, Points
from catseye.simulators.world.scara.arm import scara_bench
from catseye.simulators.world.scara.axis_errors import JointMap
from catseye.simulators.world.scara.truth import TrueArm
from tests.unit.simulators.benches import QUIET, calibration_map, go, without_j4_play

MDEG = math.pi / 180e3
NODES1_DEG = np.arange(-120.0, 101.0, 40.0)
NODES2_DEG = np.arange(0.0, 121.0, 40.0)
PLACES = {"P1": (651.0, -402.0), "P2": (678.0, 1.0), "P3": (642.0, 379.0)}
TAKE_UP_DEG = 5.0


def true_arm() -> TrueArm:
    rng = np.random.default_rng(1)
    theta1 = random_map(rng, np.arange(-180.0, 181.0, 20.0))
    theta2 = random_map(rng, np.arange(-20.0, 161.0, 20.0))
    return TrueArm(325.02, 224.97, theta1, theta2, PLACES, 0.01)


def random_map(rng: np.random.Generator, nodes_deg: Floats) -> JointMap:
    positive, negative = rng.normal(0.0, 10.0 * MDEG, (2, nodes_deg.size))
    return JointMap(np.deg2rad(nodes_deg), positive, negative)


def measured_lengths(truth: TrueArm, name: str) -> list[tuple[float, float, int, int, float]]:
    """Visit every node from both sides with a take-up, the beam on one reflector; return commands and lengths."""
    bench = scara_bench(replace(truth, reflectors={name: truth.reflectors[name]}), without_j4_play(QUIET))
    centre = complex(*truth.reflectors[name])
    rows = []
    for direction1 in (1, -1):
        for theta1 in NODES1_DEG[::direction1]:
            for direction2 in (1, -1):
                for theta2 in NODES2_DEG[::direction2]:
                    go(
                        bench,
                        (theta1 - direction1 * TAKE_UP_DEG, theta2 - direction2 * TAKE_UP_DEG, 0.0, 0.0),
                        100.0,
                    )
                    go(bench, (theta1, theta2, 0.0, 0.0), 100.0)
                    insight = bench.true_state()
                    aim_deg = math.degrees(cmath.phase(centre - complex(*insight.axis_mm)))
                    go(bench, (theta1, theta2, 0.0, aim_deg - insight.beam_deg), 100.0)
                    insight = bench.true_state()
                    assert insight.miss_mm < 1e-6
                    rows.append((theta1, theta2, direction1, direction2, insight.length_mm))
    return rows


def points(rows: dict[str, list[tuple[float, float, int, int, float]]]) -> Points:
    table = np.array([row for name in PLACES for row in rows[name]])
    owner = np.repeat(np.arange(len(PLACES)), [len(rows[name]) for name in PLACES])
    dead_mm = np.array([rows[name][0][4] for name in PLACES])
    commands = Commands(
        np.deg2rad(table[:, 0]),
        np.deg2rad(table[:, 1]),
        table[:, 2].astype(np.int64),
        table[:, 3].astype(np.int64),
    )
    paths = tuple((name, 0) for name in PLACES)
    return Points(commands, owner, owner, table[:, 4] - dead_mm[owner], None, tuple(PLACES), paths)


def both_tables(table: JointMap, nodes_deg: Floats) -> Floats:
    nodes, up = np.deg2rad(nodes_deg), np.ones(nodes_deg.size, dtype=np.int64)
    read = calibration_map(table)
    return np.concatenate([read.deviation(nodes, up), read.deviation(nodes, -up)])


def test_an_arm_measured_without_noise_is_identified_without_error() -> None:
    truth = true_arm()
    measured = points({name: measured_lengths(truth, name) for name in PLACES})
    rough = np.array([(place.x_mm, place.y_mm) for place in QUIET.reflectors])
    nodes = (np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG))
    found = identify(measured, "error-map", *nodes, 325.0, 225.0, rough)
    assert found.parameters[:2] == pytest.approx([truth.link1_mm, truth.link2_mm], abs=1e-8)
    error1 = found.parameters[found.layout.map1] - both_tables(truth.theta1_map, NODES1_DEG)
    error2 = found.parameters[found.layout.map2] - both_tables(truth.theta2_map, NODES2_DEG)
    # Distances do not fix the rotation about J1: the map of J1 is known up to a constant.
    assert np.max(np.abs(error1 - np.mean(error1))) < 1e-8 * MDEG
    assert np.max(np.abs(error2)) < 1e-8 * MDEG
