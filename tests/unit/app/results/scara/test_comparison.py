"""Two results against one another: closed forms, and an arm seen in two frames."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.app.results.scara.comparison import compare_results
from catseye.app.results.scara.identified_arm import arm_of
from catseye.app.results.scara.result import Result, TakenUpPart

MDEG = math.radians(1e-3)


def estimate(value: float, u: float = 0.0) -> dict[str, float]:
    return {"value": value, "u": u}


def table(nodes: list[float], positive: list[float], negative: list[float], u: float) -> dict[str, Any]:
    return {
        "node_deg": nodes,
        "positive_mdeg": positive,
        "negative_mdeg": negative,
        "u_positive_mdeg": [u] * len(nodes),
        "u_negative_mdeg": [u] * len(nodes),
    }


FIT = {
    "n_points": 40,
    "n_parameters": 12,
    "dof": 28,
    "rms_um": 3.0,
    "sigma0_um": 3.5,
    "iterations": 3,
    "rejected": [],
    "null_directions": [],
}


def result(run: str, **parts: Any) -> Result:
    whole: dict[str, Any] = {
        "format": "catseye-result/1",
        "model": "error-map",
        "gauge": "mean of theta1 map = 0",
        "link1_mm": estimate(325.01, 0.003),
        "link2_mm": estimate(224.99, 0.004),
        "theta1_map": table([0.0, 10.0], [2.0, 4.0], [-1.0, -5.0], 0.3),
        "theta2_map": table([0.0, 20.0], [1.0, 3.0], [5.0, 7.0], 0.4),
        "reflectors": [{"name": "P1", "x_mm": estimate(650.0, 0.02), "y_mm": estimate(-400.0, 0.03)}],
        "dead_paths": [],
        "fit": FIT,
        "provenance": {"runs": [run], "software": "test", "created": ""},
    }
    return Result.model_validate({**whole, **parts})


def test_links_and_reflectors_in_combined_standard_uncertainties() -> None:
    second = result(
        "b",
        link1_mm=estimate(325.02, 0.004),
        reflectors=[{"name": "P1", "x_mm": estimate(650.1, 0.02), "y_mm": estimate(-400.0, 0.04)}],
    )
    found = compare_results(result("a"), second)
    link1, link2 = found.values
    assert link1.u == pytest.approx(0.005)
    assert link1.difference == pytest.approx(0.01)
    assert link1.normalised == pytest.approx(2.0)
    assert link2.difference == 0.0
    x, y = found.reflectors
    assert x.name == "P1 x"
    assert x.difference == pytest.approx(0.1)
    assert x.u == pytest.approx(math.hypot(0.02, 0.02))
    assert y.u == pytest.approx(0.05)
    assert found.turn_mdeg == 0.0


def test_maps_at_the_same_nodes_and_signs_of_the_difference() -> None:
    second = result("b", theta2_map=table([0.0, 20.0], [2.0, 3.0], [5.0, 5.0], 0.3))
    found = compare_results(result("a"), second)
    of_j2 = found.maps[1]
    np.testing.assert_allclose(of_j2.difference_mdeg, [[1.0, 0.0], [0.0, -2.0]])
    np.testing.assert_allclose(of_j2.u_mdeg, 0.5)
    np.testing.assert_allclose(of_j2.normalised, [[2.0, 0.0], [0.0, -4.0]])


def test_frame_of_j1_is_no_difference() -> None:
    """One arm, of which the second measurement knows J1 = 10°…30° only: another mean, so another frame."""
    upwards, downwards = [2.0, 4.0, -3.0, 1.0], [-1.0, -5.0, 6.0, -4.0]
    known = [4.0, -3.0, 1.0, -5.0, 6.0, -4.0]
    turn = float(np.mean(known))
    first = result("a", theta1_map=table([0.0, 10.0, 20.0, 30.0], upwards, downwards, 0.3))
    angle = math.atan2(-400.0, 650.0) - math.radians(1e-3 * turn)
    radius = math.hypot(650.0, 400.0)
    second = result(
        "b",
        theta1_map=table(
            [10.0, 20.0, 30.0],
            [value - turn for value in upwards[1:]],
            [value - turn for value in downwards[1:]],
            0.3,
        ),
        reflectors=[
            {
                "name": "P1",
                "x_mm": estimate(radius * math.cos(angle), 0.02),
                "y_mm": estimate(radius * math.sin(angle), 0.03),
            }
        ],
    )
    found = compare_results(first, second)
    assert found.turn_mdeg == pytest.approx(turn)
    assert found.maps[0].node_deg.tolist() == [10.0, 20.0, 30.0]
    np.testing.assert_allclose(found.maps[0].difference_mdeg, 0.0, atol=1e-9)
    assert [one.difference for one in found.reflectors] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_uncertainty_in_the_common_gauge() -> None:
    """Of 2m independent values of variance s² the deviation from their mean has s² (1 − 1/2m)."""
    found = compare_results(result("a"), result("b"))
    np.testing.assert_allclose(found.maps[0].u_mdeg, math.sqrt(2.0 * 0.3**2 * (1.0 - 1.0 / 4.0)))


def test_finer_map_is_interpolated_between_its_nodes() -> None:
    """Halfway between two independent nodes the variance is half of one node's."""
    coarse = result("a", theta2_map=table([5.0, 15.0], [0.0, 0.0], [0.0, 0.0], 0.0))
    fine = result("b", theta2_map=table([0.0, 10.0, 20.0], [1.0, 3.0, 9.0], [0.0, 2.0, 0.0], 0.4))
    of_j2 = compare_results(coarse, fine).maps[1]
    np.testing.assert_allclose(of_j2.second_mdeg, [[2.0, 6.0], [1.0, 1.0]])
    np.testing.assert_allclose(of_j2.u_mdeg, 0.4 / math.sqrt(2.0))


