"""From rows to an arm, and the arm against its truth in any gauge."""

import copy
import math
from functools import cache
from typing import Any

import numpy as np
import pytest

from catseye.app.results.scara.identify import identify_points
from catseye.app.results.scara.plausible import ImplausibleError
from catseye.app.results.scara.points import COLUMNS, point_columns, with_sigma
from catseye.app.results.scara.truth import compare_with_truth, gauge_turn_rad, turned_places
from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.scara.errors import MapRangeError
from catseye.calibration.scara.identification import Identification
from catseye.procedures.scara.bench import ScaraBench
from tests.unit.calibration.scara.paper import (
    MDEG,
    NAMES,
    NODES1_DEG,
    NODES2_DEG,
    Truth,
    random_truth,
    sequence,
    true_position,
)
from tests.unit.procedures.benches import bench


def rows_of(truth: Truth, noise_mm: float = 0.0) -> list[dict[str, object]]:
    rng = np.random.default_rng(4)
    rows = []
    for j, name in enumerate(NAMES):
        for command in sequence():
            length = math.dist(true_position(truth, command), truth.reflectors[j])
            one, two = NODES1_DEG[command[0]], NODES2_DEG[command[1]]
            value = length - 400.0 + float(rng.normal(0.0, noise_mm)) if noise_mm else length - 400.0
            row = (name, 0, one, two, command[2], command[3], value)
            rows.append(dict(zip(COLUMNS, row, strict=True)))
    return rows


def identified(rows: list[dict[str, object]], on: ScaraBench | None = None) -> Identification:
    points = with_sigma(point_columns(rows), 0.0156)
    return identify_points(points, on or bench(), "error-map", None)


@cache
def noisy() -> Identification:
    return identified(rows_of(random_truth(21), 0.0156))


def document(truth: Truth) -> dict[str, Any]:
    def table(nodes: list[float], tables: dict[int, list[float]]) -> dict[str, Any]:
        return {
            "node_deg": nodes,
            "positive_mdeg": [v / MDEG for v in tables[1]],
            "negative_mdeg": [v / MDEG for v in tables[-1]],
        }

    return {
        "link1_mm": {"value": truth.link1_mm},
        "link2_mm": {"value": truth.link2_mm},
        "theta1_map": table(NODES1_DEG, truth.map1),
        "theta2_map": table(NODES2_DEG, truth.map2),
        "reflectors": [
            {"name": name, "x_mm": {"value": float(x)}, "y_mm": {"value": float(y)}}
            for name, (x, y) in zip(NAMES, truth.reflectors, strict=True)
        ],
    }


def turned(original: dict[str, Any], angle_deg: float) -> dict[str, Any]:
    """Return the same truth seen from a frame that is turned: J1 map and places move together."""
    other, a = copy.deepcopy(original), math.radians(angle_deg)
    for key in ("positive_mdeg", "negative_mdeg"):
        other["theta1_map"][key] = [value + 1e3 * angle_deg for value in other["theta1_map"][key]]
    for place in other["reflectors"]:
        x, y = place["x_mm"]["value"], place["y_mm"]["value"]
        place["x_mm"]["value"] = math.cos(a) * x - math.sin(a) * y
        place["y_mm"]["value"] = math.sin(a) * x + math.cos(a) * y
    return other


def test_rows_give_back_the_arm_they_were_made_from() -> None:
    truth = random_truth(20)
    found = identified(rows_of(truth))
    assert found.parameters[:40] == pytest.approx(truth.table_vector(), abs=1e-10)
    assert found.parameters[40:46] == pytest.approx(truth.reflectors.ravel(), abs=1e-7)
    comparison = compare_with_truth(found, document(truth))
    assert comparison.identified == pytest.approx(comparison.truth, abs=1e-6)
    assert comparison.units == ["mm"] * 2 + ["mdeg"] * 38 + ["mm"] * 6
    assert comparison.names[:3] == ["L1", "L2", "Δθ1(-140°, +)"]


def test_errors_over_u_are_about_one_with_honest_noise() -> None:
    assert 0.7 < compare_with_truth(noisy(), document(random_truth(21))).rms_normalised < 1.3


@pytest.mark.parametrize("angle_deg", [0.5, -3.0, 0.004])
def test_turning_the_truth_changes_nothing(angle_deg: float) -> None:
    plain = document(random_truth(21))
    other = turned(plain, angle_deg)
    assert gauge_turn_rad(noisy(), other) == pytest.approx(math.radians(angle_deg), abs=1e-12)
    first, second = compare_with_truth(noisy(), plain), compare_with_truth(noisy(), other)
    assert second.truth == pytest.approx(first.truth, abs=1e-7)
    assert second.normalised == pytest.approx(first.normalised, abs=1e-5)
    places = turned_places(other, math.radians(angle_deg))
    for place in plain["reflectors"]:
        expected = (place["x_mm"]["value"], place["y_mm"]["value"])
        assert places[place["name"]] == pytest.approx(expected, abs=1e-9)


def test_an_error_in_the_truth_affects_only_its_line() -> None:
    plain = document(random_truth(21))
    other = copy.deepcopy(plain)
    other["theta2_map"]["negative_mdeg"][3] += 2.0
    difference = compare_with_truth(noisy(), other).truth - compare_with_truth(noisy(), plain).truth
    assert np.flatnonzero(np.abs(difference) > 1e-9).tolist() == [2 + 22 + 8 + 3]
    assert difference[2 + 22 + 8 + 3] == pytest.approx(2.0)


def test_nodes_that_no_row_touches_are_named() -> None:
    rows = [row for row in rows_of(random_truth(20)) if row["theta1_deg"] != 0.0]
    with pytest.raises(UnidentifiableError, match=r"no point touches Δθ1\(0°, \+\), Δθ1\(0°, −\)"):
        identified(rows)


def test_a_direction_that_is_never_used_is_named() -> None:
    rows = [row for row in rows_of(random_truth(20)) if row["direction2"] == 1]
    with pytest.raises(UnidentifiableError, match=r"no point touches Δθ2\(0°, −\), Δθ2\(20°, −\)"):
        identified(rows)


def test_rows_in_another_unit_are_refused() -> None:
    rows = rows_of(random_truth(20))
    inches = [{**row, "displacement_mm": float(str(row["displacement_mm"])) / 25.4} for row in rows]
    with pytest.raises(ImplausibleError, match="seems to be in inches"):
        identified(inches)


def test_rows_outside_the_nodes_and_too_few_rows_are_refused() -> None:
    rows = rows_of(random_truth(20))
    with pytest.raises(MapRangeError, match="never extrapolated"):
        identified(rows, bench((-140.0, 40.0)))
    with pytest.raises(InsufficientPointsError, match="measure more points"):
        identified(rows[:20])
