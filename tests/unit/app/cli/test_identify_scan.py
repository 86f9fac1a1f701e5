"""identify with a points file that is streamed: the same result file as without streaming."""

import importlib
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.scara.identify import identify
from catseye.app.errors import UsageError
from catseye.app.results.scara import scan as scan_identifying
from catseye.app.results.scara.identified_arm import arm_of
from catseye.app.results.scara.result import Result, read_result
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.scans.scan import NAMES, arm, scan

ROWS = 9_000
TRUTH = arm(2, 20.0)


def columns(points: Points) -> dict[str, list[object]]:
    assert points.sigma_mm is not None
    return {
        "reflector": [NAMES[i] for i in points.reflector],
        "segment": [points.dead_paths[i][1] for i in points.dead_path],
        "theta1_deg": np.rad2deg(points.commands.theta1_rad).tolist(),
        "theta2_deg": np.rad2deg(points.commands.theta2_rad).tolist(),
        "direction1": points.commands.direction1.tolist(),
        "direction2": points.commands.direction2.tolist(),
        "displacement_mm": points.displacement_mm.tolist(),
        "sigma_mm": points.sigma_mm.tolist(),
    }


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scan")
    (path / "cell.toml").write_text(TEMPLATE, encoding="utf-8")
    table = columns(scan(TRUTH, ROWS, noise_mm=0.01, sigma_mm=0.01))
    lines = [",".join(table), *(",".join(map(str, row)) for row in zip(*table.values(), strict=True))]
    (path / "points.csv").write_text("\n".join(lines) + "\n")
    arrow, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    parquet.write_table(arrow.table(table), path / "points.parquet")
    return path


def identified(folder: Path, name: str, **options: Any) -> Result:
    output = folder / "result.json"
    identify(output, [], folder / name, folder / "cell.toml", **options)
    return read_result(output)


def test_streamed_or_not_the_result_file_is_the_same(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = identified(folder, "points.csv")
    assert whole.scan is None
    monkeypatch.setattr(scan_identifying, "SCAN_ROWS", 5_000)
    capsys.readouterr()
    streamed = identified(folder, "points.csv")
    said = capsys.readouterr()
    a, b = arm_of(streamed), arm_of(whole)
    assert a.layout.names() == b.layout.names()
    # 1e-9 mm, angles at full reach.
    assert a.parameters[:2] == pytest.approx(b.parameters[:2], abs=1e-9, rel=0.0)
    assert 550.0 * a.parameters[2:] == pytest.approx(550.0 * b.parameters[2:], abs=1e-9, rel=0.0)
    assert a.covariance == pytest.approx(b.covariance, rel=1e-6, abs=1e-18)
    for name in ("n_points", "n_parameters", "dof", "rejected", "null_directions"):
        assert getattr(streamed.fit, name) == getattr(whole.fit, name)
    for name in ("rms_um", "sigma0_um", "chi2_reduced", "chi2_probability", "variance_ratio"):
        assert getattr(streamed.fit, name) == pytest.approx(getattr(whole.fit, name), rel=1e-7)
    assert streamed.drift is not None
    assert whole.drift is not None
    assert [part.contributor for part in streamed.drift] == [part.contributor for part in whole.drift]
    for scans, tables in zip(streamed.drift, whole.drift, strict=True):
        found = [(part.rms.value, part.rms.u, part.change.u, part.probability) for part in (scans, tables)]
        assert found[0] == pytest.approx(found[1], rel=1e-6)
    assert streamed.scan is not None
    assert streamed.scan.n_points == sum(streamed.scan.segments.n_points) == ROWS
    assert re.search(r"Streamed: 3\d\d\d of 9000 residuals", said.err)
    assert "Not tested for lack of fit: streamed distances are not searched" in said.err
    assert streamed.scan.lack_of_fit_tested is False
    assert "solving 100%" in said.err
    assert "L1" in said.out
    assert "Δθ1" not in said.out


def test_long_parquet_is_streamed_and_short_is_not(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert identified(folder, "points.parquet").scan is None
    monkeypatch.setattr(scan_identifying, "SCAN_ROWS", ROWS - 1)
    found = identified(folder, "points.parquet")
    assert found.scan is not None
    assert abs(found.link1_mm.value - TRUTH.link1_mm) < 5.0 * found.link1_mm.u


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"uncertainty": "monte-carlo"}, "--uncertainty monte-carlo"),
        ({"loss": "huber"}, "--loss huber"),
        ({"reject": 4.0}, "--reject"),
    ],
)
def test_what_needs_all_distances_at_once_is_refused(
    folder: Path, monkeypatch: pytest.MonkeyPatch, options: dict[str, Any], named: str
) -> None:
    monkeypatch.setattr(scan_identifying, "SCAN_ROWS", ROWS - 1)
    with pytest.raises(UsageError, match=named):
        identified(folder, "points.parquet", **options)


def test_short_files_and_missing_ones_are_no_scans(tmp_path: Path) -> None:
    (tmp_path / "short.csv").write_text("x" * 3_000_000)
    assert not scan_identifying.is_scan(tmp_path / "short.csv")
    assert not scan_identifying.is_scan(tmp_path / "missing.csv")
    (tmp_path / "long.csv").write_text("1234567890123456789012345\n" * 100_001)
    assert scan_identifying.is_scan(tmp_path / "long.csv")
