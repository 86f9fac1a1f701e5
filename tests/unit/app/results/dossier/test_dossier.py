"""The dossier joins what the stages of a day have found, and says what each can be traced to."""

import hashlib
import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cli import dossier as dossier_command
from catseye.app.cli.dossier import dossier
from catseye.app.cli.init import init
from catseye.app.errors import StorageError, UsageError
from catseye.app.render.cells import cell_text
from catseye.app.render.page import page_html
from catseye.app.results.dossier.day import Day, day_of, judged_at
from catseye.app.results.dossier.report import dossier_report
from catseye.app.results.figures import Figure
from catseye.app.results.model import Entries, Sign, Statement
from catseye.app.results.readiness.cell_runs import runs_of_cell
from catseye.app.results.readiness.stages import CellStage
from catseye.app.results.readiness.survey import Survey
from catseye.app.results.scara.result import write_result
from catseye.app.store.reader import Accept
from catseye.procedures.kit.records import Json
from tests.unit.app.results.scara import sample
from tests.unit.app.results.warm_ups import stored_warm_up
from tests.unit.app.store.fakes import TickingClock

WARM = "warm after 40 min: drift in 10 min +3.0 µm, U = 2.0 µm; the limit is 20 µm"
"""Of a drift of 3 µm with u = 1 µm."""

DEVICES: Json = {
    "robot": {"model": "RH-3FRH5515", "firmware": "A1", "serial": "R-77", "simulated": True},
    "interferometer": {"model": "counter", "firmware": "2.0", "serial": "", "simulated": True},
}


class Bench:
    """A cell whose arm was warmed up."""

    def __init__(self, folder: Path) -> None:
        self.cell, self.root, self.clock = folder / "cell.toml", folder / "runs", TickingClock()
        init(self.cell)
        self.configuration: Json = load_cell(self.cell).cell.model_dump(mode="json", exclude_none=True)

    async def warm(self, drift: float = 3.0, *, warm: bool = True) -> str:
        """Store a warm-up of forty minutes; return its name."""
        meta: dict[str, Json] = {
            "cell": "lab-1",
            "configuration": self.configuration,
            "devices": DEVICES,
            "simulated": True,
            "operator": "M. Lang",
            "software": {"catseye": "0.9"},
        }
        path = await stored_warm_up(self.root, self.clock, drift, warm=warm, meta=meta)
        return path.name

    def survey(self, *stages: CellStage) -> Survey:
        """Return the cell on a way of such stages, without the plans of all procedures: those take their time."""
        return Survey("lab-1", [], {}, runs_of_cell(self.root, "lab-1", datetime.now(UTC)), list(stages))

    def day(self, *stages: CellStage, terms: Accept = Accept.SOUND) -> Day:
        return day_of(self.survey(*stages), self.root, terms)


def warmup(*runs: str, state: Any = "done") -> CellStage:
    return CellStage("warmup", True, state, "the arm warm", "catseye run warmup", runs=runs)


def on_data(name: str, *files: Path, runs: tuple[str, ...] = (), words: tuple[str, ...] = ()) -> CellStage:
    return CellStage(
        name,
        False,
        "done" if files else "next",
        "for later",
        "",
        words=words or (name,),
        runs=runs,
        files=files,
    )


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path)


def certificate_row(day: Day, stage: str) -> tuple[Any, ...]:
    (row,) = [row for row in dossier_report(day).table("stages").rows if row[0] == stage]
    return row


async def test_a_stage_states_figure_run_and_digest(bench: Bench) -> None:
    run = await bench.warm()
    digest = hashlib.sha256((bench.root / run / "run.sqlite").read_bytes()).hexdigest()
    row = certificate_row(bench.day(warmup(run)), "warmup")
    assert row[1:5] == ("done", "in order", WARM, run[-6:])
    assert row[6] == digest[:12]


async def test_a_missed_limit_is_not_in_order(bench: Bench) -> None:
    run = await bench.warm(30.0, warm=False)
    day = bench.day(warmup(run, state="next"))
    assert certificate_row(day, "warmup")[2] == "not in order"
    verdict = dossier_report(day).section("certificate").blocks[0]
    assert verdict == Statement(Sign.BAD, "0 of 1 stage done; not in order: warmup; open: warmup.")


async def test_the_stage_that_makes_the_page_is_not_on_it(bench: Bench, tmp_path: Path) -> None:
    stages = warmup(await bench.warm()), on_data("dossier", tmp_path / "dossier-cell.html")
    report = dossier_report(bench.day(*stages))
    assert [row[0] for row in report.table("stages").rows] == ["warmup"]
    assert "1 of 1 stage done" in report.statements()[0].text


async def test_the_certificate_names_operator_arm_and_instruments(bench: Bench) -> None:
    report = dossier_report(bench.day(warmup(await bench.warm())))
    about = next(one for one in report.section("certificate").blocks if isinstance(one, Entries))
    stated = dict(about.entries)
    assert stated["operator"] == "M. Lang"
    assert stated["measured by"] == "catseye 0.9"
    assert stated["measured on (UTC)"] == "2026-01-02"
    assert "RH-3FRH5515" in stated["cell, arm"]
    robot, counter = report.table("instruments").rows
    assert robot[:5] == ("robot", "RH-3FRH5515", "R-77", "A1", "EMULATED")
    # Somebody writes down what a device does not say.
    assert set(str(counter[2])) == set(str(counter[5])) == {"…"}


