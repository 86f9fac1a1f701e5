"""TABLES CSV: what is written is read, what is wrong is named with its line."""

from pathlib import Path

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.results.resolution.joint_tables import read_joint_tables, write_joint_tables
from catseye.calibration.resolution.tables import ExpectedErrors, JointTable, Sector

NAMES = ("A1", "A2")
HEADER = "joint,direction,position_deg,command_deg,error_mean_percent,error_std_percent,reversal_deg\n"


def sector(position: float, reversal: float | None) -> Sector:
    errors = ExpectedErrors(np.array([-50.0, 1.5]), np.array([30.0, 4.0]), np.array([4.0, 3.0]))
    return Sector(position, np.array([1e-4, 0.1]), errors, reversal)


def written(folder: Path, text: str) -> Path:
    path = folder / "tables.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_tables_come_back_as_they_were(tmp_path: Path) -> None:
    path = tmp_path / "tables.csv"
    table = JointTable("A2", -1, (sector(-30.0, 0.004), sector(45.0, None)))
    write_joint_tables([table], path, simulated=False)
    found = read_joint_tables(path, NAMES).tables.of("A2", -1)
    assert found is not None
    for one, other in zip(found.sectors, table.sectors, strict=True):
        assert (one.position, one.reversal) == (other.position, other.reversal)
        assert one.commands == pytest.approx(other.commands)
        assert one.errors.mean_percent == pytest.approx(other.errors.mean_percent)
        assert one.errors.scatter_percent == pytest.approx(other.errors.scatter_percent, rel=1e-4)
        assert one.errors.u_mean_percent == pytest.approx(other.errors.u_mean_percent)


def test_the_standard_deviation_is_that_of_a_step(tmp_path: Path) -> None:
    path = tmp_path / "tables.csv"
    write_joint_tables([JointTable("A2", -1, (sector(-30.0, 0.004),))], path, simulated=True)
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith(HEADER.strip())
    assert lines[2] == "A2,-1,-30,0.1,1.5,5,0.004,3,1"


def test_tables_of_emulated_devices_say_so(tmp_path: Path) -> None:
    path = tmp_path / "tables.csv"
    for simulated in (True, False):
        write_joint_tables([JointTable("A2", -1, (sector(-30.0, 0.004),))], path, simulated=simulated)
        assert read_joint_tables(path, NAMES).simulated is simulated
    assert not read_joint_tables(written(tmp_path, HEADER + "A1,1,0,0.1,1,2,\n"), NAMES).simulated


def test_rows_of_another_program_may_come_in_any_order(tmp_path: Path) -> None:
    text = HEADER + "A1,1,0,0.1,1,2,\nA1,1,-10,0.1,3,2,0.002\nA1,1,0,0.001,5,6,\nA1,1,-10,0.01,3,2,\n"
    found = read_joint_tables(written(tmp_path, text), NAMES).tables.of("A1", 1)
    assert found is not None
    assert [one.position for one in found.sectors] == [-10.0, 0.0]
    assert [one.reversal for one in found.sectors] == [0.002, None]
    assert found.sectors[1].commands.tolist() == [0.001, 0.1]
    assert found.sectors[1].errors.scatter_percent.tolist() == [6.0, 2.0]


@pytest.mark.parametrize(
    ("rows", "part"),
    [
        ("A7,1,0,0.1,1,2,\n", "tables.csv:2: unknown joint 'A7'; the arm knows A1, A2"),
        ("A1,0,0,0.1,1,2,\n", "tables.csv:2: direction = '0' is not 1 or -1"),
        ("A1,1,0,-0.1,1,2,\n", "tables.csv:2: command_deg = '-0.1' is not a finite number above 0"),
        ("A1,1,0,0.1,1,-2,\n", "tables.csv:2: error_std_percent = -2 is below 0"),
        ("A1,1,0,0.1,1,2,x\n", "tables.csv:2: reversal_deg = 'x' is not a number from 0 on"),
        ("A1,1,0,0.1,1,2,\nA1,1,0,0.1,3,2,\n", "tables.csv:3: stands on line 2 already"),
        ("A1,1,0,1,1,2,\nA1,1,9,2,1,2,\n", "tables.csv: A1 .* no step in common"),
        ("", "holds no step errors"),
    ],
)
def test_a_wrong_table_names_the_line(tmp_path: Path, rows: str, part: str) -> None:
    with pytest.raises(UsageError, match=part):
        read_joint_tables(written(tmp_path, HEADER + rows), NAMES)


def test_a_missing_column_is_named(tmp_path: Path) -> None:
    text = HEADER.replace("command_deg,", "") + "A1,1,0,1,2,\n"
    with pytest.raises(UsageError, match="column command_deg is missing: it takes tables of catseye"):
        read_joint_tables(written(tmp_path, text), NAMES)
