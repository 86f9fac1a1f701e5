"""Whose error budget counts: the table's own, the cell's, or none; the same data give the same on every way."""

import asyncio
import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.diagnose import diagnose
from catseye.app.cli.export import export
from catseye.app.cli.scara.identify import identify
from catseye.app.errors import UsageError
from catseye.app.files.csv_text import csv_text
from catseye.app.protocol.banners import SIMULATION_TEXT
from catseye.app.results.scara.identified_arm import arm_remarks
from catseye.app.results.scara.points import COLUMNS
from catseye.app.results.scara.result import Result, read_result
from catseye.app.store.reader import RunReader
from tests.unit.app.cli.budget_routes import EQUAL, differences, figures, of_every_route, of_table
from tests.unit.app.cli.measured_runs import measured_run, rows_of_arm
from tests.unit.app.cli.test_unverified import tampered

TABLE_2_MM = 0.015817
"""Table 2 on 743 mm: 10, 5, 5, 10, 0.19, 0.09, 0.04 µm and two cosine errors of 0.27 µm, in quadrature, by hand."""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunReader:
    return asyncio.run(measured_run(tmp_path_factory.mktemp("measured"), 1))


@pytest.fixture(scope="module")
def routes(run: RunReader) -> dict[str, Result]:
    with pytest.MonkeyPatch.context() as patch:
        return of_every_route(run.path.parent.parent, run, patch)


@pytest.fixture(autouse=True)
def cell(tmp_path: Path) -> None:
    (tmp_path / "cell.toml").write_text(TEMPLATE, encoding="utf-8")


def exported(folder: Path, run: RunReader, name: str = "points.csv") -> Path:
    export(str(run.path), folder / name, None, None)
    return folder / name


def plain_table(folder: Path, sigma_mm: float | None = None) -> None:
    """Write the distances as another program would."""
    rows = [[row[name] for name in COLUMNS] for _, row in rows_of_arm(1)]
    if sigma_mm is None:
        text = csv_text(COLUMNS, rows)
    else:
        text = csv_text([*COLUMNS, "sigma_mm"], [[*row, sigma_mm] for row in rows])
    (folder / "plain.csv").write_text(text, encoding="utf-8")


def test_every_route_gives_the_same_values_and_u(routes: dict[str, Result]) -> None:
    for route, result in routes.items():
        assert max(differences(result, routes["run"])) < EQUAL, route
        assert result.budget is not None
        assert len(result.budget.contributor) == 13
        # A scan keeps no count of them.
        assert (result.fit.n_points, result.fit.n_returns) == (1062, 6) or result.scan
    sources = {route: result.budget.source for route, result in routes.items() if result.budget}
    assert sources == {"run": "run"} | {route: "table" for route in routes if route != "run"}


def test_a_table_without_a_budget_takes_the_cells(tmp_path: Path, routes: dict[str, Result]) -> None:
    plain_table(tmp_path)
    found = of_table(tmp_path, "plain.csv")
    assert found.budget is not None
    assert (found.budget.source, found.budget.name) == ("cell", "cell.toml")
    assert max(differences(found, routes["run"])) < EQUAL


def test_the_cells_budget_may_be_asked_for(tmp_path: Path, run: RunReader, routes: dict[str, Result]) -> None:
    exported(tmp_path, run)
    own = routes["points.csv"]
    (tmp_path / "cell.toml").write_text(TEMPLATE.replace("value_um = 10.0", "value_um = 30.0"))
    assert differences(of_table(tmp_path, "points.csv"), own) == (0.0, 0.0)
    asked = of_table(tmp_path, "points.csv", budget="cell")
    assert np.median(figures(asked)[1] / figures(own)[1]) > 1.5


def test_none_takes_sigma_as_white_and_says_so(
    tmp_path: Path, run: RunReader, routes: dict[str, Result], capsys: pytest.CaptureFixture[str]
) -> None:
    exported(tmp_path, run)
    own = routes["points.csv"]
    white = of_table(tmp_path, "points.csv", budget="none")
    assert "warning: No error budget was used: sigma_mm counts as white noise" in capsys.readouterr().err
    assert "no error budget was used" in " ".join(arm_remarks(white))
    assert white.budget is not None
    assert (white.budget.source, white.budget.sigma_mm, white.budget.contributor) == ("none", "white", [])
    # What distances share makes most of what is uncertain of the links.
    assert (figures(white)[1][:2] / figures(own)[1][:2]).max() < 0.8


