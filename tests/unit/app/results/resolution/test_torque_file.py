"""Files with the motor torque of a joint."""

from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.results.resolution.torque_file import read_torque


def _file(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "torque.csv"
    path.write_text(text, "utf-8")
    return path


def test_the_own_table_is_read(tmp_path: Path) -> None:
    torque = read_torque(_file(tmp_path, "# of A1\nt_s,torque_nm\n0.0,-1.5\n0.012,2.5\n"))
    assert torque["torque_nm"].tolist() == [-1.5, 2.5]
    assert torque["t_s"].tolist() == [0.0, 0.012]


def test_the_only_channel_in_newton_metres_is_taken(tmp_path: Path) -> None:
    text = "time(ms),AxisPos_A1(deg),Torque_A1(Nm)\n0,10,-1.5\n12,10,2.5\n24,10,3.5\n"
    torque = read_torque(_file(tmp_path, text))
    assert torque["torque_nm"].tolist() == [-1.5, 2.5, 3.5]
    assert torque["t_s"] == pytest.approx([0.0, 0.012, 0.024])


_TWO = "time(s),Torque_A1(Nm),Torque_A2(Nm)\n0,1,4\n1,2,5\n2,3,6\n"


def test_several_torques_need_a_name(tmp_path: Path) -> None:
    with pytest.raises(
        UsageError, match=r"2 channels are in N m; name one by --torque-channel; .*Torque_A2 \[Nm\]"
    ):
        read_torque(_file(tmp_path, _TWO))


def test_a_channel_is_taken_by_its_name(tmp_path: Path) -> None:
    assert read_torque(_file(tmp_path, _TWO), "Torque_A2")["torque_nm"].tolist() == [4.0, 5.0, 6.0]


def test_an_unknown_channel_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no single channel is called 'Torque_A9'"):
        read_torque(_file(tmp_path, _TWO), "Torque_A9")


def test_a_trace_without_times_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no channel holds times; there are Pos_A1"):
        read_torque(_file(tmp_path, "Pos_A1(deg),Torque_A1(Nm)\n0,1\n1,2\n2,3\n"))


@pytest.mark.parametrize("header", ["t_s,torque_nm", "time(s),Torque_A1(Nm)"])
def test_a_torque_that_was_cut_is_refused(tmp_path: Path, header: str) -> None:
    with pytest.raises(UsageError, match=r"torque\.csv:4: the last line has no end"):
        read_torque(_file(tmp_path, f"{header}\n0,1\n1,2\n2,35.2"[:-2]))


@pytest.mark.parametrize("header", ["t_s,torque_nm", "time(s),Torque_A1(Nm)"])
def test_times_that_fall_back_name_their_line(tmp_path: Path, header: str) -> None:
    text = f"{header}\n0,1\n1,2\n2,3\n1.5,4\n3,5\n"
    with pytest.raises(
        UsageError, match=r"torque\.csv:5: the torque at 1\.5 s does not follow the one at 2 s"
    ):
        read_torque(_file(tmp_path, text))
