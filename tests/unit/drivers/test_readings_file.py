"""A tracker whose readings come as rows of a text file."""

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from catseye.drivers.roles.errors import (
    HiddenTargetError,
    LinkError,
    ProtocolError,
    RefusedError,
)
from catseye.drivers.roles.text_table import Dialect
from catseye.drivers.tracker.mapped_row import Columns, Mirrored, Row, parse_row
from catseye.drivers.tracker.readings_file import ReadingsFile
from tests.unit.drivers.outcomes import outcome_of
from tests.unit.drivers.peers import StepClock

HEADING = "name;x;y;z\n"
SETTINGS: dict[str, Any] = {"separator": ";", "target_column": 1, "x_column": 2, "y_column": 3, "z_column": 4}
TURNS = {"rx_column": 5, "ry_column": 6, "rz_column": 7}
COMMA = Dialect(",", ".", 1, "utf-8")


class WritingClock(StepClock):
    """Writes into the file while the tracker waits: once a sleep.

    Args:
        writes: what is called in each sleep, one after the other.
    """

    def __init__(self, *writes: Callable[[], None]) -> None:
        super().__init__()
        self._writes = list(writes)

    async def sleep(self, duration_s: float) -> None:
        if self._writes:
            self._writes.pop(0)()
        await super().sleep(duration_s)


def file_at(path: Path, *writes: Callable[[], None], **settings: Any) -> ReadingsFile:
    return ReadingsFile.at(f"file://{path}", WritingClock(*writes), **(SETTINGS | settings))


def awaiting(path: Path, *rows: str, **settings: Any) -> ReadingsFile:
    """Return a tracker into whose file each of the rows comes while it is waited for."""
    return file_at(path, *(partial(append, path, row) for row in rows), **settings)


def write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def append(path: Path, rows: str) -> None:
    with path.open("a", encoding="utf-8") as file:
        file.write(rows)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "readings.csv"
    found.write_text(HEADING + "nest1;1.0;2.0;3.0\n", encoding="utf-8")
    return found


async def test_the_row_that_comes_next_is_the_reading(path: Path) -> None:
    tracker = awaiting(path, "nest1;10.5;-20.25;30\n", "nest1;11;21;31\n")
    await tracker.connect()
    assert (await tracker.point("nest1", 1.0)).place_mm == (10.5, -20.25, 30.0)
    assert (await tracker.point("nest1", 1.0)).place_mm == (11.0, 21.0, 31.0)


async def test_rows_that_nobody_waited_for_are_passed_over(path: Path) -> None:
    tracker = awaiting(path, "nest1;8;8;8\n")
    await tracker.connect()
    append(path, "nest1;7;7;7\n")
    assert (await tracker.point("nest1", 1.0)).place_mm == (8.0, 8.0, 8.0)


async def test_a_list_that_is_exported_anew_is_one_row_longer(path: Path) -> None:
    tracker = file_at(path, partial(write, path, HEADING + "nest1;1.0;2.0;3.0\nnest1;4;5;6\n"))
    assert (await tracker.point("nest1", 1.0)).place_mm == (4.0, 5.0, 6.0)


async def test_a_list_that_is_being_exported_anew_is_no_reading(path: Path) -> None:
    # The file is cut first, and its rows come one after the other.
    whole = HEADING + "nest1;1.0;2.0;3.0\n"
    write(path, whole + "nest1;1.1;2.0;3.0\n")
    parts = [HEADING, whole, whole + "nest1;1.1;2.0;3.0\nnest1;4;5;6\n"]
    tracker = file_at(path, *(partial(write, path, part) for part in parts))
    assert (await tracker.point("nest1", 1.0)).place_mm == (4.0, 5.0, 6.0)


async def test_another_file_counts_once_it_has_come_to_rest(path: Path) -> None:
    other = HEADING + "nest1;7;8;9\n"
    rewriting = [HEADING + "nest1;7;8", other]
    tracker = file_at(path, *(partial(write, path, text) for text in rewriting))
    assert (await tracker.point("nest1", 1.0)).place_mm == (7.0, 8.0, 9.0)


async def test_a_file_may_come_into_being_later(tmp_path: Path) -> None:
    path = tmp_path / "later.csv"
    tracker = awaiting(path, HEADING + "nest1;1;2;3\n")
    await tracker.connect()
    assert (await tracker.point("nest1", 1.0)).place_mm == (1.0, 2.0, 3.0)


async def test_a_row_without_its_end_is_waited_for(path: Path) -> None:
    tracker = awaiting(path, "nest1;1;2;3", "5\n")
    assert (await tracker.point("nest1", 1.0)).place_mm == (1.0, 2.0, 35.0)


async def test_no_row_is_a_hidden_target(path: Path) -> None:
    with pytest.raises(HiddenTargetError, match=r"no row of nest1 came within 3 s: measure it"):
        await file_at(path, row_timeout_s=2.0).point("nest1", 1.0)


@pytest.mark.parametrize(
    ("rows", "text"),
    [
        ("nest2;1;2;3\n", "a row of 'nest2' came while 'nest1' was waited for"),
        ("nest1;1;2;3\nnest1;4;5;6\n", "2 rows came for nest1"),
    ],
)
async def test_rows_that_belong_to_something_else_are_refused(path: Path, rows: str, text: str) -> None:
    with pytest.raises(RefusedError, match=text):
        await awaiting(path, rows).point("nest1", 1.0)


@pytest.mark.parametrize(
    ("rows", "text"),
    [
        ("nest1;1,5;2;3\n", "column 2 holds '1,5', no number with a decimal point"),
        ("nest1;1;2\n", "3 columns, but column 4 is wanted"),
        ("nest1;nan;2;3\n", "column 2 holds 'nan'"),
    ],
)
async def test_rows_that_do_not_fit_the_mapping_are_named(path: Path, rows: str, text: str) -> None:
    with pytest.raises(ProtocolError, match=text):
        await awaiting(path, rows).point("nest1", 1.0)