async def test_a_run_without_a_budget_takes_its_scatter(
    tmp_path: Path, run: RunReader, capsys: pytest.CaptureFixture[str]
) -> None:
    identify(tmp_path / "run.json", [str(run.path)], budget="none")
    assert "the scatter of the fit counts as white noise" in capsys.readouterr().err
    assert read_result(tmp_path / "run.json").fit.chi2_probability is None


def test_sigma_beside_the_cells_budget_is_the_white_part(
    tmp_path: Path, routes: dict[str, Result], capsys: pytest.CaptureFixture[str]
) -> None:
    # Table 2's white part on every beam: 10, 0.09 µm, and two cosine errors that grow with its length.
    plain_table(tmp_path, 0.010007)
    found = of_table(tmp_path, "plain.csv")
    assert "sigma_mm is what differs from distance to distance" in capsys.readouterr().err
    # Cosine errors of beams from 0.3 to 1.1 m make weights of 0.1 % more or less.
    assert max(differences(found, routes["run"])) < 5e-3


@pytest.mark.parametrize("streamed", [False, True])
async def test_a_table_of_an_earlier_export_counts_nothing_twice(
    tmp_path: Path,
    routes: dict[str, Result],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    streamed: bool,
) -> None:
    (tmp_path / "cell.toml").write_text(TEMPLATE.replace("value_ppm = 1.5", "value_ppm = 0.054"))
    exact_mm = 1e-3 * float(
        np.sqrt(
            10.0**2
            + 0.09**2
            + 5.0**2
            + 5.0**2
            + 10.0**2
            + (0.054e-3 * 743.3) ** 2
            + (0.256e-3 * 743.3) ** 2
            + 2.0 * (743.3e3 * 0.717e-3**2 / np.sqrt(2.0)) ** 2
        )
    )
    assert exact_mm == pytest.approx(TABLE_2_MM, abs=1e-6)
    plain_table(tmp_path, exact_mm)
    if streamed:
        monkeypatch.setattr("catseye.app.results.scara.scan.SCAN_ROWS", 100)
        monkeypatch.setattr("catseye.app.results.scara.scan._SHORTEST_LINE_BYTES", 1)
    found = of_table(tmp_path, "plain.csv")
    assert "as earlier versions exported it: the budget counts, and sigma_mm not" in capsys.readouterr().err
    assert found.budget is not None
    assert found.budget.sigma_mm == "total"
    by_value, by_u = differences(found, routes["run"])
    # The run's laser is good to 1.5 ppm, that of this table to 0.054: half a micrometre of a link of u = 7 µm, and
    # weights that differ as little.
    assert by_value < 1e-3
    assert by_u < 0.02


def test_an_own_budget_is_asked_for_in_vain(
    tmp_path: Path, run: RunReader, routes: dict[str, Result]
) -> None:
    plain_table(tmp_path)
    with pytest.raises(UsageError, match="carries no error budget of its own: use --budget cell"):
        of_table(tmp_path, "plain.csv", budget="table")
    exported(tmp_path, run)
    assert differences(of_table(tmp_path, "points.csv", budget="table"), routes["points.csv"]) == (0.0, 0.0)


def thinned(text: str) -> str:
    lines = text.splitlines()
    return "\n".join([*lines[:100], *lines[101:]]) + "\n"


def smaller(text: str) -> str:
    return text.replace("'value_um': 10.0", "'value_um': 1.0", 1)


def surer(text: str) -> str:
    return re.sub(r",0\.01\d*,0\n", ",0.001,0\n", text, count=1)


@pytest.mark.parametrize("change", [thinned, smaller, surer])
@pytest.mark.parametrize("streamed", [False, True])
async def test_a_table_that_was_changed_is_refused_by_name(
    tmp_path: Path,
    run: RunReader,
    monkeypatch: pytest.MonkeyPatch,
    change: Callable[[str], str],
    streamed: bool,
) -> None:
    path = exported(tmp_path, run)
    before = path.read_text(encoding="utf-8")
    path.write_text(change(before), encoding="utf-8")
    assert path.read_text(encoding="utf-8") != before
    if streamed:
        monkeypatch.setattr("catseye.app.results.scara.scan.SCAN_ROWS", 100)
        monkeypatch.setattr("catseye.app.results.scara.scan._SHORTEST_LINE_BYTES", 1)
    with pytest.raises(UsageError, match=r"points\.csv: its rows or its error budget were changed"):
        of_table(tmp_path, "points.csv")
    taken = of_table(tmp_path, "points.csv", unverified=True)
    assert taken.provenance.unverified is not None
    assert "were changed after they were written together" in taken.provenance.unverified[0]
    assert of_table(tmp_path, "points.csv", budget="cell").provenance.unverified is None