async def test_emulated_devices_mark_the_page(bench: Bench) -> None:
    page = page_html(dossier_report(bench.day(warmup(await bench.warm()))))
    assert "SIMULATION: every device is an emulator" in page
    assert page.index('id="certificate"') < page.index('id="stage-1"') < page.index('id="trace"')


async def test_a_result_states_twice_its_standard_uncertainty(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "map.json"
    write_result(sample.hand_made(), path)
    data = json.loads(path.read_text(encoding="utf-8"))
    largest = max(
        u
        for table in (data["theta1_map"], data["theta2_map"])
        for u in (*table["u_positive_mdeg"], *table["u_negative_mdeg"])
    )
    day = bench.day(warmup(await bench.warm()), on_data("identify", path))
    row = certificate_row(day, "identify")
    assert row[3].startswith(f"maps U ≤ {2.0 * largest:.1f} mdeg; ")
    assert row[4] == "map.json"
    assert row[6] == hashlib.sha256(path.read_bytes()).hexdigest()[:12]
    u_mm = data["link1_mm"]["u"]
    table = dossier_report(day).table("values")
    assert table.rows[0][0] == "L1"
    assert table.columns[4].title == "U (k=2)"
    shown = cell_text(table.rows[0][4], table.columns[4])
    assert float(shown) == pytest.approx(2.0 * u_mm, abs=5e-5)


async def test_a_fit_that_the_distances_contradict_is_not_in_order(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "map.json"
    # A probability of 1 in 1000 000 that the stated uncertainties are all there is.
    write_result(sample.hand_made(the_fit=sample.fit(chi2=(30.0, 1e-6))), path)
    day = bench.day(warmup(await bench.warm()), on_data("identify", path))
    assert certificate_row(day, "identify")[2] == "not in order"


async def test_an_open_stage_says_what_it_is_for(bench: Bench) -> None:
    row = certificate_row(bench.day(warmup(await bench.warm()), on_data("compensate")), "compensate")
    assert row[1:5] == ("next", "", "for later", "")


async def test_a_run_that_counts_no_more_says_so(bench: Bench) -> None:
    run = await bench.warm()
    row = certificate_row(bench.day(warmup(state="next")), "warmup")
    assert row[2:5] == ("with doubts", f"{WARM}; it no longer counts", run[-6:])


async def test_what_cannot_be_read_says_why(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "map.json"
    path.write_text('{"format": "catseye-result/1"}', encoding="utf-8")
    day = bench.day(warmup(await bench.warm()), on_data("identify", path))
    row = certificate_row(day, "identify")
    assert row[2] == "with doubts"
    assert row[3].startswith("cannot be stated: ")
    assert "map.json" in row[3]


async def test_a_validation_that_is_refused_says_why(bench: Bench, tmp_path: Path) -> None:
    run, result, page = await bench.warm(), tmp_path / "map.json", tmp_path / "validation.html"
    write_result(sample.hand_made(), result)
    page.write_text("", encoding="utf-8")
    words = ("validate", str(result), "--measured", run)
    day = bench.day(warmup(run), on_data("validate", page, runs=(run,), words=words))
    assert day.stages[1].worth.sign is Sign.ATTENTION
    assert "cannot be stated: " in day.stages[1].worth.figure


async def test_figures_of_two_stages_have_keys_of_their_own(bench: Bench) -> None:
    run = await bench.warm()
    report = dossier_report(bench.day(warmup(run), warmup(run)))
    keys = [block.key for block in report.blocks() if isinstance(block, Figure)]
    assert keys == ["stage-1-warm-up", "stage-2-warm-up"]


async def test_a_changed_run_is_refused_or_marks_the_page(bench: Bench) -> None:
    run = await bench.warm()
    database = bench.root / run / "run.sqlite"
    database.chmod(0o644)
    with database.open("ab") as stream:
        stream.write(b"\0" * 4096)
    with pytest.raises(StorageError):
        bench.day(warmup(run))
    day = bench.day(warmup(run), terms=Accept.CHANGED)
    assert "UNVERIFIED" in page_html(dossier_report(day))


async def test_nothing_can_be_joined_without_runs(bench: Bench) -> None:
    with pytest.raises(UsageError, match="holds no run of cell lab-1"):
        judged_at(bench.root, "lab-1")
    await bench.warm()
    with pytest.raises(UsageError, match="nothing to join"):
        bench.day(on_data("identify"))


async def test_runs_are_judged_as_the_newest_run_began(bench: Bench) -> None:
    await bench.warm()
    before = bench.clock.now_utc()
    await bench.warm()
    after = bench.clock.now_utc()
    judged = judged_at(bench.root, "lab-1")
    assert before < judged < after
    # Nearer to its begin than to its end.
    assert judged - before < after - judged


async def test_the_command_writes_page_and_json(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = await bench.warm()
    monkeypatch.setattr(dossier_command, "surveyed", lambda *_given, **_options: bench.survey(warmup(run)))
    page = tmp_path / "dossier.html"
    dossier(bench.cell, page, bench.root, as_json=True)
    document = json.loads(capsys.readouterr().out)
    assert WARM in page.read_text(encoding="utf-8")
    assert (document["cell"], document["simulated"], document["sign"]) == ("lab-1", True, "good")
    (stage,) = document["stages"]
    assert (stage["figure"], stage["runs"]) == (WARM, [run])
    assert document["instruments"][0]["serial"] == "R-77"
    digest = hashlib.sha256((bench.root / run / "run.sqlite").read_bytes()).hexdigest()
    assert document["digests"][f"{run}/run.sqlite"] == digest
