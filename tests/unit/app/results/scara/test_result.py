"""Result JSON: there and back, refusal of what is no result; files written whole or not at all."""

import json
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from catseye.app.errors import StorageError, UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.results.scara.identified_arm import arm_of
from catseye.app.results.scara.result import Fit, Result, read_result, result_text, write_result
from catseye.app.results.scara.result_of import result_of
from catseye.calibration.scara.identification import IdentifiedArm
from tests.unit.app.results.scara import sample
from tests.unit.calibration.scara.paper import (
    MDEG,
    NODES1_DEG,
    paper_points,
    random_truth,
)
from tests.unit.calibration.scara.samples import identified


@cache
def result(model: str = "error-map") -> Result:
    points = paper_points(random_truth(3), sigma_mm=0.0156)
    found = identified(points, "conventional" if model == "conventional" else "error-map")
    return result_of(found, (325.0, 225.0), ["run-1"], "catseye 0", "2026-01-02T03:04:05+00:00")


@pytest.mark.parametrize("model", ["conventional", "error-map"])
def test_a_result_is_read_as_it_was_written(tmp_path: Path, model: str) -> None:
    write_result(result(model), tmp_path / "r.json")
    assert read_result(tmp_path / "r.json") == result(model)


def test_units_and_names_are_those_of_the_format() -> None:
    document, truth = json.loads(result_text(result())), random_truth(3)
    assert document["format"] == "catseye-result/1"
    assert document["gauge"] == "mean of theta1 map = 0"
    assert document["link1_mm"]["value"] == pytest.approx(truth.link1_mm, abs=1e-9)
    assert document["theta1_map"]["node_deg"] == NODES1_DEG
    for name, table in (("theta1_map", truth.map1), ("theta2_map", truth.map2)):
        for key, sign in (("positive_mdeg", 1), ("negative_mdeg", -1)):
            assert document[name][key] == pytest.approx([v / MDEG for v in table[sign]], abs=1e-6)
            assert all(u > 0.3 for u in document[name][f"u_{key}"])
    assert document["reflectors"][1]["name"] == "P2"
    assert document["reflectors"][1]["x_mm"]["value"] == pytest.approx(truth.reflectors[1, 0], abs=1e-6)
    assert document["dead_paths"][2]["reflector"] == "P3"
    assert (document["fit"]["n_points"], document["fit"]["n_parameters"]) == (1056, 48)
    assert document["fit"]["dof"] == 1056 - 48
    assert "theta20_mdeg" not in document


def test_the_conventional_model_has_an_offset_and_no_maps() -> None:
    document = json.loads(result_text(result("conventional")))
    assert set(document["theta20_mdeg"]) == {"value", "u"}
    assert "theta1_map" not in document
    assert len(document["covariance"]["matrix"]) == 3


def without(*path: str) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        for key in path[:-1]:
            document = document[key]
        del document[path[-1]]

    return change


def replaced(value: object, *path: str) -> Callable[[Any], None]:
    def change(document: Any) -> None:
        for key in path[:-1]:
            document = document[key]
        document[path[-1]] = value

    return change


@pytest.mark.parametrize(
    ("change", "part"),
    [
        (without("link1_mm"), "link1_mm: Field required"),
        (replaced("catseye-result/2", "format"), "format"),
        (replaced("spline", "model"), "model"),
        (replaced(math.nan, "link1_mm", "value"), "link1_mm.value"),
        (replaced("long", "link2_mm", "u"), "link2_mm.u"),
        (replaced([0.0], "theta1_map", "positive_mdeg"), "theta1_map"),
        (without("theta2_map", "node_deg"), "theta2_map.node_deg"),
        (replaced([1.0, 2.0], "residuals", "residual_um"), "residuals"),
        (replaced(-0.001, "link1_mm", "u"), "link1_mm.u"),
        (replaced(-325.0, "nominal", "link1_mm"), "nominal.link1_mm"),
        (replaced([[math.nan]], "covariance", "matrix"), "covariance.matrix.0.0"),
    ],
)
def test_a_file_with_invalid_content_names_the_key(
    tmp_path: Path, change: Callable[[Any], None], part: str
) -> None:
    document = json.loads(result_text(result()))
    change(document)
    path = tmp_path / "r.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(UsageError) as caught:
        read_result(path)
    assert f"{path}: is not a catseye-result/1 file" in str(caught.value)
    assert part in str(caught.value)


def test_keys_of_later_versions_are_left_aside(tmp_path: Path) -> None:
    document = {**json.loads(result_text(result())), "colour": "blue"}
    (tmp_path / "r.json").write_text(json.dumps(document), encoding="utf-8")
    assert read_result(tmp_path / "r.json") == result()


def changed_arm(change: Callable[[Any], None]) -> IdentifiedArm:
    document = json.loads(result_text(result()))
    change(document)
    return arm_of(Result.model_validate(document))


def shortened(document: Any) -> None:
    document["covariance"]["matrix"][3].pop()


def negative(document: Any) -> None:
    document["covariance"]["matrix"][0][0] = -1.0


def lopsided(document: Any) -> None:
    document["covariance"]["matrix"][0][1] = 5.0


def exchanged(document: Any) -> None:
    document["covariance"]["names"].reverse()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (shortened, "is not that of its 40 parameters"),
        (exchanged, "is not that of its 40 parameters"),
        (negative, "some variances are negative"),
        (lopsided, "not symmetric"),
        (replaced(0.325, "link1_mm", "value"), "link1_mm of the result is 0.325 and nominal.link1_mm 325"),
        (replaced(425.0, "nominal", "link2_mm"), "they are not of one arm in mm"),
    ],
)
def test_an_arm_that_cannot_be_is_refused(change: Callable[[Any], None], text: str) -> None:
    with pytest.raises(UsageError, match=text):
        changed_arm(change)


