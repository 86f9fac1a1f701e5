"""Recordings and moves of other programs."""

import math
from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.results.resolution.input_files import RecordingFile, read_moves, read_recording
from catseye.app.results.resolution.preview import preview, preview_report
from catseye.app.results.resolution.recording_mapping import found_mapping
from catseye.calibration.resolution.optics import AngularOptics

_RATE_HZ = 100.0


def _file(tmp_path: Path, text: str, name: str = "laser.csv") -> Path:
    path = tmp_path / name
    path.write_text(text, "utf-8")
    return path


def _recording(tmp_path: Path, header: str, rows: list[tuple[float, float]]) -> Path:
    return _file(tmp_path, "\n".join([header, *(f"{t:.6g},{x:.9g}" for t, x in rows)]) + "\n")


def _samples(count: int = 50) -> list[tuple[float, float]]:
    return [(n / _RATE_HZ, 1e-4 * (n % 7)) for n in range(count)]


def test_displacements_become_angles_by_the_arcsine(tmp_path: Path) -> None:
    path = _recording(tmp_path, "t_s,displacement_mm", [(0.0, 0.0), (0.01, 15.0), (0.02, 2.6146722824297)])
    recording = read_recording(RecordingFile(path, optics=AngularOptics(30.0)))
    assert recording.unit == "rad"
    assert [math.degrees(x) for x in recording.position] == pytest.approx([0.0, 30.0, 5.0], abs=1e-8)
    assert recording.rate_hz == pytest.approx(_RATE_HZ)


def test_displacements_without_optics_stay_displacements(tmp_path: Path) -> None:
    recording = read_recording(RecordingFile(_recording(tmp_path, "t_s,displacement_mm", _samples())))
    assert recording.unit == "mm"
    assert recording.position[3] == pytest.approx(3e-4)


@pytest.mark.parametrize("cut", range(1, 9))
def test_a_row_that_was_cut_does_not_count(tmp_path: Path, cut: int) -> None:
    path = _recording(tmp_path, "t_s,displacement_mm", [(n / _RATE_HZ, 12.345678) for n in range(50)])
    path.write_bytes(path.read_bytes()[:-cut])
    recording = read_recording(RecordingFile(path))
    assert recording.position.tolist() == [12.345678] * 49


def test_angles_are_read_in_degrees(tmp_path: Path) -> None:
    recording = read_recording(
        RecordingFile(_recording(tmp_path, "t_s,angle_deg", [(0.0, 0.0), (0.01, 180.0)]))
    )
    assert recording.position[1] == pytest.approx(math.pi)


def test_a_recording_is_read_by_its_mapping(tmp_path: Path) -> None:
    text = "Zeit (ms);Abstand (µm)\n" + "".join(f"{10 * n},0;{n},5\n" for n in range(30))
    path = _file(tmp_path, text)
    recording = read_recording(RecordingFile(path, found_mapping(path)))
    assert recording.rate_hz == pytest.approx(100.0)
    assert recording.position[:2] == pytest.approx([5e-4, 1.5e-3])


def test_lost_samples_are_noticed(tmp_path: Path) -> None:
    path = _recording(tmp_path, "t_s,displacement_mm", _samples(200)[:20] + _samples(200)[23:])
    recording = read_recording(RecordingFile(path))
    assert [flag.kind for flag in recording.flags] == ["gap"]


def test_a_recording_with_most_samples_missing_names_its_line(tmp_path: Path) -> None:
    path = _recording(tmp_path, "t_s,displacement_mm", [*_samples()[:20], (9.0, 0.0)])
    with pytest.raises(UsageError, match=r"laser.csv:22: .*two recordings may stand in one file"):
        read_recording(RecordingFile(path))


def test_a_rate_that_changes_names_its_line(tmp_path: Path) -> None:
    rows = _samples(100) + [(1.0 + 0.02 * n, 1e-4 * (n % 7)) for n in range(40)]
    with pytest.raises(
        UsageError, match=r"laser.csv:10\d: .*the rate is not uniform; record at a fixed rate"
    ):
        read_recording(RecordingFile(_recording(tmp_path, "t_s,displacement_mm", rows)))


def test_a_stated_rate_is_held_against_the_times(tmp_path: Path) -> None:
    path = _recording(tmp_path, "t_s,displacement_mm", _samples())
    assert read_recording(RecordingFile(path, rate_hz=100.0)).rate_hz == pytest.approx(100.0)
    with pytest.raises(
        UsageError, match=r"laser.csv: the times give 100 samples a second, 1000 Hz are stated"
    ):
        read_recording(RecordingFile(path, rate_hz=1000.0))


def test_a_rate_of_the_mapping_is_held_against_the_times(tmp_path: Path) -> None:
    path = _recording(tmp_path, "t_s,displacement_mm", _samples())
    mapping = found_mapping(path).model_copy(update={"rate_hz": 50.0})
    with pytest.raises(UsageError, match="50 Hz are stated"):
        read_recording(RecordingFile(path, mapping))


def test_times_that_go_back_name_their_line(tmp_path: Path) -> None:
    rows = [*_samples(20), (0.1, 0.0), *_samples()[20:]]
    with pytest.raises(UsageError, match=r"laser.csv:22: .*times have to increase: check whether"):
        read_recording(RecordingFile(_recording(tmp_path, "t_s,displacement_mm", rows)))


