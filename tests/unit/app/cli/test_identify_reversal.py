"""identify with a table of two mountings of the interferometer."""

import json
import math
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from catseye.app.cli.report import report
from catseye.app.cli.scara.identify import identify
from catseye.app.results.scara import scan
from catseye.app.results.scara.identification_report import identification_report
from catseye.app.results.scara.plausible import ImplausibleError
from catseye.app.results.scara.result import Result, read_result
from catseye.calibration.scara.points import Points
from tests.unit.app.cli.distances import write_points
from tests.unit.calibration.scara.paper import random_truth
from tests.unit.calibration.scara.reversal import HALF_TURN, AxisMotion, mounted

MOTION = AxisMotion.drawn(np.random.default_rng(3), 0.03, 0.005)
TRUTH = random_truth(3)


@pytest.fixture(scope="module")
def points() -> Points:
    return mounted(TRUTH, MOTION.longer, [0.0, HALF_TURN], 0.010, 3)


def identified(points: Points, folder: Path) -> Result:
    identify(folder / "result.json", [], write_points(points, folder), folder / "cell.toml")
    return read_result(folder / "result.json")


@pytest.fixture(scope="module")
def result_file(points: Points, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Identify once; return the result, beside which stands what was said."""
    folder = tmp_path_factory.mktemp("identified")
    table = write_points(points, folder)
    with (folder / "said.json").open("w", encoding="utf-8") as said, redirect_stdout(said):
        identify(folder / "result.json", [], table, folder / "cell.toml", as_json=True)
    return folder / "result.json"


@pytest.fixture(scope="module")
def result(result_file: Path) -> Result:
    return read_result(result_file)


def test_result_states_the_orders_of_j4_with_their_uncertainty(result: Result) -> None:
    found = result.j4_orders
    assert found is not None
    assert [one.order for one in found] == [2, 4, 6]
    for one in found:
        cosine, sine = MOTION.along_first_beam(one.order)
        assert abs(one.cosine_um.value - 1e3 * cosine) < 4.0 * one.cosine_um.u
        assert abs(one.sine_um.value - 1e3 * sine) < 4.0 * one.sine_um.u
        assert one.amplitude_um.value == pytest.approx(np.hypot(one.cosine_um.value, one.sine_um.value))
        assert 0.1 < one.amplitude_um.u < 1.0


def test_json_shows_them(result_file: Path) -> None:
    document = json.loads((result_file.parent / "said.json").read_text(encoding="utf-8"))
    assert [one["order"] for one in document["j4_orders"]] == [2, 4, 6]


def test_text_and_page_show_them(result: Result, result_file: Path, tmp_path: Path) -> None:
    assert result.j4_orders is not None
    verdict = identification_report(result).sections[0]
    second = result.j4_orders[0].amplitude_um
    assert f"{second.value:.2f} ± {2.0 * second.u:.2f} µm (k = 2) in order 2" in str(verdict)
    report([str(result_file)], tmp_path / "page.html")
    assert "What J4 adds to a distance" in (tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_table_of_one_mounting_states_none(tmp_path: Path) -> None:
    result = identified(mounted(TRUTH, MOTION.longer, [0.0], 0.010, 3), tmp_path)
    assert result.j4_orders is None
    assert "turned on J4" not in str(identification_report(result))


def test_a_scan_of_two_mountings_gives_the_same_arm(
    points: Points, result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scan, "SCAN_ROWS", 100)
    monkeypatch.setattr(scan, "_SHORTEST_LINE_BYTES", 1)
    streamed = identified(points, tmp_path)
    assert streamed.scan is not None
    assert streamed.link2_mm.value == pytest.approx(result.link2_mm.value, abs=1e-6)
    assert streamed.link2_mm.u == pytest.approx(result.link2_mm.u, rel=1e-6)
    assert streamed.j4_orders is not None
    assert result.j4_orders is not None
    for scans, table in zip(streamed.j4_orders, result.j4_orders, strict=True):
        assert (scans.contributor, scans.order) == (table.contributor, table.order)
        found = [(part.amplitude_um.value, part.amplitude_um.u) for part in (scans, table)]
        assert found[0] == pytest.approx(found[1], rel=1e-6)


def test_a_forgotten_column_is_refused_with_what_to_state(points: Points, tmp_path: Path) -> None:
    with pytest.raises(
        ImplausibleError, match=r"from distance 1057 on \(P1, segment 1\).* state mount_deg = 180"
    ):
        identified(replace(points, mount_rad=None), tmp_path)


@pytest.mark.parametrize(
    ("factor", "text"),
    [
        (math.radians(1.0), r"mount_deg = 3\.1\d+ seems to be in radians .* convert it to degrees, 18\d\.\d"),
        (170.0 / 180.0, r"turned by about 18\d° on J4's flange, not by mount_deg = 17\d\.?\d*: correct it"),
    ],
)
def test_a_wrong_mounting_is_refused_with_what_is_wrong(
    points: Points, tmp_path: Path, factor: float, text: str
) -> None:
    assert points.mount_rad is not None
    with pytest.raises(ImplausibleError, match=text):
        identified(replace(points, mount_rad=factor * points.mount_rad), tmp_path)
