"""What was made of a run is found beside the runs by what it holds, whatever it is called."""

import json
import os
from pathlib import Path

import pytest

from catseye.app.results.readiness import run_files
from catseye.app.results.readiness.after_run import Advice, after_run
from catseye.app.results.readiness.run_files import RunFiles, files_of_run

RUN = "20261121T090000Z_open-loop_abc123"
OTHER = "20261101T090000Z_open-loop_00beef"

PAGE = "<!doctype html><html><head><title>open-loop on lab-1</title></head><body>{run}</body></html>"
CSV = (
    "# made by catseye 0.2 at noon from {result} (error-map, identified today)\nx_mm,correction1_mdeg\n1,2\n"
)
MODULE = "MODULE CATSCOMP\r\n  ! compensated commands of poses.csv by {result}: IRB 120, model geometric\r\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "runs").mkdir()
    monkeypatch.setattr(run_files, "cell_of_run", lambda _run: "lab-1")
    return tmp_path


def result(folder: Path, name: str, run: str, age_s: float = 0.0) -> Path:
    content = {"format": "catseye-result/1", "model": "error-map", "provenance": {"runs": [run]}}
    return put(folder / name, json.dumps(content), age_s)


def put(file: Path, text: str, age_s: float = 0.0) -> Path:
    file.write_text(text, encoding="utf-8")
    os.utime(file, (1e9 - age_s, 1e9 - age_s))
    return file


def found(folder: Path) -> RunFiles:
    return files_of_run(RUN, folder / "runs")


def test_a_page_about_the_run_is_found_by_its_content(folder: Path) -> None:
    put(folder / "mine.html", PAGE.format(run=RUN), age_s=9.0)
    put(folder / "other.html", PAGE.format(run=OTHER))
    # The page of a result names its run too.
    put(folder / "result.html", PAGE.format(run=RUN).replace("open-loop on lab-1", "Result map.json"))
    assert found(folder).report == folder / "mine.html"
    newer = put(folder / "runs" / "again.html", PAGE.format(run=RUN), age_s=1.0)
    assert found(folder).report == newer


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("line.csv", CSV.format(result="map.json")),
        ("line.json", json.dumps({"format": "catseye-compensation/1", "result": "map.json"})),
        ("line.mod", MODULE.format(result="map.json")),
        ("compensated-abc123.csv", "pose,j1_deg,uncorrected_mm,reason\n"),
    ],
)
def test_corrected_commands_are_found_by_their_head_or_name(folder: Path, name: str, text: str) -> None:
    made = result(folder, "map.json", RUN)
    put(folder / "foreign.csv", CSV.format(result="another.json"))
    put(folder / "predicted.csv", "# made by catseye 0.2 at noon from map.json\nx_mm,y_mm\n")
    assert found(folder) == RunFiles(made, None, None, 1)
    assert put(folder / name, text) == found(folder).compensation


def test_results_of_the_cell_are_counted_for_a_trend(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result(folder, "map.json", RUN)
    result(folder, "old.json", OTHER, 9.0)
    assert found(folder).results_of_arm == 2
    monkeypatch.setattr(run_files, "cell_of_run", lambda run: run.name)
    assert found(folder).results_of_arm == 1


def advised(folder: Path) -> dict[str, Advice]:
    root, cell = folder / "runs", folder / "cell.toml"
    return {
        each.kind: each for each in after_run("open-loop", "complete", RUN, root, None, found(folder), cell)
    }


def test_compensation_is_advised_once_there_is_a_result(folder: Path) -> None:
    assert "compensate" not in advised(folder)
    made = result(folder, "map.json", RUN)
    advice = advised(folder)["compensate"]
    assert advice.command == (
        "compensate",
        str(made),
        "--path",
        "{path}",
        "--cell",
        str(folder / "cell.toml"),
    )
    assert [asked.name for asked in advice.asks] == ["path"]
    assert advice.writes == folder / "compensated-abc123.csv"
    there = put(folder / "line.csv", CSV.format(result="map.json"))
    assert advised(folder)["compensate"].shows == there


def test_a_trend_is_advised_from_two_results_on(folder: Path) -> None:
    result(folder, "map.json", RUN)
    assert "trend" not in advised(folder)
    result(folder, "old.json", OTHER, 9.0)
    advice = advised(folder)["trend"]
    assert advice.command == ("trend", str(folder / "cell.toml"), "--runs", str(folder / "runs"))
    assert advice.writes == folder / "trend-abc123.html"
