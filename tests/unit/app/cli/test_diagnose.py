"""diagnose: tables, sentences and JSON about distances whose faults are known."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from catseye.app.cli.diagnose import diagnose
from catseye.app.errors import UsageError
from catseye.calibration.scara.points import Points
from tests.unit.app.cli.distances import write_points
from tests.unit.calibration.scara.diagnostics.bench import Extra, commands_on_nodes, measured
from tests.unit.calibration.scara.paper import random_truth

TRUTH = random_truth(12)
WRONG_ROW = 900
"""From 0: a distance of P3 that is 0.3 mm too long."""

JUMP_ROW = 352 + 200
"""From 0: from here on the distances of P2 are 0.06 mm too long."""


@cache
def points(link1_growth_mm: float = 0.0) -> Points:
    extra = Extra(link1=lambda pose: link1_growth_mm * pose.share)
    return measured(TRUTH, commands_on_nodes(), extra, 0.01, 0.01, seed=5)


def faulty() -> Points:
    displacement = points().displacement_mm.copy()
    displacement[WRONG_ROW] += 0.3
    displacement[JUMP_ROW:704] += 0.06
    return replace(points(), displacement_mm=displacement)


def output_of(
    folder: Path, given: Points, capsys: pytest.CaptureFixture[str], *, as_json: bool = False
) -> tuple[str, str]:
    file = write_points(given, folder)
    # The distances have no error but those that they state.
    diagnose([], file, folder / "cell.toml", None, as_json, budget="none")
    said = capsys.readouterr()
    return said.out, said.err


def document(folder: Path, given: Points, capsys: pytest.CaptureFixture[str]) -> Any:
    return json.loads(output_of(folder, given, capsys, as_json=True)[0])


def findings(text: str, sign: str) -> list[str]:
    return [line.removeprefix(sign) for line in text.splitlines() if line.startswith(sign)]


def test_nothing_speaks_against_a_sound_measurement(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, progress = output_of(tmp_path, points(), capsys)
    assert findings(text, "✗ ") == []
    good = findings(text, "✓ ")
    assert good[0].startswith("The error map leaves ")
    assert "agrees with the stated uncertainties (χ²/dof = " in good[0]
    assert "no J1–J2 crosstalk (" in good[1]
    assert "no J4 map (" in good[1]
    assert "no thermal drift (" in good[1]
    assert any(line.startswith("No distance stands out") for line in good)
    assert any(line.startswith("No drift and no jump") for line in good)
    assert any(line.startswith("Keep the nodes") for line in good)
    heads = [line.split()[0] for line in text.splitlines() if line.startswith(("model", "left out", "nodes"))]
    assert heads == ["model", "model", "left", "nodes"]
    assert "diagnose 100%" in progress


def test_faults_are_found_where_they_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, _ = output_of(tmp_path, faulty(), capsys)
    look = findings(text, "✗ ")
    assert "that exceeds the stated uncertainties" in look[0]
    outliers = next(line for line in look if "stand out" in line)
    assert f"row {WRONG_ROW + 1} (reflector P3, segment 0," in outliers
    assert "catseye identify --reject" in outliers
    jump = next(line for line in look if line.startswith("Jump"))
    assert "in segment 0 of reflector P2 the measured distance steps by +" in jump
    assert f"at its distance 201 (row {JUMP_ROW + 1})" in jump
    assert "a segment of its own" in jump


def test_json_holds_the_same_faults_as_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = document(tmp_path, faulty(), capsys)
    assert found["sources"] == ["points.csv"]
    assert found["outliers"]["distances"][0]["row"] == WRONG_ROW + 1
    assert found["outliers"]["most_influential"]["row"] == WRONG_ROW + 1
    # Predicted minus measured; the distance itself pulls the fit a little.
    assert found["outliers"]["distances"][0]["residual_um"] == pytest.approx(-300.0, abs=45.0)
    jump = next(one for one in found["changes"] if one["kind"] == "jump")
    assert (jump["reflector"], jump["row"], jump["within"], jump["significant"]) == ("P2", 553, 201, True)
    assert abs(jump["size_um"] - 60.0) < 4.0 * jump["u_um"] < 20.0
    kinds = [one["kind"] for one in found["findings"]]
    assert set(kinds) <= {"good", "bad", "note"}
    assert kinds[0] == "bad"
    assert found["fit"]["n_points"] == 1056
    # Links, maps of 22 and 16 values, three places, three dead paths, less the gauge.
    assert found["fit"]["n_parameters"] == 2 + 22 + 16 + 6 + 3 - 1


def test_growing_links_are_a_finding_with_their_size(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = document(tmp_path, points(0.05), capsys)
    models = {one["name"]: one for one in found["models"]}
    assert list(models)[:5] == ["conventional", "error map", "J1–J2 crosstalk", "J4 map", "thermal drift"]
    thermal = models["thermal drift"]
    assert thermal["significant"]
    growth = thermal["terms"][0]
    assert (growth["name"], growth["unit"]) == ("ΔL1 t", "um")
    assert abs(growth["value"] - 50.0) < 4.0 * growth["u"] < 20.0
    assert thermal["n_parameters"] == models["error map"]["n_parameters"] + 2
    models_finding = next(one for one in found["findings"] if "thermal drift adds" in one["text"])
    assert models_finding["kind"] == "bad"
    ways = {one["left_out"]: one for one in found["cross_validation"]}
    assert set(ways) == {"reflector", "sweep"}
    assert [fold["name"] for fold in ways["reflector"]["folds"]] == [f"reflector P{i}" for i in (1, 2, 3)]
    assert found["nodes"]["grids"][0]["n_parameters"] == 48


def test_without_stated_uncertainties_nothing_is_compared_with_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, _ = output_of(tmp_path, replace(points(), sigma_mm=None), capsys)
    first = findings(text, "The error map leaves ")[0]
    assert first.endswith("no uncertainty is stated that this could be compared with.")


@pytest.mark.parametrize("both", [True, False])
def test_runs_or_points_but_not_both_or_none(tmp_path: Path, both: bool) -> None:
    file = write_points(points(), tmp_path) if both else None
    with pytest.raises(UsageError, match="either runs, or --points FILE with --cell FILE"):
        diagnose(["1a2b"] if both else [], file, None, None, as_json=False)


def test_points_need_a_cell_file(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="--points needs --cell FILE"):
        diagnose([], write_points(points(), tmp_path), None, None, as_json=False)


def test_long_tables_are_announced_with_what_they_take(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "at once" not in output_of(tmp_path, points(), capsys)[1]
    monkeypatch.setattr("catseye.app.cli.diagnose.LONG_TABLE", 500)
    said = output_of(tmp_path, points(), capsys)[1].splitlines()
    (announced,) = [number for number, line in enumerate(said) if "at once" in line]
    assert said[announced] == (
        "diagnose takes all 1056 distances at once: about 6 MB of memory, and as long as the line below says; every "
        "tenth row as a table of its own does where that is too much"
    )
    assert said[announced + 1].startswith("diagnose  ")
    assert " gone, " in said[announced + 1]
