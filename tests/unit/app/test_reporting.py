"""Reports of stored runs and of result files: what they are made from, and whether it was emulated."""

import hashlib
from pathlib import Path

import pytest

from catseye.app.render.page import write_page
from catseye.app.results.runs.run_source import are_simulated
from catseye.app.results.scara.result import Result, read_result, write_result
from catseye.app.results.scara.run_report import result_file_report, run_report
from tests.unit.app.render.page_reader import Page, read_page
from tests.unit.app.results.scara import sample
from tests.unit.app.test_path_comparison import measured, stored


def page_of(result: Result, folder: Path) -> Page:
    """Return the page of a result file without residuals, whose figure takes longest to draw."""
    write_result(result.model_copy(update={"residuals": None}), folder / "result.json")
    write_page(result_file_report(folder / "result.json"), folder / "page.html")
    return read_page((folder / "page.html").read_text(encoding="utf-8"))


@pytest.mark.parametrize("simulated", [True, False, None])
def test_a_result_of_emulated_devices_is_reported_as_such(tmp_path: Path, simulated: bool | None) -> None:
    result = sample.hand_made()
    origin = result.provenance.model_copy(update={"simulated": simulated})
    page = page_of(result.model_copy(update={"provenance": origin}), tmp_path)
    assert ("SIMULATION" in page.text) == bool(simulated)
    assert read_result(tmp_path / "result.json").provenance.simulated is simulated


def test_a_result_files_digest_is_of_its_bytes(tmp_path: Path) -> None:
    page = page_of(sample.hand_made(), tmp_path)
    digest = hashlib.sha256((tmp_path / "result.json").read_bytes()).hexdigest()
    assert page.row("result") == ["result.json", digest]


async def test_a_run_report_has_digests_origins_and_uncertainties(tmp_path: Path) -> None:
    origins = {"robot.link1_mm": "file", "robot.j3_mm": "default"}
    reader = await stored(
        tmp_path, "open-loop", measured(), configuration_origins=dict(origins), operator="ada"
    )
    write_page(run_report(reader, tmp_path), tmp_path / "page.html")
    html = (tmp_path / "page.html").read_text(encoding="utf-8")
    page = read_page(html)
    digests = {row[1]: row[2] for row in page.rows if row[0] == reader.path.name and len(row) == 3}
    for path in reader.path.iterdir():
        if path.name in digests:
            assert digests[path.name] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert "run.sqlite" in digests
    assert "SIMULATION" in page.text
    assert "# default" in page.text
    assert {"Uncertainty", "Traceability", "Conventions", "Configuration"} <= set(page.headings)
    assert not [value for _, name, value in page.attributes if name in {"src", "href"} and "http" in value]
    assert len(html.encode()) < 600_000


async def test_what_is_not_known_of_points_files_is_not_claimed(tmp_path: Path) -> None:
    assert are_simulated([]) is None
    assert are_simulated([await stored(tmp_path, "open-loop", [], simulated=False)]) is False
    assert are_simulated([await stored(tmp_path, "open-loop", [])]) is True
