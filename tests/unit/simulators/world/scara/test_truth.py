"""The true arm: plausible when drawn, exact when read, refused with a clear text when wrong."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from catseye.simulators.config import EmulationConfig, TruthText
from catseye.simulators.errors import TruthFileError
from catseye.simulators.world.scara.axis_errors import JointMap
from catseye.simulators.world.scara.truth import TrueArm, draw_truth, true_arm, truth_document
from tests.unit.simulators.benches import QUIET

MINIMAL = {
    "format": "catseye-result/1",
    "link1_mm": {"value": 324.964, "u": 0.002},
    "link2_mm": {"value": 225},
    "theta1_map": {"node_deg": [-10, 10], "positive_mdeg": [1, 2], "negative_mdeg": [3, 4]},
    "theta2_map": {"node_deg": [0], "positive_mdeg": [5], "negative_mdeg": [6]},
}


def written(tmp_path: Path, document: object) -> Path:
    path = tmp_path / "truth.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def equal(a: JointMap, b: JointMap) -> bool:
    pairs = ((a.nodes_rad, b.nodes_rad), (a.positive_rad, b.positive_rad), (a.negative_rad, b.negative_rad))
    return all(np.allclose(first, second, rtol=0.0, atol=1e-15) for first, second in pairs)


def test_a_drawn_arm_is_plausible() -> None:
    arms = [draw_truth(seed, QUIET) for seed in range(200)]
    links = np.array([(arm.link1_mm - 325.0, arm.link2_mm - 225.0) for arm in arms])
    assert np.std(links) == pytest.approx(0.03, rel=0.15)
    offsets = np.rad2deg([arm.theta40_rad for arm in arms])
    assert np.std(offsets) == pytest.approx(1.0, rel=0.2)
    shifts = np.array([np.subtract(arm.reflectors["P2"], (680.0, 0.0)) for arm in arms])
    assert np.std(shifts) == pytest.approx(3.0, rel=0.15)


@pytest.mark.parametrize("name", ["theta1_map", "theta2_map"])
def test_drawn_maps_cover_the_limits_with_realistic_size(name: str) -> None:
    for seed in range(20):
        table: JointMap = getattr(draw_truth(seed, QUIET), name)
        limits = QUIET.limits[0] if name == "theta1_map" else QUIET.limits[1]
        nodes_deg = np.rad2deg(table.nodes_rad)
        assert (nodes_deg[0], nodes_deg[-1]) == pytest.approx(limits)
        assert np.diff(nodes_deg) == pytest.approx(1.0)
        backlash_mdeg = 1e3 * np.rad2deg(table.negative_rad - table.positive_rad)
        assert np.min(backlash_mdeg) >= 18.0
        assert np.max(backlash_mdeg) <= 24.0
        assert 20.0 < np.ptp(1e3 * np.rad2deg(table.positive_rad)) < 65.0


def read(path: Path, config: EmulationConfig) -> TrueArm:
    return true_arm(TruthText(path.read_bytes(), str(path)), config)


def test_the_seed_decides() -> None:
    assert truth_document(draw_truth(7, QUIET)) == truth_document(draw_truth(7, QUIET))
    assert truth_document(draw_truth(7, QUIET)) != truth_document(draw_truth(8, QUIET))


def test_a_written_arm_is_read_back(tmp_path: Path) -> None:
    drawn = draw_truth(7, QUIET)
    path = tmp_path / "truth.json"
    path.write_text(json.dumps(truth_document(drawn)), encoding="utf-8")
    found = read(path, replace(QUIET, seed=99))
    assert (found.link1_mm, found.link2_mm) == (drawn.link1_mm, drawn.link2_mm)
    assert equal(found.theta1_map, drawn.theta1_map)
    assert equal(found.theta2_map, drawn.theta2_map)
    assert found.reflectors == drawn.reflectors
    assert found.theta40_rad == pytest.approx(drawn.theta40_rad)


def test_what_the_file_leaves_out_is_drawn(tmp_path: Path) -> None:
    found = read(written(tmp_path, MINIMAL), QUIET)
    drawn = draw_truth(QUIET.seed, QUIET)
    assert (found.link1_mm, found.link2_mm) == (324.964, 225.0)
    assert found.reflectors == drawn.reflectors
    assert found.theta40_rad == drawn.theta40_rad
    assert 1e3 * np.rad2deg(found.theta2_map.negative_rad) == pytest.approx([6.0])


def test_a_conventional_result_becomes_constant_maps(tmp_path: Path) -> None:
    document = {key: MINIMAL[key] for key in ("format", "link1_mm", "link2_mm")}
    found: TrueArm = read(written(tmp_path, {**document, "theta20_mdeg": {"value": -5.55}}), QUIET)
    for table, mdeg in ((found.theta1_map, 0.0), (found.theta2_map, -5.55)):
        assert 1e3 * np.rad2deg(table.positive_rad) == pytest.approx([mdeg])
        assert 1e3 * np.rad2deg(table.negative_rad) == pytest.approx([mdeg])


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"format": "catseye-result/2"}, "format"),
        ({"link1_mm": {"value": "325"}}, "link1_mm.value"),
        ({"link1_mm": {"value": -1.0}}, "link1_mm.value"),
        ({"link2_mm": 225.0}, "link2_mm"),
        ({"theta2_map": None}, "theta2_map"),
        (
            {"theta1_map": {"node_deg": [1, 0], "positive_mdeg": [0, 0], "negative_mdeg": [0, 0]}},
            "theta1_map",
        ),
        ({"theta1_map": {"node_deg": [0, 1], "positive_mdeg": [0], "negative_mdeg": [0, 0]}}, "theta1_map"),
        ({"theta1_map": {"node_deg": [0], "positive_mdeg": [0]}}, "theta1_map.negative_mdeg"),
        ({"reflectors": [{"name": "P1", "x_mm": {"value": 1}}]}, "reflectors.0.y_mm"),
        ({"theta40_deg": "1"}, "theta40_deg"),
    ],
)
def test_a_wrong_file_is_refused_with_its_name_and_key(
    tmp_path: Path, change: dict[str, object], key: str
) -> None:
    path = written(tmp_path, {**MINIMAL, **change})
    with pytest.raises(TruthFileError) as caught:
        read(path, QUIET)
    assert str(caught.value).startswith(f"{path}: {key}: ")


@pytest.mark.parametrize("content", [b"", b"[]", b"\xff\xfe", b'{"format": '])
def test_what_is_no_document_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "truth.json"
    path.write_bytes(content)
    with pytest.raises(TruthFileError, match=str(path)):
        read(path, QUIET)
