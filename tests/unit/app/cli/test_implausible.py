"""No implausible result is written: it is refused with the likely mistake, or kept for a reason that it states."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.diagnose import diagnose
from catseye.app.cli.scara.identify import identify
from catseye.app.errors import UsageError, exit_code_of
from catseye.app.exitcode import ExitCode
from catseye.app.render.text import report_text
from catseye.app.results.scara.identification_report import identification_report
from catseye.app.results.scara.plausible import ImplausibleError
from catseye.app.results.scara.points import COLUMNS
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.run_report import result_file_report
from catseye.app.results.scara.scan import identify_scan_file
from catseye.app.results.scara.stated_budget import budget_of_table
from tests.unit.calibration.scara.paper import NAMES
from tests.unit.calibration.scara.plausibility.tables import MISTAKES, Table, measured


def written(table: Table, folder: Path) -> tuple[Path, Path]:
    """Write a points file and the cell file that belongs to it."""
    cell = TEMPLATE
    for (name, x, y), place in zip(
        (("P1", 650.0, -400.0), ("P2", 680.0, 0.0), ("P3", 640.0, 380.0)), table.rough_mm, strict=True
    ):
        old = f'name = "{name}"\nx_mm = {x}\ny_mm = {y}'
        assert old in cell
        cell = cell.replace(old, f'name = "{name}"\nx_mm = {float(place[0])!r}\ny_mm = {float(place[1])!r}')
    for number, (nominal, link) in enumerate(zip((325.0, 225.0), table.links_mm, strict=True), 1):
        assert f"link{number}_mm = {nominal}" in cell
        cell = cell.replace(f"link{number}_mm = {nominal}", f"link{number}_mm = {link!r}")
    (folder / "cell.toml").write_text(cell, encoding="utf-8")
    rows = zip(
        [NAMES[place] for place in table.reflector],
        table.segment.tolist(),
        *table.theta_deg.T.tolist(),
        *table.direction.T.tolist(),
        table.displacement.tolist(),
        strict=True,
    )
    lines = [",".join(COLUMNS), *(",".join(map(str, row)) for row in rows)]
    (folder / "points.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder / "points.csv", folder / "cell.toml"


def run(table: Table, folder: Path, **options: Any) -> Path:
    points, cell = written(table, folder)
    identify(folder / "r.json", [], points, cell, **options)
    return folder / "r.json"


def scaled(factor: float) -> Callable[[Table], Table]:
    return lambda table: replace(table, displacement=factor * table.displacement)


TEXTS: dict[str, tuple[Callable[[Table], Table], str]] = {
    "sign of θ1": (MISTAKES["sign of θ1"], "the sign of θ1 is reversed"),
    "sign of θ2": (MISTAKES["sign of θ2"], "the sign of θ2 is reversed"),
    "sign of both": (MISTAKES["sign of both"], "the sign of θ1 and θ2 is reversed"),
    "sign of the displacement": (MISTAKES["sign of the displacement"], "sign of displacement_mm is reversed"),
    "radians": (MISTAKES["radians for degrees"], "θ1 and θ2 seem to be in radians"),
    "metres": (scaled(1e-3), "seems to be in m: convert it to mm"),
    "centimetres": (scaled(0.1), "seems to be in cm: convert it to mm"),
    "inches": (scaled(1.0 / 25.4), "seems to be in inches: convert it to mm"),
    "micrometres": (scaled(1e3), "seems to be in µm: convert it to mm"),
    "mm for inches": (scaled(25.4), "seems to be in mm that were taken for inches"),
    "counts": (MISTAKES["counts"], "seems to be in counts of λ/4"),
    "scale": (MISTAKES["a scale 5 % off"], "displacement_mm is 1.05 times as large"),
    "links exchanged": (MISTAKES["L1 and L2 exchanged"], "link1_mm and link2_mm are exchanged"),
    "other arm": (MISTAKES["links of another arm"], "those of an arm with links of 325"),
    "shifted": (MISTAKES["rows shifted by one"], "displacement_mm stands one row below"),
    "names": (MISTAKES["names exchanged"], "the reflectors P1 and P2 have each other's name"),
    "mirrored": (MISTAKES["places mirrored"], "their y has the wrong sign"),
    "zero": (
        MISTAKES["a zero lost inside a segment"],
        r"count of P2, segment 0, jumps .* between distances 523 and 524",
    ),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_mistake_is_refused_named_and_nothing_written(
    tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    mistake, text = TEXTS[name]
    with pytest.raises(ImplausibleError, match=text) as refused:
        run(mistake(measured(21)), tmp_path, as_json=True)
    assert exit_code_of(refused.value) == ExitCode.REJECTED
    assert not (tmp_path / "r.json").exists()
    facts = json.loads(capsys.readouterr().out)
    assert facts["reason"] == "implausible"
    assert facts["text"] == str(refused.value)
    assert facts["findings"] == refused.value.findings != []


def test_a_sound_table_is_identified_without_a_word_about_it(tmp_path: Path) -> None:
    assert read_result(run(measured(22), tmp_path)).implausible is None


def test_an_accepted_result_tells_reason_and_findings(tmp_path: Path) -> None:
    spoiled = MISTAKES["a scale 5 % off"](measured(23))
    result = read_result(run(spoiled, tmp_path, accept_implausible="a scaled model of the arm"))
    assert result.implausible is not None
    assert result.implausible.accepted == "a scaled model of the arm"
    assert any("1.05 times as large" in text for text in result.implausible.findings)
    for report in (identification_report(result), result_file_report(tmp_path / "r.json")):
        text = " ".join(report_text(report).split())
        assert "IMPLAUSIBLE: displacement_mm is 1.05 times as large" in text
        assert "for this reason: a scaled model of the arm" in text


def test_a_failure_without_a_mistake_cannot_be_accepted(tmp_path: Path) -> None:
    with pytest.raises(ImplausibleError, match="the sign of θ1"):
        run(MISTAKES["sign of θ1"](measured(24)), tmp_path, accept_implausible="no matter")
    assert not (tmp_path / "r.json").exists()


def test_a_reason_that_says_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="needs a reason"):
        run(measured(24), tmp_path, accept_implausible=" ")


def test_misfit_alone_widens_and_warns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = measured(29)
    noise = np.random.default_rng(2).normal(0.0, 0.2, len(table.displacement))
    result = read_result(run(replace(table, displacement=table.displacement + noise), tmp_path))
    assert result.implausible is None
    assert result.fit.variance_ratio > 4.0
    assert "more than the stated" in " ".join(capsys.readouterr().err.split())


def test_bounds_stand_in_the_cell_file(tmp_path: Path) -> None:
    table = measured(25)
    off = replace(table, rough_mm=table.rough_mm + np.array([30.0, 0.0]))
    points, cell = written(off, tmp_path)
    identify(tmp_path / "r.json", [], points, cell)
    text = cell.read_text(encoding="utf-8")
    cell.write_text(text.replace("place_mm = 100.0", "place_mm = 20.0"), encoding="utf-8")
    with pytest.raises(ImplausibleError, match=r"P1 comes out at .* place_mm = 20 is the bound"):
        identify(tmp_path / "r2.json", [], points, cell)


def streamed(points: Path, cell: Path) -> Result:
    stated = load_cell(cell).cell
    return identify_scan_file(
        points,
        scara_bench_of(stated),
        "error-map",
        lambda seen: budget_of_table(seen, stated.uncertainty, "cell.toml"),
    )


@pytest.mark.parametrize("name", ["micrometres", "scale", "mirrored", "sign of θ2"])
def test_a_streamed_file_is_judged_as_well(tmp_path: Path, name: str) -> None:
    mistake, text = TEXTS[name]
    with pytest.raises(ImplausibleError, match=text):
        streamed(*written(mistake(measured(26)), tmp_path))


def test_a_sound_streamed_file_passes(tmp_path: Path) -> None:
    assert streamed(*written(measured(27), tmp_path)).implausible is None


def test_nothing_implausible_is_diagnosed(tmp_path: Path) -> None:
    points, cell = written(scaled(1e3)(measured(28)), tmp_path)
    with pytest.raises(ImplausibleError, match="seems to be in µm"):
        diagnose([], points, cell)
