"""Models on a path of distances: truth from loops and plain trigonometry."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from catseye.app.errors import UsageError
from catseye.app.results.scara.distance_validation import DistancePath, validate_on_distances
from catseye.app.results.scara.path_rows import distance_path, path_measurement
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.extension import j4_map, thermal_drift
from catseye.calibration.scara.identification import Identification, identify
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.points import Commands, Points
from catseye.procedures.kit.records import Row
from tests.unit.app.store.fakes import RECORDS, TickingClock
from tests.unit.calibration.scara.drifting import course
from tests.unit.calibration.scara.paper import (
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    Truth,
    paper_points,
    random_truth,
    sequence,
)

SIGMA_MM = 0.01
COUNT = 60


def between(nodes_deg: list[float], table: list[float], angle_deg: float) -> float:
    """Return a table between its nodes, rad."""
    i = min(int((angle_deg - nodes_deg[0]) // 20.0), len(nodes_deg) - 2)
    share = (angle_deg - nodes_deg[i]) / 20.0
    return table[i] + share * (table[i + 1] - table[i])


def true_place(truth: Truth, command: tuple[float, float, int, int]) -> tuple[float, float]:
    one, two, s1, s2 = command
    a = math.radians(one) + between(NODES1_DEG, truth.map1[s1], one)
    b = a + math.radians(two) + between(NODES2_DEG, truth.map2[s2], two)
    x = truth.link1_mm * math.cos(a) + truth.link2_mm * math.cos(b)
    y = truth.link1_mm * math.sin(a) + truth.link2_mm * math.sin(b)
    return x, y


def true_length(truth: Truth, command: tuple[float, float, int, int], reflector: int) -> float:
    return math.dist(true_place(truth, command), truth.reflectors[reflector])


def commands() -> list[tuple[float, float, int, int]]:
    """Return a way off the nodes, there with both joints upwards and back."""
    there = [(-115.0 + 5.1 * i, 12.0 + 3.9 * i, 1, 1) for i in range(COUNT // 2)]
    return there + [(one, two, -1, -1) for one, two, _, _ in reversed(there)]


def path(truth: Truth, segments: list[int] | None = None, name: str = "P2") -> DistancePath:
    """Return a measured path; every segment has a zero of its own."""
    rows, numbers = commands(), segments or [0] * COUNT
    used = sorted(set(numbers))
    lengths = np.array([true_length(truth, row, int(name[1]) - 1) for row in rows])
    zeros = {segment: 37.0 * segment + 400.0 for segment in used}
    values = lengths - np.array([zeros[segment] for segment in numbers])
    columns = np.array(rows)
    points = Points(
        Commands(
            np.deg2rad(columns[:, 0]),
            np.deg2rad(columns[:, 1]),
            columns[:, 2].astype(np.int64),
            columns[:, 3].astype(np.int64),
        ),
        np.zeros(COUNT, dtype=np.int64),
        np.array([used.index(segment) for segment in numbers], dtype=np.int64),
        values,
        None,
        (name,),
        tuple((name, segment) for segment in used),
    )
    established = np.ones(COUNT, dtype=np.bool_)
    return DistancePath(points, np.zeros((COUNT, 2)), np.repeat([1, -1], COUNT // 2), established)


def identified(
    truth: Truth, model: ModelName, seed: int | None = None, reflectors: int = 3
) -> Identification:
    count = reflectors * 352
    noise = None if seed is None else np.random.default_rng(seed).normal(0.0, SIGMA_MM, count)
    points = paper_points(truth, reflectors, noise, SIGMA_MM)
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    return identify(points, model, *nodes, 325.0, 225.0, NOMINAL_REFLECTORS[:reflectors])


TRUTH = random_truth(3)
EXACT = identified(TRUTH, "error-map")
CONVENTIONAL = identified(TRUTH, "conventional")


def test_the_true_arm_leaves_nothing_and_the_conventional_one_much() -> None:
    validation = validate_on_distances(path(TRUTH), [CONVENTIONAL, EXACT])
    assert [model.model for model in validation.models] == ["conventional", "error-map"]
    assert validation.compared.all()
    assert validation.models[1].max_um < 0.01
    assert validation.models[0].rms_um > 20.0
    assert validation.ratio is not None
    assert validation.ratio < 1e-3
    assert validate_on_distances(path(TRUTH), [EXACT]).ratio is None


def test_a_drifting_zero_counts_by_what_zeros_leave() -> None:
    """Truth: the variance of each order about its mean in a segment, added up in loops."""
    segments = [0] * 20 + [1] * 40
    drift = Contributor("zero", "length", 0.004, "time", orders=3, spectrum=(4.0, 0.5))
    still, drifting = (replace(EXACT, budget=Budget(one)) for one in ((), (drift,)))
    before, after = (
        validate_on_distances(path(TRUTH, segments), [one]).models[0] for one in (still, drifting)
    )
    falling = 1.0 + 1 / 4 + 1 / 9
    for i in range(COUNT):
        together = [j for j in range(COUNT) if segments[j] == segments[i]]
        added = 0.0
        # Orders 2 and 3 are one octave.
        for order, ratio in ((1, 4.0), (2, 0.5), (3, 0.5)):
            wave = [course(order, j / (COUNT - 1)) for j in range(COUNT)]
            left = wave[i] - sum(wave[j] for j in together) / len(together)
            added += 0.004**2 * ratio / order**2 / falling * left**2
        assert after.u_mm[i] ** 2 - before.u_mm[i] ** 2 == pytest.approx(added, rel=1e-9)


def test_each_segment_has_a_dead_path_of_its_own() -> None:
    segments = [0] * 20 + [4] * 20 + [7] * 20
    (model,) = validate_on_distances(path(TRUTH, segments), [EXACT]).models
    assert model.max_um < 0.01
    assert model.dead_paths_mm == {
        ("P2", 0): pytest.approx(400.0, abs=1e-4),
        ("P2", 4): pytest.approx(548.0, abs=1e-4),
        ("P2", 7): pytest.approx(659.0, abs=1e-4),
    }


def test_a_deviation_is_measured_minus_predicted() -> None:
    measured = path(TRUTH)
    grown = measured.points.displacement_mm.copy()
    grown[5] += 0.6
    points = replace(measured.points, displacement_mm=grown)
    (model,) = validate_on_distances(replace(measured, points=points), [EXACT]).models
    # The dead path takes up a share of one in sixty.
    assert model.deviation_mm[5] == pytest.approx(0.6 * 59.0 / 60.0, abs=1e-5)
    assert model.deviation_mm[6] == pytest.approx(-0.6 / 60.0, abs=1e-5)
    assert model.rms_um == pytest.approx(1e3 * math.sqrt((0.59**2 + 59 * 0.01**2) / 60.0), rel=1e-4)
    assert model.max_um == pytest.approx(590.0, abs=0.1)


def arm_of(parameters: NDArray[np.float64]) -> Truth:
    """Return an arm from a parameter vector: links, both tables of J1 and of J2, places."""
    first, second = parameters[2:24].tolist(), parameters[24:40].tolist()
    return Truth(
        parameters[0],
        parameters[1],
        {1: first[:11], -1: first[11:]},
        {1: second[:8], -1: second[8:]},
        parameters[40:46].reshape(3, 2),
    )


def test_the_uncertainty_is_what_drawn_arms_scatter_by() -> None:
    (model,) = validate_on_distances(path(TRUTH), [EXACT]).models
    draws = np.random.default_rng(1).multivariate_normal(EXACT.parameters, EXACT.covariance, 300)
    arms = [arm_of(draw[:46]) for draw in draws]
    lengths = np.array([[true_length(arm, row, 1) for row in commands()] for arm in arms])
    scatter = np.std(lengths - lengths.mean(axis=1)[:, None], axis=0)
    assert model.u_mm == pytest.approx(scatter, rel=0.2)
    assert float(np.median(model.u_mm / scatter)) == pytest.approx(1.0, abs=0.05)


def test_uncovered_or_reversed_rows_and_short_segments_are_excluded() -> None:
    measured = path(TRUTH, [0] * 56 + [1] * 2 + [2] * 2)
    theta1 = measured.points.commands.theta1_rad.copy()
    theta1[3] = np.deg2rad(61.0)
    established = measured.established.copy()
    established[10] = False
    points = replace(measured.points, commands=replace(measured.points.commands, theta1_rad=theta1))
    validation = validate_on_distances(
        replace(measured, points=points, established=established), [CONVENTIONAL, EXACT]
    )
    assert np.flatnonzero(~validation.compared).tolist() == [3, 10, 56, 57, 58, 59]
    assert validation.rejected == (
        "segment 1 of reflector P2 left out: 2 distance(s) to compare, fewer than 3",
        "segment 2 of reflector P2 left out: 2 distance(s) to compare, fewer than 3",
    )
    for model in validation.models:
        assert np.flatnonzero(np.isnan(model.deviation_mm)).tolist() == [3, 10, 56, 57, 58, 59]
        assert np.flatnonzero(np.isnan(model.u_mm)).tolist() == [3, 10, 56, 57, 58, 59]
    nothing = replace(measured, established=np.zeros(COUNT, dtype=np.bool_))
    with pytest.raises(InsufficientPointsError, match="no segment of the path has 3 distances"):
        validate_on_distances(nothing, [EXACT])


def test_a_model_has_to_know_the_reflector_of_the_path() -> None:
    with pytest.raises(UsageError, match=r"identified without reflector P3.*it knows P1, P2"):
        validate_on_distances(path(TRUTH, name="P3"), [identified(TRUTH, "error-map", reflectors=2)])


def stored_row(y_mm: float, theta1_deg: float, direction1: int, segment: int, pass_number: int) -> Row:
    return {
        "x_mm": 200.0,
        "y_mm": y_mm,
        "theta1_deg": theta1_deg,
        "theta2_deg": 90.0,
        "direction1": direction1,
        "direction2": 1,
        "reflector": "P2",
        "segment": segment,
        "displacement_mm": 0.5 * y_mm,
        "pass_number": pass_number,
    }


def test_what_the_beam_angle_adds_is_part_of_the_prediction() -> None:
    # 20 µm of cos 2θ4 in every distance, those of the measurement and those of the path; θ4 from the places by hand.
    def added(command: tuple[float, float, int, int], reflector: int) -> float:
        x, y = true_place(TRUTH, command)
        px, py = TRUTH.reflectors[reflector]
        theta4 = math.atan2(py - y, px - x) - math.radians(command[0] + command[1])
        return 0.020 * math.cos(2.0 * theta4)

    extra = [
        added((NODES1_DEG[i], NODES2_DEG[j], s1, s2), r) for r in range(3) for i, j, s1, s2 in sequence()
    ]
    points = paper_points(TRUTH, 3, np.array(extra), SIGMA_MM)
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    rough = TRUTH.reflectors
    with_j4 = identify(points, "error-map", *nodes, 325.0, 225.0, rough, terms=j4_map((2,)))
    without = identify(points, "error-map", *nodes, 325.0, 225.0, rough)
    measured = path(TRUTH)
    grown = measured.points.displacement_mm + np.array([added(row, 1) for row in commands()])
    bent = replace(measured, points=replace(measured.points, displacement_mm=grown))
    poor, good = validate_on_distances(bent, [without, with_j4]).models
    assert good.max_um < 0.5
    assert poor.rms_um > 5.0


def test_links_that_grew_over_the_measurement_stand_in_its_middle() -> None:
    points = paper_points(TRUTH, 3, None, SIGMA_MM)
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    plain = identify(points, "error-map", *nodes, 325.0, 225.0, TRUTH.reflectors, terms=thermal_drift())
    parameters = plain.parameters.copy()
    parameters[plain.layout.extension] = 0.5
    grown = replace(plain, parameters=parameters)
    (still,) = validate_on_distances(path(TRUTH), [grown]).models
    assert still.max_um < 0.01


async def test_stored_distances_become_columns(tmp_path: Path) -> None:
    # Row two of the first pass is missing: it was blind.
    way = [(-10.0, 1.0, 1), (10.0, 5.0, 1), (10.0, 5.0, 1), (0.0, 4.5, -1), (-10.0, 1.0, -1)]
    rows = [stored_row(y, one, d, p, p) for p in range(2) for y, one, d in way]
    store = await RunStore.create(
        tmp_path, "validation-path", {}, TickingClock(), records=RECORDS, reserve_bytes=0
    )
    await store.append_step("rows", 1, "rows", {}, [("path", row) for row in rows])
    await store.finish("complete", 0)
    found = distance_path(RunReader(store.path), 1.0)
    assert found.points.reflector_names == ("P2",)
    assert found.points.dead_paths == (("P2", 0), ("P2", 1))
    assert found.points.dead_path.tolist() == [0] * 5 + [1] * 5
    assert found.points.displacement_mm.tolist() == [-5.0, 5.0, 5.0, 0.0, -5.0] * 2
    assert found.travel.tolist() == [1, 1, -1, -1, -1] * 2
    # Half a degree after the turn no direction holds yet; the second pass was approached with a take-up again.
    assert found.established.tolist() == [True, True, True, False, True] * 2
    with pytest.raises(UsageError, match="holds distances along a path, not positions"):
        path_measurement(RunReader(store.path), 1.0)


@pytest.mark.parametrize(("stated_mm", "explained"), [(0.012, True), (0.003, False)])
def test_noise_is_judged_by_what_is_stated(stated_mm: float, explained: bool) -> None:
    """Distances scatter by 12 µm; the parameters are exact."""
    noise = np.random.default_rng(11).normal(0.0, 0.012, COUNT)
    measured = path(TRUTH, [0] * 20 + [1] * 40)
    points = replace(measured.points, displacement_mm=measured.points.displacement_mm + noise)
    known = replace(EXACT, budget=Budget((Contributor("noise", "length", stated_mm),)))
    (model,) = validate_on_distances(replace(measured, points=points), [known]).models
    assert model.probability is not None
    assert (model.probability > 0.01) == explained
    assert (model.probability < 1e-3) != explained


def test_without_a_stated_scatter_nothing_is_judged() -> None:
    (model,) = validate_on_distances(path(TRUTH), [replace(EXACT, budget=None)]).models
    assert model.probability is None
