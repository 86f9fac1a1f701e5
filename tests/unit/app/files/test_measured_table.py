"""Measured CSV: both forms of commands, and what is said about a file that cannot be used."""

import importlib
from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_table
from catseye.procedures.scara.path.tables import MEASURED

JOINT = "theta1_deg,theta2_deg,direction1,direction2,x_meas_mm,y_meas_mm"
PLACE = "x_mm,y_mm,x_meas_mm,y_meas_mm"


def written(folder: Path, text: str) -> Path:
    path = folder / "tracker.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_commands_stand_as_joints_with_directions(tmp_path: Path) -> None:
    text = f"# tracker of the institute\n{JOINT},u_mm\n-77.5,23.25,1,-1,1200.01,-499.5,0.008\n"
    found = read_table(written(tmp_path, text), MEASURED)
    assert found.lines.tolist() == [3]
    assert {name: values.tolist() for name, values in found.values.items()} == {
        "theta1_deg": [-77.5],
        "theta2_deg": [23.25],
        "direction1": [1.0],
        "direction2": [-1.0],
        "x_meas_mm": [1200.01],
        "y_meas_mm": [-499.5],
        "u_mm": [0.008],
    }


def test_commands_stand_as_places(tmp_path: Path) -> None:
    text = f"\ufeff{PLACE}\r\n200, -500 ,200.02,-500.1\r\n# turned back\r\n\r\n200,-490,200.01,-490.2\r\n"
    found = read_table(written(tmp_path, text), MEASURED)
    assert found.lines.tolist() == [2, 5]
    assert found.stacked(("x_mm", "y_mm")).tolist() == [[200.0, -500.0], [200.0, -490.0]]
    assert found.stacked(("x_meas_mm", "y_meas_mm")).tolist() == [[200.02, -500.1], [200.01, -490.2]]
    assert "u_mm" not in found


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ["tracker.csv: is empty", JOINT, PLACE]),
        (f"{PLACE}\n", ["tracker.csv: holds no points"]),
        (
            f"#\n{JOINT.replace(',direction2', '')}\n",
            ["tracker.csv:2: column direction2 is missing", "state of approach", JOINT],
        ),
        (f"{JOINT.replace('theta2_deg,', '')}\n", ["tracker.csv:1: column theta2_deg is missing"]),
        (f"{PLACE.replace(',y_meas_mm', '')}\n", ["tracker.csv:1: column y_meas_mm is missing"]),
        ("x_meas_mm,y_meas_mm\n", ["tracker.csv:1: column x_mm, y_mm is missing"]),
        (f"x_mm,y_mm,{JOINT}\n", ["tracker.csv:1: joint and Cartesian commands stand in one file"]),
        (f"{PLACE},u_um\n", ["tracker.csv:1: unknown column u_um", "u_mm"]),
        (f"{PLACE},x_mm\n", ["tracker.csv:1: column x_mm stands twice"]),
        (f"{PLACE}\n200,-500,200,nan\n", ["tracker.csv:2: y_meas_mm = 'nan' is not a finite number"]),
        (f"{PLACE}\n#\n200,-500,inf,1\n", ["tracker.csv:3: x_meas_mm = 'inf'"]),
        (f"{PLACE}\n200,-500,200\n", ["tracker.csv:2: 3 values, but the header has 4 columns"]),
        (f"{PLACE}\n200,-500,200.1;3,4\n", ["tracker.csv:2: x_meas_mm = '200.1;3'"]),
        (
            f"{PLACE},u_mm\n200,-500,200,-500,0\n",
            ["tracker.csv:2: u_mm = '0' is not a finite number above 0"],
        ),
        (
            # 15 µm + 6 µm/m of a tracker, as its data sheet writes it.
            f"{PLACE},u_mm\n200,-500,200,-500,15\n",
            ["tracker.csv:2: u_mm = 15 is more than 1 mm: it seems to be in µm", "leave the column out"],
        ),
        (f"{JOINT}\n1,2,0,1,3,4\n", ["tracker.csv:2: direction1 = '0' is not 1 or -1"]),
    ],
)
def test_a_fault_is_reported_with_file_and_line(tmp_path: Path, text: str, expected: list[str]) -> None:
    with pytest.raises(UsageError) as caught:
        read_table(written(tmp_path, text), MEASURED)
    for part in expected:
        assert part in str(caught.value)


def test_a_file_that_is_none_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"none\.csv: there is no such file"):
        read_table(tmp_path / "none.csv", MEASURED)
    with pytest.raises(UsageError, match="is not a file name"):
        read_table(Path("a\0b.csv"), MEASURED)


def test_parquet_of_distances_is_called_by_its_name(tmp_path: Path) -> None:
    arrow, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    path = tmp_path / "points.parquet"
    parquet.write_table(arrow.table({"theta1_deg": [1.0], "displacement_mm": [2.0]}), path)
    with pytest.raises(UsageError, match="holds distances to reflectors, and positions are needed"):
        read_table(path, MEASURED)
