"""Files of trackers: read by a mapping, suggested by a preview, refused by what a wrong one makes of them."""

import json
import math
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomlkit

from catseye.app.cli.scara.validate import Wanted, validate_path
from catseye.app.errors import UsageError
from catseye.calibration.core.types import Floats
from tests.unit.app.cli.arms import bare, stored, text_file
from tests.unit.app.cli.test_validate import Command, in_frame, true_place

Row = Callable[[int, float, float, float], str]
"""Number and coordinates in mm to a line."""


def loop() -> list[Command]:
    """Return commands round a loop in the plane of the joints, each joint both ways."""
    there = [(8.0 + 6.0 * i, 100.0 - 7.0 * i, 1, -1) for i in range(12)]
    back = [(there[-1][0] - 6.0 * i, there[-1][1] + 5.0 * i, -1, 1) for i in range(12)]
    return there + back


def path_file(folder: Path, commands: Sequence[Command] = tuple(loop())) -> Path:
    lines = ["theta1_deg,theta2_deg,direction1,direction2", *(",".join(map(str, one)) for one in commands)]
    return text_file(folder, "\n".join(lines) + "\n", "path.csv")


def seen_mm(tilt_deg: float = 2.0) -> Floats:
    """Return the true places in the frame of a tracker that stands tilted about its y axis, by hand."""
    cosine, sine = math.cos(math.radians(tilt_deg)), math.sin(math.radians(tilt_deg))
    flat = [(*in_frame(true_place(one)), -640.0) for one in loop()]
    return np.array([(cosine * x + sine * z, y, -sine * x + cosine * z) for x, y, z in flat])


def spatial_analyzer(number: int, x: float, y: float, z: float) -> str:
    return f"P{number}, {x:.6f}, {y:.6f}, {z:.6f}"


def polyworks(number: int, x: float, y: float, z: float) -> str:
    return f'"point {number}";{x:.6f};{y:.6f};{z:.6f};ok'.replace(".", ",")


def leica(number: int, x: float, y: float, z: float) -> str:
    return f"{number:4d}   {x / 1e3:.9f}  {y / 1e3:.9f} {z / 1e3:.9f}  10:21:33"


def inches(number: int, x: float, y: float, z: float) -> str:
    return f"A{number}\t{x / 25.4:.8f}\t{y / 25.4:.8f}\t{z / 25.4:.8f}"


def instrument_file(folder: Path, row: Row, head: str = "", seen: Floats | None = None) -> Path:
    places = seen_mm() if seen is None else seen
    lines = [row(number, *place) for number, place in enumerate(places.tolist(), 1)]
    return text_file(folder, head + "\n".join(lines) + "\n", "points.txt")


def suggested(capsys: pytest.CaptureFixture[str], folder: Path, measured: Path) -> tuple[Any, str]:
    """Return the mapping that a preview writes, and what it shows."""
    validate_path(Wanted(stored(folder, bare()), measured), None, preview=True)
    out = capsys.readouterr()
    return tomllib.loads(out.out), out.err


def compared(
    capsys: pytest.CaptureFixture[str], folder: Path, measured: Path, mapping: dict[str, Any]
) -> Any:
    kept = text_file(folder, tomlkit.dumps(mapping), "mapping.toml")
    wanted = Wanted(stored(folder, bare()), measured, mapping=kept, path=path_file(folder), as_json=True)
    validate_path(wanted, None)
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize(
    ("row", "head", "unit"),
    [
        (spatial_analyzer, "// exported from a group\n// Point, X, Y, Z\n", None),
        (polyworks, "Name;X [mm];Y [mm];Z [mm];State\n", None),
        (leica, "", "m"),
        (inches, "Name\tX(inch)\tY(inch)\tZ(inch)\n", None),
    ],
)
def test_files_of_trackers_are_read_as_suggested(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], row: Row, head: str, unit: str | None
) -> None:
    measured = instrument_file(tmp_path, row, head)
    mapping, shown = suggested(capsys, tmp_path, measured)
    assert f"{len(loop())}" in shown
    if unit is not None:
        for column in mapping["columns"].values():
            column["unit"] = unit
    found = compared(capsys, tmp_path, measured, mapping)
    # The tracker stands tilted by 2°, which would leave some 100 µm; in the plane of its points nothing is left.
    assert found["models"][-1]["rms_um"] < 0.01
    assert found["rows"] == len(loop())


