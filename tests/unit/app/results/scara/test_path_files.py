"""Path files: several lines, drawn segments, and what is wrong with them."""

import cmath
from pathlib import Path

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.protocol.procedures import parse_params
from catseye.app.results.scara.path_csv import read_path_csv
from catseye.app.results.scara.path_range import lines_text
from catseye.app.results.scara.path_start import start_text
from catseye.procedures.scara.path.validation_path import PathParams, ValidationPath
from tests.unit.app.cli.arms import text_file
from tests.unit.procedures.benches import bench
from tests.unit.rooms import ROOT

NOMINAL = (325.0, 225.0)

CONTOUR = """
[[segment]]
kind = "line"
from = [250.0, -100.0]
to = [250.0, 100.0]
points = 5
[[segment]]
kind = "circle"
centre = [300.0, 0.0]
radius_mm = 50
points = 9
speed_mm_s = 40
"""


def test_lines_in_one_file_have_their_states_each(tmp_path: Path) -> None:
    up, down = "250,-100\n250,0\n250,100\n", "300,100\n300,0\n300,-100\n"
    both = "line,x_mm,y_mm\n" + "".join(
        f"{number},{row}\n" for number, rows in ((4, up), (7, down)) for row in rows.splitlines()
    )
    path = read_path_csv(text_file(tmp_path, both), NOMINAL, start=None)
    assert path.line.tolist() == [4, 4, 4, 7, 7, 7]
    for rows, text in ((np.arange(3), up), (np.arange(3, 6), down)):
        for start in (None, (1, -1)):
            alone = read_path_csv(text_file(tmp_path, "x_mm,y_mm\n" + text), NOMINAL, start=start).commands
            found = read_path_csv(text_file(tmp_path, both), NOMINAL, start=start).commands.select(rows)
            np.testing.assert_array_equal(found.theta1_rad, alone.theta1_rad)
            np.testing.assert_array_equal(found.direction1, alone.direction1)
            np.testing.assert_array_equal(found.direction2, alone.direction2)


def test_a_line_is_entered_in_its_own_direction(tmp_path: Path) -> None:
    text = "line,x_mm,y_mm\n1,250,-100\n1,250,100\n2,250,100\n2,250,-100\n"
    along = read_path_csv(text_file(tmp_path, text), NOMINAL, start=None).commands
    assert along.direction1.tolist() == [1, 1, -1, -1]
    stated = read_path_csv(text_file(tmp_path, text), NOMINAL)
    assert stated.commands.direction1.tolist() == [1, 1, 1, -1]
    said = start_text(stated.commands, stated.numbers)
    assert "line 2 goes on the other way" in said
    assert "--start-direction=along" in said


def test_segments_are_read_as_positions(tmp_path: Path) -> None:
    path = read_path_csv(text_file(tmp_path, CONTOUR, "path.toml"), NOMINAL)
    assert path.line.tolist() == [1] * 5 + [2] * 9
    circle = [complex(x, y) for x, y in path.command_mm[5:]]
    expected = [300.0 + cmath.rect(50.0, 2.0 * cmath.pi * number / 8.0) for number in range(9)]
    assert circle == pytest.approx(expected, abs=1e-9)
    assert list(path.rows[0].cells) == ["line", "x_mm", "y_mm", "speed_mm_s"]
    assert list(path.rows[1].cells.values()) == ["1", "250", "-50", ""]
    assert lines_text(path.places, np.ones(14, dtype=np.bool_)) == "segments 1–2"


def test_the_shipped_trajectories_can_be_driven_there_and_back() -> None:
    file = ROOT / "docs" / "examples" / "trajectories.toml"
    path = read_path_csv(file, NOMINAL, start=None)
    for number in (1, 2, 3, 4, 5):
        own = path.command_mm[path.line == number]
        np.testing.assert_allclose(own, own[::-1], atol=1e-9)
        # The turning point is driven to twice: at the end of one way, and at the beginning of the other.
        assert np.ptp(own, axis=0).min() == pytest.approx(0.0, abs=1e-9)
    first = path.command_mm[path.line == 1]
    assert first[:, 0] == pytest.approx(200.0)
    assert (first[0, 1], first[:, 1].max()) == (-500.0, 500.0)
    assert path.command_mm[path.line == 3, 1] == pytest.approx(380.0)
    theta = np.rad2deg([path.commands.theta1_rad, path.commands.theta2_rad])
    assert (theta[0].min() > -140.0, theta[0].max() < 60.0) == (True, True)
    outside = (theta[1] < 0.0) | (theta[1] > 140.0)
    # Only near (200, 0) mm J2 leaves the paper's nodes.
    assert np.abs(path.command_mm[outside] - [200.0, 0.0]).max() < 70.0
    params = parse_params(PathParams, [f"path={file}", "instrument=file"])
    assert isinstance(params, PathParams)
    assert len(ValidationPath().plan(bench(), params).points) == len(theta[0])


def test_height_and_orientation_are_read(tmp_path: Path) -> None:
    text = "line,x_mm,y_mm,z_mm,c_deg\n1,250,-100,40,90\n1,250,100,45,90\n"
    tool = read_path_csv(text_file(tmp_path, text), NOMINAL).tool
    assert tool.z_mm is not None
    assert tool.c_deg is not None
    assert (tool.z_mm.tolist(), tool.c_deg.tolist()) == ([40.0, 45.0], [90.0, 90.0])


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (
            CONTOUR.replace("points = 5", "points = 0"),
            r"path\.toml: segment 1: points = 0: .*both ends included",
        ),
        (
            CONTOUR.replace("to = [250.0, 100.0]\n", ""),
            r"path\.toml: segment 1: to is missing; write x and y",
        ),
        (CONTOUR.replace("points = 9", "point = 9"), r"path\.toml: segment 2: point is not a valid key"),
        (CONTOUR.replace('"circle"', '"spline"'), r'segment 2: kind has to be "line", "arc" or "circle"'),
        (CONTOUR.replace("radius_mm = 50", "radius_mm = 270"), r"segment 2: the position .* is out of reach"),
        (CONTOUR.replace("radius_mm = 50", "radius_mm = -5"), r"segment 2: radius_mm = -5: "),
        ("", r"path\.toml: segment is missing: write \[\[segment\]\] tables"),
        ("segment = 3", r"path\.toml: segment = 3: "),
        ("[[segment", r"path\.toml: "),
        (
            '[[segment]]\nkind = "line"\nfrom = [0.25, -0.1]\nto = [0.25, 0.1]\n',
            r"path\.toml: the positions of the segments seem to be in m: .*convert them to mm",
        ),
    ],
)
def test_a_drawing_that_cannot_be_used_names_its_segment(tmp_path: Path, text: str, part: str) -> None:
    with pytest.raises(UsageError, match=part):
        read_path_csv(text_file(tmp_path, text, "path.toml"), NOMINAL)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("line,x_mm,y_mm\n1,250,0\n2,300,0\n1,250,9\n", r"path\.csv:4: line 1 was left before"),
        ("line,x_mm,y_mm\nA,250,0\n", r"path\.csv:2: line = 'A' is not an integer"),
        ("line,x_mm,y_mm,z_mm\n1,250,0,\n", r"path\.csv:2: z_mm = '' is not a finite number"),
        ("x_mm,y_mm,theta1_deg\n1,2,3\n", "joint and Cartesian commands stand in one file"),
    ],
)
def test_lines_that_cannot_be_used_name_their_row(tmp_path: Path, text: str, part: str) -> None:
    with pytest.raises(UsageError, match=part):
        read_path_csv(text_file(tmp_path, text), NOMINAL)
