"""Programs, digests and the origin of each value; what stands in the margins of printed pages."""

import re
from dataclasses import replace
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from catseye.app.protocol.banners import SIMULATION
from catseye.app.render.html import section_html
from catseye.app.render.labels import Labels
from catseye.app.results.runs.records import RunRecord, Sources
from catseye.app.results.runs.sections import cell_lines
from catseye.app.results.runs.trace import trace_section
from tests.unit.app.render.page_reader import read_page
from tests.unit.app.results.scara import sample

RUN = RunRecord(
    "20260102T030405Z_open-loop_ab12cd",
    "open-loop",
    "complete",
    "2026-01-02T03:04:05Z",
    software="catseye 0.0.9",
    versions={"python": "3.11.7", "numpy": "2.0.0"},
    operator="ada",
    files={"run.sqlite": 64 * "a", "wire.log": 64 * "b"},
)
SHEET = replace(
    sample.bare(sample.hand_made()).measured(runs=[RUN]),
    sources=Sources(versions={"python": "3.12.1", "scipy": "1.16.0"}),
)


def trace(sheet: sample.Sheet) -> str:
    software = (result.provenance.software for result in sheet.findings.results)
    section = trace_section(sheet.origin.software, sheet.sources, sheet.measurement.runs, software)
    return section_html(section, iter(()), Labels(section.blocks))


def test_runs_are_traced_with_programs_operator_digests_and_command() -> None:
    page = read_page(trace(SHEET))
    assert page.row("this page") == ["catseye 0.1.0", "python 3.12.1, scipy 1.16.0", ""]
    runs = [row for row in page.rows if row[0] == RUN.name]
    assert runs == [
        [RUN.name, "catseye 0.0.9", "python 3.11.7, numpy 2.0.0", "ada"],
        [RUN.name, "run.sqlite", 64 * "a"],
        [RUN.name, "wire.log", 64 * "b"],
    ]
    assert f"catseye verify {RUN.name}" in page.text


def test_a_result_file_has_its_digest_and_program() -> None:
    sources = Sources(digests={"result.json": 64 * "c"})
    page = read_page(trace(replace(sample.bare(sample.hand_made()), sources=sources)))
    assert page.row("result") == ["result.json", 64 * "c"]
    assert page.row("identified results")[0] == "catseye 0.1.0"
    assert "catseye verify" not in page.text


def test_an_unsealed_run_is_not_called_checkable() -> None:
    assert "catseye verify" not in trace(SHEET.measured(runs=[replace(RUN, files={})]))


def test_values_that_do_not_stand_in_the_file_are_marked() -> None:
    origins = {"robot.link1_mm": "file", "robot.link2_mm": "default", "reflector[2].x_mm": "default"}
    lines = dict(cell_lines(sample.cell(), origins))
    assert lines["robot.link1_mm = 325.0"] == "file"
    assert lines["robot.link2_mm = 225.0  # default"] == "default"
    assert lines["reflector[2].x_mm = 680.0  # default"] == "default"
    sheet = sample.whole().measured(origins=origins).found(results=[], validation=None)
    text = read_page(sample.page(sheet)).text
    assert "robot.link2_mm = 225.0  # default" in text


def test_defaults_of_a_beam_are_not_listed_without_one(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    stated = "[optics]\nacceptance_mm = 1.5\n"
    path.write_text(f"{TEMPLATES[SIX_AXIS].text}\n{stated}", encoding="utf-8")
    loaded = load_cell(path)
    lines = [text for text, _ in cell_lines(loaded.cell, loaded.origins)]
    beam = ("air.", "optics.", "alignment.", "measurement.", "uncertainty.", "robot.j3_", "robot.gear_orders")
    # What stands in the file is listed, whoever reads it.
    assert [text for text in lines if text.startswith(beam)] == ["optics.acceptance_mm = 1.5"]
    assert "tracker.face_deg = 15.0  # default" in lines
    assert "robot.limits_deg.j2 = [-5.0, 110.0]" in lines


def css_texts(html: str) -> list[str]:
    """Return the strings in the page's margins as a browser reads them."""
    rule = re.search(r"@page \{ @top-left.*", html)
    assert rule is not None
    return [
        re.sub(r"\\([0-9a-f]+) ", lambda m: chr(int(m[1], 16)), text)
        for text in re.findall(r'content: "((?:[^"\\]|\\.)*)"', rule[0])
    ]


def test_title_and_simulation_stand_on_every_printed_page() -> None:
    hostile = 'a</style><script>"}\\ 反 µ'
    sheet = SHEET.found(results=[])
    html = sample.page(replace(sheet, title=hostile, origin=replace(sample.MADE, simulated=True)))
    made = "2026-01-02 03:04:05 UTC · catseye 0.1.0"
    assert css_texts(html)[:3] == [SIMULATION, hostile, made]
    assert html.split("</head>")[0].count("</style>") == 1
    assert "<script" not in html
    assert css_texts(sample.page(sheet))[0] == ""