@pytest.mark.parametrize(
    ("row", "text"),
    [
        ("nest1;1.5;-0.4;0.25\n", "the file seems to be in m: set length_unit"),
        ("nest1;59.055;-15.748;9.8425\n", "the file seems to be in inch: set length_unit"),
        ("nest1;1500;400;250\n", "left-handed frame: set mirrored = 'y'"),
        ("nest1;700;700;700\n", "look which target was measured"),
    ],
)
async def test_the_likely_mistake_is_named(path: Path, row: str, text: str) -> None:
    with pytest.raises(RefusedError, match=text):
        await awaiting(path, row).point("nest1", 1.0, near_mm=(1500.0, -400.0, 250.0))


async def test_units_and_uncertainties_follow_the_mapping(path: Path) -> None:
    row = "nest1;1,5;-0,4;0,25;0,00002\n"
    tracker = awaiting(path, row, length_unit="m", decimal=",", u_column=5, mirrored="z")
    found = await tracker.point("nest1", 1.0)
    assert found.place_mm == pytest.approx((1500.0, -400.0, -250.0))
    assert found.u_mm == pytest.approx((0.02, 0.02, 0.02))


async def test_a_pose_takes_columns_of_rotations(path: Path) -> None:
    with pytest.raises(RefusedError, match="state rx_column"):
        await awaiting(path, "nest1;1;2;3\n").pose("nest1", 0.0)
    tracker = awaiting(path, "nest1;1;2;3;10;20;30\n", **TURNS)
    pose = await tracker.pose("nest1", 0.0)
    assert pose.turn_deg == (10.0, 20.0, 30.0)
    assert (pose.visible, pose.base_visible) == (None, None)


async def test_marks_that_were_seen_have_columns_of_their_own(path: Path) -> None:
    row = "nest1;1;2;3;10;20;30"
    rows = [f"{row};{marks}\n" for marks in ("17;12", "17.5;12", "17;-1")]
    tracker = awaiting(path, *rows, **TURNS, visible_column=8, base_visible_column=9)
    pose = await tracker.pose("nest1", 0.0)
    assert (pose.visible, pose.base_visible) == (17, 12)
    for _ in rows[1:]:
        with pytest.raises(ProtocolError, match="no number of marks"):
            await tracker.pose("nest1", 0.0)


async def test_a_pose_has_the_uncertainties_of_the_settings(path: Path) -> None:
    tracker = awaiting(path, "nest1;1;2;3;10;20;30\n", **TURNS, u_mm=0.02, u_deg=0.01)
    pose = await tracker.pose("nest1", 0.0)
    assert (pose.u_mm, pose.u_deg) == ((0.02, 0.02, 0.02), (0.01, 0.01, 0.01))


angles = st.floats(-180.0, 180.0)


@given(angles, angles, angles, st.sampled_from(["x", "y", "z"]))
def test_a_mirrored_rotation_is_that_of_the_mirrored_body(
    rx: float, ry: float, rz: float, axis: Mirrored
) -> None:
    columns = Columns((1, 2, 3), (4, 5, 6), mirrored=axis)
    row = parse_row(f"0,0,0,{rx!r},{ry!r},{rz!r}", COMMA, columns)
    assert row.turn_deg is not None
    mirror = [-1.0 if name == axis else 1.0 for name in "xyz"]
    turned = Rotation.from_euler("xyz", (rx, ry, rz), degrees=True).as_matrix()
    expected = [[mirror[i] * turned[i][j] * mirror[j] for j in range(3)] for i in range(3)]
    found = Rotation.from_euler("xyz", row.turn_deg, degrees=True).as_matrix()
    assert found.ravel() == pytest.approx([value for line in expected for value in line], abs=1e-9)


near_rows = st.lists(st.one_of(st.floats().map(repr), st.just("1e999")), min_size=3, max_size=3).map(",".join)


@given(st.one_of(st.text(max_size=60), st.text("0123456789.,+-e naif_", max_size=30), near_rows))
def test_any_line_is_a_row_of_its_numbers_or_refused(line: str) -> None:
    row = outcome_of(parse_row, line.replace("\n", " "), COMMA, Columns((1, 2, 3)))
    if isinstance(row, Row):
        assert list(row.place_mm) == [float(cell) for cell in line.split(",")[:3]]
        assert all(map(math.isfinite, row.place_mm))


async def test_the_plane_has_the_place_of_the_next_row(path: Path) -> None:
    found = await awaiting(path, "nest1;1;2;3\n", u_mm=0.02).locate()
    assert (found.x_mm, found.y_mm, found.u_mm) == (1.0, 2.0, 0.02)


async def test_the_doctor_hears_of_the_last_row(path: Path) -> None:
    assert "1 rows, the last nest1 x 1.0000" in (await file_at(path).examine()).facts[0]
    assert "no number" in (await file_at(path, decimal=",").examine()).advice[0]


async def test_a_missing_folder_is_a_link_error(tmp_path: Path) -> None:
    with pytest.raises(LinkError, match="check the path"):
        await file_at(tmp_path / "none" / "readings.csv").connect()


async def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(LinkError, match="is a folder"):
        await file_at(tmp_path).connect()


@pytest.mark.parametrize("endpoint", ["tcp://127.0.0.1:700", "file:", "file://"])
def test_only_a_file_is_an_endpoint(endpoint: str) -> None:
    with pytest.raises(LinkError, match=r"write file:///folder/readings\.csv"):
        ReadingsFile.at(endpoint, StepClock())