def test_a_wrong_rate_names_the_unit_of_the_time(tmp_path: Path) -> None:
    rows = [(1e3 * t, x) for t, x in _samples()]
    with pytest.raises(UsageError, match=r"check the unit of the time column \(s, not ms\)"):
        read_recording(RecordingFile(_recording(tmp_path, "t_s,displacement_mm", rows)))


def test_swapped_columns_are_refused(tmp_path: Path) -> None:
    rows = [(x, t) for t, x in _samples()]
    with pytest.raises(UsageError, match="check whether the columns are swapped"):
        read_recording(RecordingFile(_recording(tmp_path, "t_s,displacement_mm", rows)))


def test_a_displacement_beyond_the_spacing_names_its_line(tmp_path: Path) -> None:
    path = _recording(tmp_path, "t_s,displacement_mm", [*_samples(3), (0.03, 40.0)])
    with pytest.raises(
        UsageError, match=r"laser.csv:5: sample 4: a displacement of 40 mm exceeds the spacing"
    ):
        read_recording(RecordingFile(path, optics=AngularOptics(30.0)))


def test_a_truncated_line_is_named(tmp_path: Path) -> None:
    path = _file(tmp_path, "t_s,displacement_mm\n0.0,0.5\n0.01\n")
    with pytest.raises(UsageError, match=r"laser.csv:3: 1 values, but the header has 2 columns"):
        read_recording(RecordingFile(path))


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("run.rtx", "only the laser's own software reads: export the samples"),
        ("run.rtl", "holds deviations at targets and no times: it is not a recording"),
        ("run.RTA", "holds deviations at targets and no times: it is not a recording"),
        ("run.dat", "is a trace of the controller"),
    ],
)
def test_what_is_no_recording_is_refused(tmp_path: Path, name: str, complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint):
        read_recording(RecordingFile(_file(tmp_path, "", name)))


def test_moves_in_place_of_a_recording_are_named(tmp_path: Path) -> None:
    path = _file(tmp_path, "t_s,command_deg\n1,0.1\n")
    with pytest.raises(UsageError, match="check whether --recording and --moves are swapped"):
        read_recording(RecordingFile(path))


def test_a_recording_in_place_of_moves_is_named(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="check whether --recording and --moves are swapped"):
        read_moves(_recording(tmp_path, "t_s,angle_deg", _samples()))


def test_moves_are_read_in_their_unit(tmp_path: Path) -> None:
    angular = read_moves(_file(tmp_path, "t_s,command_deg\n1,180\n6,-90\n", "deg.csv")).moves
    linear = read_moves(_file(tmp_path, "t_s,command_mm\n1,0.5\n6,0.4\n", "mm.csv")).moves
    assert (angular.unit, angular.command.tolist()) == ("rad", pytest.approx([math.pi, -0.5 * math.pi]))
    assert (linear.unit, linear.command.tolist()) == ("mm", [0.5, 0.4])


def test_moves_that_lead_to_a_test_do_not_count(tmp_path: Path) -> None:
    path = _file(tmp_path, "t_s,command_deg,sequence\n1,0.5,0\n6,0.1,1\n11,-0.1,2\n")
    counted = read_moves(path, there_and_back=True)
    assert counted.moves.time_s.tolist() == [6.0, 11.0]
    assert counted.place(2) == f"{path}:4"
    assert read_moves(path).moves.time_s.tolist() == [1.0, 6.0, 11.0]


def test_moves_that_go_back_in_time_are_refused(tmp_path: Path) -> None:
    path = _file(tmp_path, "# A1\nt_s,command_deg\n5,0.1\n1,0.1\n")
    with pytest.raises(UsageError, match=r"laser.csv:4: move 2 at 1 s does not follow"):
        read_moves(path)


def test_a_preview_shows_rate_and_first_rows(tmp_path: Path) -> None:
    path = _file(tmp_path, "Zeit (ms);Abstand (µm)\n" + "".join(f"{10 * n},0;{n},5\n" for n in range(30)))
    report = preview_report(path, preview(path))
    assert list(report.table("rows").rows[0]) == pytest.approx([2, 0.0, 5e-4])
    assert len(report.table("rows").rows) == 10
    assert preview(path).rate_hz == pytest.approx(100.0)


@pytest.mark.parametrize(("unit", "said"), [("furlong", True), ("MM", False)])
def test_a_preview_doubts_units_of_no_mapping(tmp_path: Path, unit: str, said: bool) -> None:
    path = _file(tmp_path, f"t (s);Abstand ({unit})\n" + "".join(f"{n};{n},5\n" for n in range(30)))
    statements = [one.text for one in preview_report(path, preview(path)).statements()]
    doubt = f'displacement_mm is taken in mm, and its heading is "Abstand ({unit})"'
    assert [doubt in text for text in statements] == ([True] if said else [])


@pytest.mark.parametrize("cut", [1, 2, 3])
def test_moves_that_were_cut_are_refused(tmp_path: Path, cut: int) -> None:
    path = _file(tmp_path, "t_s,command_deg\n1,0.5\n6,0.4123\n"[:-cut], "moves.csv")
    with pytest.raises(UsageError, match=r"moves\.csv:3: the last line has no end"):
        read_moves(path)