def test_conventional_model_is_a_constant_map() -> None:
    conventional = result(
        "b", model="conventional", theta20_mdeg=estimate(4.0, 0.3), theta1_map=None, theta2_map=None
    )
    found = compare_results(result("a"), conventional)
    np.testing.assert_allclose(found.maps[1].difference_mdeg, [[3.0, 1.0], [-1.0, -3.0]])
    np.testing.assert_allclose(found.maps[1].u_mdeg, 0.5)
    assert any("conventional" in text for text in found.remarks)
    both = compare_results(conventional, conventional)
    assert [one.name for one in both.values] == ["L1", "L2", "θ20"]
    assert both.maps == ()


def test_shared_distances_are_reported() -> None:
    assert "a" in compare_results(result("a"), result("a")).remarks[0]
    assert "independent" in compare_results(result("a"), result("b")).remarks[0]


RADIAL: dict[str, Any] = {
    "name": "runout of J2",
    "kind": "radial",
    "value_um": 2.0,
    "correlation": "axis-angle",
    "axis": "j2",
    "orders": 1,
}
SCALE: dict[str, Any] = {
    "name": "wavelength",
    "kind": "scale",
    "value_ppm": 0.1,
    "correlation": "common",
}


def with_budget(run: str, moved: float, entries: list[dict[str, Any]] | None = None) -> Result:
    """Return a result whose first node of J2 the runout of J2 has moved by so many of its u."""
    variances = np.diag([0.003, 0.004, *[0.3 * MDEG] * 4, *[0.4 * MDEG] * 4]) ** 2
    matrix = np.zeros((10, 4))
    matrix[6, 0] = moved * 0.4 * MDEG
    row = {"result": "L1", "unit": "um", "u": 3.0, "u_parts": [0.0, 2.0], "shares": [0.0, 1.0]}
    stated = entries or [RADIAL, SCALE]
    part = {"contributors": [one["name"] for one in stated], "rows": [row]}
    bare = result(run)
    names = arm_of(bare).layout.names()[:10]
    return result(
        run,
        covariance={
            "names": names,
            "matrix": variances.tolist(),
            "taken_up": [{"contributor": 0, "matrix": matrix.tolist()}],
        },
        uncertainty={
            "method": "jacobian",
            "coverage": 0.95,
            "intervals": [],
            "correlations": [],
            "contributions": part,
        },
        budget={"source": "cell", "name": "cell", "contributor": stated},
    )


def test_what_both_share_is_none_of_the_difference() -> None:
    """Of u² + u² the shared 2 · (0.6 u)² is left out."""
    found = compare_results(with_budget("a", 0.6), with_budget("b", 0.6))
    of_j2 = found.maps[1]
    assert of_j2.u_mdeg[0, 0] == pytest.approx(0.4 * math.sqrt(2.0 - 2.0 * 0.36))
    assert of_j2.u_mdeg[0, 1] == pytest.approx(0.4 * math.sqrt(2.0))
    np.testing.assert_allclose(of_j2.first_u_mdeg, 0.4)
    assert "of the difference: runout of J2, as both" in found.remarks[0]