def test_other_line_ends_and_columns_change_nothing(
    tmp_path: Path, run: RunReader, routes: dict[str, Result]
) -> None:
    path = exported(tmp_path, run)
    path.write_bytes(b"\xef\xbb\xbf# from a spreadsheet\r\n" + path.read_bytes().replace(b"\n", b"\r\n"))
    assert differences(of_table(tmp_path, "points.csv"), routes["points.csv"]) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("# catseye-budget {'format': 'catseye-budget/2'}", "of format catseye-budget/2; this version reads"),
        ("# catseye-budget {'format': 'catseye-budget/1'}", "cannot be read: source: Field required"),
        ("# catseye-budget {'format':}", "catseye-budget: not a JSON file"),
        ("# catseye-budget {'format': 'catseye-budget/1', 'sou", "catseye-budget: not a JSON file"),
        ("# catseye-budget {}\n# catseye-budget {}", "catseye-budget: not a JSON file"),
    ],
)
async def test_a_budget_that_cannot_be_read_is_reported(tmp_path: Path, line: str, complaint: str) -> None:
    plain_table(tmp_path)
    path = tmp_path / "plain.csv"
    path.write_text(f"{line}\n{path.read_text()}")
    with pytest.raises(Exception, match=complaint):
        of_table(tmp_path, "plain.csv")


async def test_whether_the_air_is_corrected_for_is_said(
    tmp_path: Path, run: RunReader, capsys: pytest.CaptureFixture[str]
) -> None:
    exported(tmp_path, run)
    of_table(tmp_path, "points.csv")
    assert "corrected for the air" not in capsys.readouterr().err
    plain_table(tmp_path)
    found = of_table(tmp_path, "plain.csv")
    assert "270 ppm too large" in capsys.readouterr().err
    assert "the scale is not assured" in " ".join(arm_remarks(found))


async def test_the_result_carries_the_budget_and_older_ones_are_read(tmp_path: Path, run: RunReader) -> None:
    identify(tmp_path / "run.json", [str(run.path)])
    document = json.loads((tmp_path / "run.json").read_text())
    budget = document["budget"]
    assert (budget["format"], budget["source"], budget["name"]) == ("catseye-budget/1", "run", run.path.name)
    assert budget["contributor"][3] == {
        "name": "repeatability of the robot",
        "kind": "position",
        "value_um": 10.0,
        "distribution": "normal",
        "correlation": "reading",
        "orders": 5,
    }
    del document["budget"]
    (tmp_path / "old.json").write_text(json.dumps(document))
    assert read_result(tmp_path / "old.json").budget is None


def test_a_table_says_that_emulated_devices_measured_it(
    tmp_path: Path, run: RunReader, routes: dict[str, Result]
) -> None:
    assert {result.provenance.simulated for result in routes.values()} == {True}
    assert exported(tmp_path, run).read_text(encoding="utf-8").startswith(f"# {SIMULATION_TEXT}\n")
    plain_table(tmp_path)
    assert of_table(tmp_path, "plain.csv").provenance.simulated is None


async def test_a_table_keeps_what_speaks_against_its_run(tmp_path: Path) -> None:
    measured = await measured_run(tmp_path, 1)
    tampered(measured.path)
    export(str(measured.path), tmp_path / "points.csv", None, None, unverified=True)
    said = of_table(tmp_path, "points.csv").provenance.unverified or []
    assert [text.split(": ")[0] for text in said] == [measured.path.name]


def without_line(path: Path, kind: str) -> None:
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    kept = [line for line in lines if not line.startswith(f"# {kind} ")]
    assert len(kept) == len(lines) - 1
    path.write_text("".join(kept), encoding="utf-8")


