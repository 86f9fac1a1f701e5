"""Mappings of recordings that other programs wrote."""

from pathlib import Path

import pytest

from catseye.app.errors import ConfigError
from catseye.app.results.mapping import mapping_text, read_mapping
from catseye.app.results.resolution.recording_mapping import (
    RecordingMapping,
    found_mapping,
    read_mapped_recording,
)

_FILE = "Laser 1\n\nZeit (ms);Abstand (µm)\n0,0;1,5\n1,0;-2,5\n2,0;3,5\n"


def _file(tmp_path: Path, text: str, name: str = "laser.csv") -> Path:
    path = tmp_path / name
    path.write_text(text, "utf-8")
    return path


def test_units_come_from_the_headings(tmp_path: Path) -> None:
    path = _file(tmp_path, _FILE)
    columns = read_mapped_recording(path, found_mapping(path))
    assert columns["t_s"] == pytest.approx([0.0, 0.001, 0.002])
    assert columns["displacement_mm"] == pytest.approx([0.0015, -0.0025, 0.0035])
    assert columns.lines.tolist() == [4, 5, 6]


@pytest.mark.parametrize(
    ("unit", "factor"), [("arcsec", 1.0 / 3600.0), ("µrad", 5.729577951308232e-05), ("°", 1.0)]
)
def test_angles_become_degrees(tmp_path: Path, unit: str, factor: float) -> None:
    path = _file(tmp_path, f"t [s],angle [{unit}]\n0,1\n0.1,2\n0.2,3\n")
    assert read_mapped_recording(path, found_mapping(path))["angle_deg"] == pytest.approx(
        [factor, 2 * factor, 3 * factor]
    )


def test_a_mapping_is_read_as_it_was_written(tmp_path: Path) -> None:
    found = found_mapping(_file(tmp_path, _FILE))
    assert read_mapping(RecordingMapping, _file(tmp_path, mapping_text(found), "laser.toml")) == found


def test_a_file_without_times_needs_a_rate(tmp_path: Path) -> None:
    path = _file(tmp_path, "mm\n1.5\n2.5\n3.5\n")
    with pytest.raises(ConfigError, match="no times: state its rate by --rate-hz"):
        found_mapping(path)
    columns = read_mapped_recording(path, found_mapping(path, 100.0))
    assert columns["t_s"] == pytest.approx([0.0, 0.01, 0.02])
    assert columns["displacement_mm"].tolist() == [1.5, 2.5, 3.5]


def test_a_sign_turns_a_recording_round(tmp_path: Path) -> None:
    path = _file(tmp_path, _FILE)
    text = mapping_text(found_mapping(path)).replace('"um", sign = 1', '"um", sign = -1')
    columns = read_mapped_recording(path, read_mapping(RecordingMapping, _file(tmp_path, text, "laser.toml")))
    assert columns["displacement_mm"] == pytest.approx([-0.0015, 0.0025, -0.0035])


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('"um"', '"furlong"', "unknown unit 'furlong'; there are mm, um, nm, cm, m, inch"),
        ('";"', '","', "cannot both be commas"),
        ("t_s", "angle_deg", "angle_deg: unknown unit 'ms'|either displacement_mm or angle_deg"),
        ("header_lines", "header_rows", "unknown key"),
    ],
)
def test_a_wrong_mapping_names_its_key(tmp_path: Path, old: str, new: str, complaint: str) -> None:
    text = mapping_text(found_mapping(_file(tmp_path, _FILE))).replace(old, new)
    with pytest.raises(ConfigError, match=complaint):
        read_mapping(RecordingMapping, _file(tmp_path, text, "laser.toml"))