def test_a_byte_order_mark_is_skipped_and_utf_16_refused(tmp_path: Path) -> None:
    text, path = result_text(result()), tmp_path / "r.json"
    path.write_bytes(text.encode("utf-8-sig"))
    assert read_result(path) == result()
    path.write_bytes(text.encode("utf-16"))
    with pytest.raises(
        UsageError, match="cannot be read: it is not UTF-8 text, so no result of catseye identify"
    ):
        read_result(path)


def test_files_that_cannot_be_read_are_reported(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no such file"):
        read_result(tmp_path / "none.json")
    with pytest.raises(UsageError, match="cannot be read"):
        read_result(tmp_path)
    (tmp_path / "r.json").write_bytes(b"\xff\xfe")
    with pytest.raises(UsageError, match="cannot be read"):
        read_result(tmp_path / "r.json")
    (tmp_path / "r.json").write_text('{"format": ', encoding="utf-8")
    with pytest.raises(UsageError, match="Invalid JSON"):
        read_result(tmp_path / "r.json")


def test_a_file_is_written_whole_over_an_old_one(tmp_path: Path) -> None:
    path = tmp_path / "r.txt"
    path.write_text("old and longer", encoding="utf-8")
    write_atomically(path, "µm\n")
    assert path.read_bytes() == b"\xc2\xb5m\n"
    assert [p.name for p in tmp_path.iterdir()] == ["r.txt"]


@pytest.mark.parametrize("name", ["absent/r.txt", "folder", "x" * 300])
def test_a_place_that_takes_no_file_leaves_nothing_behind(tmp_path: Path, name: str) -> None:
    (tmp_path / "folder").mkdir()
    with pytest.raises(StorageError, match=r"cannot be written: .*check the folder"):
        write_atomically(tmp_path / name, "text")
    assert [p.name for p in tmp_path.rglob("*")] == ["folder"]


def test_a_disk_that_refuses_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "r.txt"
    path.write_text("old", encoding="utf-8")

    def refuse(_fd: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", refuse)
    with pytest.raises(StorageError, match=r"r\.txt: cannot be written: No space left"):
        write_atomically(path, "new")
    assert path.read_text(encoding="utf-8") == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["r.txt"]


ROBUST = {"loss": "huber", "sigma_um": 12.0, "half": 2.69, "counted_little": 3}


@pytest.mark.parametrize(
    ("factor", "changes", "ratio", "row_mm2"),
    [
        (4.0, {"chi2_reduced": 4.0}, 4.0, None),
        (1.44e-4, {}, 1.0, 1.44e-4),
        (2.25, {"robust": ROBUST}, 2.25, None),
        (1.44e-4, {"robust": ROBUST}, 1.0, 1.44e-4),
    ],
)
def test_a_variance_factor_of_earlier_files_is_read(
    factor: float, changes: dict[str, object], ratio: float, row_mm2: float | None
) -> None:
    # 12 µm of scatter: 1.44e-4 mm² where no uncertainty was stated.
    earlier = sample.fit(chi2=None).model_dump(exclude={"variance_ratio", "row_variance_mm2"})
    found = Fit.model_validate(earlier | {"sigma0_um": 12.0, "variance_factor": factor} | changes)
    assert (found.variance_ratio, found.row_variance_mm2) == (ratio, row_mm2)


def with_taken_up(change: Callable[[list[dict[str, Any]]], object]) -> Result:
    """Return a result with what its parameters have taken up of two contributors, changed."""
    document = json.loads(result_text(result()))
    rows = len(document["covariance"]["names"])
    document["budget"] = {
        "source": "cell",
        "name": "cell.toml",
        "contributor": [
            {"name": "wavelength", "kind": "scale", "value_ppm": 1.5, "correlation": "common"},
            {"name": "noise", "kind": "length", "value_um": 5.0},
            {
                "name": "J2",
                "kind": "radial",
                "value_um": 5.0,
                "correlation": "axis-angle",
                "axis": "j2",
                "orders": 3,
            },
        ],
    }
    parts = [
        {"contributor": 0, "matrix": [[0.1]] * rows},
        {"contributor": 2, "matrix": [[0.1] * 12] * rows},
    ]
    change(parts)
    document["covariance"]["taken_up"] = parts
    return Result.model_validate(document)


def test_what_parameters_have_taken_up_is_read() -> None:
    found = arm_of(with_taken_up(lambda _: None))
    assert {one.name: moved.shape[1] for one, moved in found.taken_up.items()} == {"wavelength": 1, "J2": 12}


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (
            lambda parts: parts[1].update(matrix=parts[1]["matrix"][1:]),
            r"taken_up\[1\].*J2.*rows of 12 numbers",
        ),
        (
            lambda parts: parts[1].update(matrix=[[0.1] * 11] * len(parts[1]["matrix"])),
            r"taken_up\[1\] of the result, of J2, has to be .* rows of 12 numbers",
        ),
        (
            lambda parts: parts[0].update(matrix=[[0.1, 0.2], *parts[0]["matrix"][1:]]),
            r"taken_up\[0\] of the result, of wavelength, has to be .* rows of 1 numbers",
        ),
        (lambda parts: parts[0].update(contributor=1), r"taken_up\[0\] of the result is of noise"),
        (
            lambda parts: parts[1].update(contributor=7),
            r"taken_up\[1\] of the result belongs to no contributor",
        ),
        (lambda parts: parts.append(parts[0]), r"taken_up\[2\] of the result is of wavelength.*twice"),
    ],
)
def test_damage_of_what_was_taken_up_is_located(
    change: Callable[[list[dict[str, Any]]], object], text: str
) -> None:
    with pytest.raises(UsageError, match=text):
        arm_of(with_taken_up(change))