@pytest.mark.parametrize("streamed", [False, True])
async def test_a_table_whose_budget_was_taken_out_keeps_its_marks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, streamed: bool
) -> None:
    measured = await measured_run(tmp_path, 1)
    tampered(measured.path)
    export(str(measured.path), tmp_path / "points.csv", None, None, unverified=True)
    without_line(tmp_path / "points.csv", "catseye-budget")
    if streamed:
        monkeypatch.setattr("catseye.app.results.scara.scan.SCAN_ROWS", 100)
        monkeypatch.setattr("catseye.app.results.scara.scan._SHORTEST_LINE_BYTES", 1)
    with pytest.raises(UsageError, match=r"points\.csv: its error budget was taken out after"):
        of_table(tmp_path, "points.csv")
    asked = of_table(tmp_path, "points.csv", budget="cell").provenance
    assert asked.simulated is True
    assert [text.split(": ")[0] for text in asked.unverified or []] == [measured.path.name]
    taken = of_table(tmp_path, "points.csv", unverified=True).provenance
    assert taken.simulated is True
    assert [text.split(": ")[0] for text in taken.unverified or []] == [measured.path.name, "points.csv"]


def test_the_budget_keeps_the_marks_without_the_origin(
    tmp_path: Path, run: RunReader, routes: dict[str, Result]
) -> None:
    exported(tmp_path, run)
    expected = routes["points.csv"]
    without_line(tmp_path / "points.csv", "catseye-origin")
    found = of_table(tmp_path, "points.csv")
    assert found.provenance.simulated is expected.provenance.simulated is True
    assert differences(found, expected) == (0.0, 0.0)


async def test_an_origin_that_was_changed_is_refused(tmp_path: Path, run: RunReader) -> None:
    path = exported(tmp_path, run)
    text = path.read_text(encoding="utf-8")
    changed = text.replace("# catseye-origin {'simulated': true", "# catseye-origin {'simulated': false")
    assert changed != text
    path.write_text(changed, encoding="utf-8")
    with pytest.raises(UsageError, match="were changed after they were written together"):
        of_table(tmp_path, "points.csv")


async def test_a_size_of_the_default_budget_is_called_assumed(
    tmp_path: Path, run: RunReader, capsys: pytest.CaptureFixture[str]
) -> None:
    exported(tmp_path, run)
    of_table(tmp_path, "points.csv")
    said = " ".join(capsys.readouterr().err.split())
    assert re.search(r"drift of the zero: the distances suggest [\d.]+ times the assumed 2 µm", said)
    plain_table(tmp_path)
    (tmp_path / "cell.toml").write_text(with_drift(3.0))
    of_table(tmp_path, "plain.csv")
    said = " ".join(capsys.readouterr().err.split())
    assert re.search(r"drift of the zero: the distances suggest [\d.]+ times the stated 3 µm", said)
    assert "times the assumed 10 µm" in said


def with_drift(value_um: float) -> str:
    """Return a cell file whose budget states another drift of the zero."""
    head, tail = TEMPLATE.split('name = "drift of the zero"')
    return f'{head}name = "drift of the zero"{tail.replace("value_um = 2.0", f"value_um = {value_um}", 1)}'


async def test_json_of_a_run_has_its_budget_too(tmp_path: Path, run: RunReader) -> None:
    document = json.loads(exported(tmp_path, run, "points.json").read_text())
    assert len(document["catseye-budget"]["contributor"]) == 13
    # Table 2's white part on 743 mm, by hand.
    assert document["points"][0]["sigma_mm"] == pytest.approx(0.010007, abs=1e-6)


async def test_diagnose_names_the_budget(
    tmp_path: Path, run: RunReader, capsys: pytest.CaptureFixture[str]
) -> None:
    exported(tmp_path, run)
    diagnose([], tmp_path / "points.csv", tmp_path / "cell.toml")
    assert "Error budget: that of the table points.csv, 13 contributors." in capsys.readouterr().err


async def test_runs_with_different_budgets_are_named(
    tmp_path: Path, run: RunReader, capsys: pytest.CaptureFixture[str]
) -> None:
    configuration = json.loads(json.dumps(run.meta["configuration"]))
    configuration["uncertainty"]["contributor"][3]["value_um"] = 20.0
    other = await measured_run(tmp_path, 1, configuration=configuration)
    identify(tmp_path / "run.json", [str(run.path), str(other.path)])
    assert f"{other.path.name} states another error budget than {run.path.name}" in capsys.readouterr().err


async def test_monte_carlo_draws_the_same_from_a_table(tmp_path: Path, run: RunReader) -> None:
    exported(tmp_path, run)
    drawn = of_table(tmp_path, "points.csv", uncertainty="monte-carlo", draws=2000, model="conventional")
    identify(
        tmp_path / "run.json", [str(run.path)], uncertainty="monte-carlo", draws=2000, model="conventional"
    )
    assert max(differences(drawn, read_result(tmp_path / "run.json"))) < EQUAL
