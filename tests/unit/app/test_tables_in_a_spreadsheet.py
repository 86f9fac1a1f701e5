"""Every table that the program writes as CSV opens safely in a spreadsheet, whatever names and texts it holds."""

import ast
from pathlib import Path
from typing import Any

import pytest

from catseye import app
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.export import export
from catseye.app.cli.scara.compensate import compensate
from catseye.app.cli.scara.design import design
from catseye.app.cli.scara.predict import predict
from catseye.procedures.kit.records import Row
from tests.unit.app.cli.arms import bare, estimate, stored, text_file
from tests.unit.app.engine.fakes import point
from tests.unit.app.files.spreadsheet import formulas
from tests.unit.app.store.fakes import PATH_ROW, SEARCH_ROW
from tests.unit.app.test_path_comparison import stored as stored_run

HOSTILE = 'x;=HYPERLINK("http://127.0.0.1")'
SEEN: Row = {"x_meas_mm": 1.0, "y_meas_mm": 2.0, "u_mm": 0.01}
RESULT = f"r,=1+1 {HOSTILE.replace('/', '')}.json"


def written(output: Path) -> str:
    # As bytes: opening as text would turn a carriage return into a line feed.
    return output.read_bytes().decode()


@pytest.mark.parametrize(
    "row",
    [
        ("points", {**point(), "reflector": HOSTILE}),
        ("search", {**SEARCH_ROW, "reflector": HOSTILE, "note": "a\t-1+1", "list": [HOSTILE]}),
        ("path", {**PATH_ROW, **SEEN}),
        ("path", {**PATH_ROW, "reflector": HOSTILE, "segment": 0, "displacement_mm": 1.0}),
        ("records", {"kind": HOSTILE, "who": "a\r=1+1", HOSTILE: 1}),
    ],
    ids=["points", "search", "places", "distances", "records"],
)
async def test_an_exported_run(tmp_path: Path, row: tuple[str, Row]) -> None:
    run = (await stored_run(tmp_path, "open-loop", [row])).path
    (run / f"log,=1+1;=2;{HOSTILE.replace('/', '')}").touch()
    export(str(run), tmp_path / "run.csv", None, None, unverified=True)
    text = written(tmp_path / "run.csv")
    assert text.startswith("# UNVERIFIED: ")
    assert formulas(text) == []


def test_an_exported_result(tmp_path: Path) -> None:
    content = bare()
    content["reflectors"] = [{"name": HOSTILE, "x_mm": estimate(1.0, 0.1), "y_mm": estimate(2.0, 0.1)}]
    content["provenance"]["unverified"] = ["a,=1+1", HOSTILE]
    export(str(stored(tmp_path, content)), tmp_path / "result.csv", None, None)
    text = written(tmp_path / "result.csv")
    assert "HYPERLINK" in text
    assert formulas(text) == []


def test_predicted_commands(tmp_path: Path) -> None:
    path = text_file(tmp_path, "theta1_deg,theta2_deg,direction1,direction2\n45,60,1,1\n")
    predict(stored(tmp_path, bare(), RESULT), path, tmp_path / "out.csv", "right", "1,1", as_json=False)
    assert formulas(written(tmp_path / "out.csv")) == []


def test_compensated_commands(tmp_path: Path) -> None:
    path = text_file(tmp_path, "x_mm,y_mm\n300,300\n")
    result, output = stored(tmp_path, bare(), RESULT), tmp_path / "out.csv"
    compensate(result, output, path, "csv", "right", "1,1", None, 0.0, as_json=False)
    assert "HYPERLINK" in written(output)
    assert formulas(written(output)) == []


def test_chosen_commands(tmp_path: Path) -> None:
    cell = text_file(tmp_path, TEMPLATE, "cell.toml")
    options: dict[str, Any] = {"places": 30, "random_only": True, "commands": 60}
    design(cell, **options, write_commands=tmp_path / "out.csv")
    assert written(tmp_path / "out.csv").startswith("theta1_deg,theta2_deg,direction1,direction2\n")
    assert formulas(written(tmp_path / "out.csv")) == []


def test_one_module_writes_csv() -> None:
    root = Path(app.__file__).parents[1]
    folders = [root / name for name in ("app", "calibration", "drivers", "procedures", "simulators")]
    writers = {
        str(file.relative_to(root))
        for folder in folders
        for file in folder.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr in {"writer", "DictWriter"} and _is_csv(node.value)
    }
    assert writers == {"app/files/csv_text.py"}


def _is_csv(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id == "csv"