INDEX = {"name": "index of J2", "kind": "angle", "value_mdeg": 0.5, "correlation": "common", "axis": "j2"}


@pytest.mark.parametrize("entry", [SCALE, INDEX])
def test_an_error_common_to_one_measurement_is_not_shared(entry: dict[str, Any]) -> None:
    """It makes 2 µm of the 3 µm of L1: another day it has another value."""
    found = compare_results(*(with_budget(run, 0.6, [RADIAL, entry]) for run in ("a", "b")))
    assert [one.u for one in found.values] == pytest.approx([math.hypot(u, u) for u in (0.003, 0.004)])


def of_laser(run: str, interferometer: str | None) -> Result:
    """Return a result whose laser has moved L1 by 2 µm of its u of 3 µm."""
    made = with_budget(run, 0.0)
    assert made.covariance is not None
    moved = np.zeros((10, 1))
    moved[0, 0] = 0.002
    part = TakenUpPart(contributor=1, matrix=moved.tolist())
    return made.model_copy(
        update={
            "covariance": made.covariance.model_copy(update={"taken_up": [part]}),
            "provenance": made.provenance.model_copy(update={"interferometer": interferometer}),
        }
    )


@pytest.mark.parametrize(
    ("first", "second", "shared"),
    [("XL-80 K123", "XL-80 K123", True), ("XL-80 K123", "XL-80 K124", False), (None, None, False)],
)
def test_one_laser_errs_alike(first: str | None, second: str | None, shared: bool) -> None:
    found = compare_results(of_laser("a", first), of_laser("b", second))
    variance = 2.0 * (3.0**2 - 2.0**2) if shared else 2.0 * 3.0**2
    assert found.values[0].u == pytest.approx(1e-3 * math.sqrt(variance))
    assert ("wavelength, as both" in found.remarks[0]) == shared


def test_opposite_effects_of_one_source_add_up() -> None:
    found = compare_results(with_budget("a", 0.6), with_budget("b", -0.6))
    assert found.maps[1].u_mdeg[0, 0] == pytest.approx(0.4 * math.sqrt(2.0 + 2.0 * 0.36))


def test_another_stated_error_is_not_the_same_one() -> None:
    other = with_budget("b", 0.6, [{**RADIAL, "value_um": 3.0}, {**SCALE, "value_ppm": 0.2}])
    found = compare_results(with_budget("a", 0.6), other)
    np.testing.assert_allclose(found.maps[1].u_mdeg, 0.4 * math.sqrt(2.0))
    assert "independent" in found.remarks[0]


def test_maps_without_a_common_angle_are_refused() -> None:
    far = result("b", theta2_map=table([60.0, 80.0], [1.0, 3.0], [5.0, 7.0], 0.4))
    with pytest.raises(UsageError, match="J2 have no angle in common: 0°…20° and 60°…80°"):
        compare_results(result("a"), far)


def test_command_as_table_and_json(tmp_path: Path) -> None:
    files = [tmp_path / "a.json", tmp_path / "b.json"]
    second = result("b", link1_mm=estimate(325.03, 0.004))
    for file, one in zip(files, (result("a"), second), strict=True):
        file.write_text(one.model_dump_json(exclude_none=True), encoding="utf-8")
    names = [str(file) for file in files]
    done = CliRunner().invoke(cli, ["compare", *names])
    assert done.exit_code == 0
    row = next(line.split() for line in done.stdout.splitlines() if line.startswith("L1"))
    assert row == ["L1", "mm", "325.0100", "325.0300", "+0.0200", "0.0100", "+4.00"]
    # Two links, four nodes of each joint, x and y of a reflector; L1 alone is beyond two.
    assert "11 of 12 differences lie within 2" in done.stderr
    assert "+4.0 u, L1" in done.stderr
    facts = json.loads(CliRunner().invoke(cli, ["compare", *names, "--json"]).stdout)
    assert facts["values"][0]["normalised"] == pytest.approx(4.0)
    assert (facts["within_2u"], facts["compared"]) == (11, 12)
    assert facts["maps"][0]["positive"]["first_mdeg"] == pytest.approx([2.0, 4.0])