def test_a_preview_shows_lines_headings_and_tilt(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    measured = instrument_file(tmp_path, polyworks, "Name;X [mm];Y [mm];Z [mm];State\n")
    mapping, shown = suggested(capsys, tmp_path, measured)
    assert (mapping["separator"], mapping["decimal"], mapping["header_lines"]) == (";", ",", 1)
    assert mapping["columns"]["z_meas_mm"] == {"column": 4, "unit": "mm", "sign": 1}
    assert 'under "Z [mm]"' in shown
    assert "2.000° against x and y" in shown


def test_a_preview_doubts_units_of_no_mapping(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    measured = instrument_file(tmp_path, polyworks, "Name;X [ft];Y [ft];Z [mm];State\n")
    _, shown = suggested(capsys, tmp_path, measured)
    assert 'x_meas_mm is taken in mm, and its heading is "X [ft]"; y_meas_mm is taken' in shown
    assert "z_meas_mm is taken" not in shown


@pytest.mark.parametrize(
    ("headings", "columns"),
    [("x;y;Dist x;Dist y", (1, 2)), ("x nom;y nom;x ist;y ist", (3, 4)), ("x;y;x_Meas;y_Meas", (3, 4))],
)
def test_measured_columns_are_told_by_whole_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], headings: str, columns: tuple[int, int]
) -> None:
    rows = "".join(f"{n},5;{n},25;{n},5;{n},75\n" for n in range(4))
    mapping, _ = suggested(capsys, tmp_path, text_file(tmp_path, f"{headings}\n{rows}", "points.txt"))
    assert tuple(mapping["columns"][name]["column"] for name in ("x_meas_mm", "y_meas_mm")) == columns


def _in_m(columns: Any) -> None:
    for one in columns.values():
        one["unit"] = "m"


def _exchanged(columns: Any) -> None:
    columns["x_meas_mm"], columns["y_meas_mm"] = columns["y_meas_mm"], columns["x_meas_mm"]
    del columns["z_meas_mm"]


def _mirrored(columns: Any) -> None:
    columns["x_meas_mm"]["sign"] = -1
    del columns["z_meas_mm"]


def _height_as_y(columns: Any) -> None:
    columns["y_meas_mm"], columns["z_meas_mm"] = columns["z_meas_mm"], columns["y_meas_mm"]


def _height_alone(columns: Any) -> None:
    _height_as_y(columns)
    del columns["z_meas_mm"]


@pytest.mark.parametrize(
    ("spoilt", "complaint"),
    [
        (_in_m, r'spread 100\d times as far as the commands: they would fit with unit = "mm" in the mapping'),
        (_exchanged, "fit their commands only with x and y exchanged.*in the mapping"),
        (_mirrored, "fit their commands only with x and y exchanged.*sign = -1"),
        (_height_as_y, r"tilted by \d+° against x and y of the mapping: z_meas_mm has to be"),
        (_height_alone, r"spread 0\.\d+ times as far as the commands: they are not those of this path"),
    ],
)
def test_a_wrong_mapping_is_refused_by_what_it_does(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], spoilt: Callable[[Any], None], complaint: str
) -> None:
    measured = instrument_file(tmp_path, spatial_analyzer)
    mapping, _ = suggested(capsys, tmp_path, measured)
    spoilt(mapping["columns"])
    with pytest.raises(UsageError, match=complaint):
        compared(capsys, tmp_path, measured, mapping)


def test_rows_that_are_sorted_by_name_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    by_name = sorted(range(len(loop())), key=lambda number: f"P{number + 1}")
    measured = instrument_file(tmp_path, spatial_analyzer, seen=seen_mm()[by_name])
    mapping, _ = suggested(capsys, tmp_path, measured)
    with pytest.raises(UsageError, match=r"points\.txt:\d+: .* a list that is sorted by name"):
        compared(capsys, tmp_path, measured, mapping)


