"""What comes out of a run that was changed after its end says so."""

import json
import os
from pathlib import Path

import pytest

from catseye.app.cli.compare import compare
from catseye.app.cli.export import export
from catseye.app.cli.report import report
from catseye.app.cli.scara import identify as identify_command
from catseye.app.cli.show import show
from catseye.app.errors import StorageError
from catseye.app.results.scara.identified_arm import arm_remarks
from catseye.app.results.scara.path_of_run import compare_path
from catseye.app.results.scara.points import read_points
from catseye.app.results.scara.result import read_result
from catseye.app.store.reader import Accept, RunReader
from tests.unit.app.test_path_comparison import distances, measured, stored

CHANGED = "wire.log was changed after the end"


async def changed(root: Path) -> Path:
    return tampered((await stored(root, "open-loop", measured())).path)


def tampered(run: Path) -> Path:
    (run / "wire.log").chmod(0o644)
    (run / "wire.log").write_text("nothing happened")
    return run


def identify(run: Path, *, unverified: bool) -> Path:
    output = run.parent.parent / "result.json"
    identify_command.identify(
        output, [str(run)], model="conventional", runs=run.parent, unverified=unverified
    )
    return output


async def test_no_command_uses_a_changed_run_unasked(tmp_path: Path) -> None:
    run = await changed(tmp_path / "runs")
    for command in (
        lambda: identify(run, unverified=False),
        lambda: report([str(run)], tmp_path / "page.html", None),
        lambda: export(str(run), tmp_path / "points.csv", None, None),
        lambda: show(str(run), as_json=False),
    ):
        with pytest.raises(StorageError, match=CHANGED):
            command()
    assert os.listdir(tmp_path) == ["runs"]


async def test_a_result_keeps_what_speaks_against_its_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = await changed(tmp_path / "runs")
    result = identify(run, unverified=True)
    assert read_result(result).provenance.unverified == [f"{run.name}: {CHANGED}"]
    assert f"UNVERIFIED: {run.name}: {CHANGED}" in capsys.readouterr().err
    report([str(result)], tmp_path / "page.html", None)
    assert "UNVERIFIED" in (tmp_path / "page.html").read_text(encoding="utf-8")
    export(str(result), tmp_path / "result-table.json", None, None)
    assert json.loads((tmp_path / "result-table.json").read_text())["unverified"]


async def test_a_sound_run_leaves_no_mark(tmp_path: Path) -> None:
    reader = await stored(tmp_path / "runs", "open-loop", measured())
    result = identify(reader.path, unverified=True)
    assert "unverified" not in result.read_text()
    export(str(reader.path), tmp_path / "points.json", None, None, unverified=True)
    assert "unverified" not in json.loads((tmp_path / "points.json").read_text())


async def test_a_report_says_on_top_that_its_run_was_changed(tmp_path: Path) -> None:
    run = await changed(tmp_path)
    report([str(run)], tmp_path / "page.html", None, unverified=True)
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert page.index(f"UNVERIFIED: {run.name}: {CHANGED}") < page.index("<main>")


async def test_exports_say_that_their_run_was_changed(tmp_path: Path) -> None:
    run = await changed(tmp_path)
    for name in ("points.csv", "points.json"):
        export(str(run), tmp_path / name, None, None, unverified=True)
    first, *_ = (tmp_path / "points.csv").read_text().splitlines()
    assert first == f"# UNVERIFIED: {run.name}: {CHANGED}"
    assert len(read_points(tmp_path / "points.csv", ["P2"])) == len(measured())
    assert json.loads((tmp_path / "points.json").read_text())["unverified"] == [f"{run.name}: {CHANGED}"]


async def test_show_says_that_a_run_was_changed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = await changed(tmp_path)
    show(str(run), as_json=False, unverified=True)
    assert capsys.readouterr().out.splitlines()[1] == f"  UNVERIFIED: {run.name}: {CHANGED}"
    show(str(run), as_json=True, unverified=True)
    assert json.loads(capsys.readouterr().out)["unverified"] == [f"{run.name}: {CHANGED}"]


async def test_a_measurement_used_beside_a_run_is_verified_too(tmp_path: Path) -> None:
    path = (await stored(tmp_path, "validation-path", distances())).path
    other = await changed(tmp_path)
    with pytest.raises(StorageError, match=other.name):
        compare_path(RunReader(path), tmp_path)
    reader = RunReader(path, Accept.CHANGED)
    compare_path(reader, tmp_path)
    assert reader.unverified == [f"{other.name}: {CHANGED}"]


async def test_what_a_changed_result_is_used_for_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = await changed(tmp_path / "runs")
    result = identify(run, unverified=True)
    assert arm_remarks(read_result(result))[0] == f"UNVERIFIED: {run.name}: {CHANGED}"
    capsys.readouterr()
    compare(result, result, as_json=False)
    assert f"UNVERIFIED: {run.name}: {CHANGED}" in capsys.readouterr().err