def test_passes_are_averaged_and_their_number_must_fit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    off = np.array([0.03, -0.04, 0.0])
    measured = instrument_file(
        tmp_path, spatial_analyzer, seen=np.concatenate([seen_mm(0.0) + off, seen_mm(0.0) - off])
    )
    mapping, _ = suggested(capsys, tmp_path, measured)
    found = compared(capsys, tmp_path, measured, mapping | {"u_mm": 0.02})
    assert found["models"][-1]["rms_um"] < 0.01
    # What a tracker's frame, scale and angles are wrong by is the same in each pass; the alignment takes three of 48.
    instrument_um = found["models"][-1]["expected_parts_um"]["instrument"]
    assert instrument_um == pytest.approx(20.0 * math.sqrt((48 - 3) / 24), rel=1e-6)
    short = instrument_file(tmp_path, spatial_analyzer, seen=seen_mm()[:-1])
    with pytest.raises(UsageError, match="holds 23 positions and the path has 24 commands"):
        compared(capsys, tmp_path, short, mapping)


def _mapping(axes: str) -> dict[str, Any]:
    columns = {f"{axis}_meas_mm": {"column": place, "unit": "mm"} for place, axis in enumerate(axes, 2)}
    return {
        "format": "catseye-mapping/1",
        "separator": ",",
        "decimal": ".",
        "header_lines": 0,
        "columns": columns,
    }


@pytest.mark.parametrize("axes", ["xy", "xyz"])
def test_commands_all_in_one_place_are_refused(tmp_path: Path, axes: str) -> None:
    measured = instrument_file(tmp_path, spatial_analyzer, seen=seen_mm()[:4])
    kept = text_file(tmp_path, tomlkit.dumps(_mapping(axes)), "mapping.toml")
    driven = path_file(tmp_path, [loop()[0]] * 4)
    with pytest.raises(UsageError, match=r"path\.csv: all positions lie in one place"):
        validate_path(Wanted(stored(tmp_path, bare()), measured, mapping=kept, path=driven), None)


@pytest.mark.parametrize("axes", ["xy", "xyz"])
def test_measured_positions_all_in_one_place_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], axes: str
) -> None:
    measured = instrument_file(tmp_path, spatial_analyzer, seen=np.tile(seen_mm()[0], (len(loop()), 1)))
    with pytest.raises(UsageError, match=r"points\.txt: all positions lie in one place"):
        compared(capsys, tmp_path, measured, _mapping(axes))


@pytest.mark.parametrize("rows", [1, 2])
def test_a_preview_takes_a_single_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], rows: int
) -> None:
    measured = instrument_file(tmp_path, spatial_analyzer, seen=np.tile(seen_mm()[0], (5, 1)))
    mapping = _mapping("xyz") | {"header_lines": 5 - rows}
    kept = text_file(tmp_path, tomlkit.dumps(mapping), "mapping.toml")
    validate_path(Wanted(stored(tmp_path, bare()), measured, mapping=kept), None, preview=True)
    assert "0.000° against x and y" in capsys.readouterr().err


def test_a_mapping_needs_what_was_driven(tmp_path: Path) -> None:
    measured = instrument_file(tmp_path, spatial_analyzer)
    result = stored(tmp_path, bare())
    with pytest.raises(UsageError, match="holds positions alone: give --path FILE"):
        validate_path(Wanted(result, measured, mapping=tmp_path / "mapping.toml"), None)
    with pytest.raises(UsageError, match="give --mapping, too"):
        validate_path(Wanted(result, measured, path=path_file(tmp_path)), None)


def test_corrected_commands_are_compared_with_their_wish(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of the CSV of compensate the wished places count, and the commands that were driven."""
    header = "x_mm,y_mm,theta1_deg,theta2_deg,direction1,direction2"
    rows = [",".join(map(str, (*true_place(one), *one))) for one in loop()]
    text_file(tmp_path, "\n".join(["# made by catseye", header, *rows]) + "\n", "path.csv")
    measured = instrument_file(tmp_path, spatial_analyzer)
    mapping, _ = suggested(capsys, tmp_path, measured)
    kept = text_file(tmp_path, tomlkit.dumps(mapping), "mapping.toml")
    wanted = Wanted(stored(tmp_path, bare()), measured, mapping=kept, path=tmp_path / "path.csv")
    validate_path(wanted, None)
    assert "driven with corrected commands: 0.0 µm rms (2D) from the wished positions" in (
        capsys.readouterr().err
    )
