"""Traces of KUKA controllers; the files are written here from the sheet, by struct and by hand."""

import struct
from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.files.diadem import read_trace

_GLOBAL = (
    "DIAEXTENDED  {{@:ENGLISH\n\n#BEGINGLOBALHEADER\n  1,WINDOWS\n101,NextGenDrive\n{order}#ENDGLOBALHEADER\n"
)
_TIME = (
    "#BEGINCHANNELHEADER\n200,Zeit\n202,s\n210,IMPLIZIT\n220,{count}\n240,1.5\n241,0.012\n#ENDCHANNELHEADER\n"
)
_VALUES = (
    "#BEGINCHANNELHEADER\n200,{name}\n202,[Nm]\n210,EXPLIZIT\n211,TRACE#6.R64\n213,BLOCK\n214,REAL64\n"
    "220,{count}\n221,{column}\n240,{offset}\n241,{factor}\n#ENDCHANNELHEADER\n"
)
_ROWS = ((1.0, 10.0), (2.0, 20.0), (-3.0, 30.0))


def _trace(tmp_path: Path, order: str = "<", key: str = "112,High -> Low\n", count: int = 3) -> Path:
    path = tmp_path / "trace#6.dat"
    path.write_text(
        _GLOBAL.format(order=key)
        + _TIME.format(count=count)
        + _VALUES.format(name="Torque_A1", count=count, column=1, offset=0.5, factor=2.0)
        + _VALUES.format(name="Torque_A2", count=count, column=2, offset=0.0, factor=1.0),
        "latin-1",
    )
    raw = b"".join(struct.pack(f"{order}2d", *row) for row in _ROWS)
    (tmp_path / "trace#6.r64").write_bytes(raw)
    return path


def test_values_are_scaled_and_times_are_counted(tmp_path: Path) -> None:
    time, first, second = read_trace(_trace(tmp_path))
    assert (time.name, time.unit) == ("Zeit", "s")
    assert time.values == pytest.approx([1.5, 1.512, 1.524], abs=1e-12)
    assert (first.name, first.unit, first.values.tolist()) == ("Torque_A1", "Nm", [2.5, 4.5, -5.5])
    assert second.values.tolist() == [10.0, 20.0, 30.0]


@pytest.mark.parametrize(("order", "key"), [(">", "112,Low -> High\n"), ("<", "")])
def test_key_112_says_the_order_of_bytes(tmp_path: Path, order: str, key: str) -> None:
    assert read_trace(_trace(tmp_path, order, key))[2].values.tolist() == [10.0, 20.0, 30.0]


def test_an_unknown_order_of_bytes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"dat:3: .* key 112 is neither High -> Low nor Low -> High"):
        read_trace(_trace(tmp_path, key="112,Middle\n"))


def test_no_values_are_missing(tmp_path: Path) -> None:
    values = read_trace(_trace(tmp_path, key="111,20\n"))[2].values
    assert str(values.tolist()) == "[10.0, nan, 30.0]"


def test_a_missing_partner_is_named(tmp_path: Path) -> None:
    path = _trace(tmp_path)
    (tmp_path / "trace#6.r64").unlink()
    with pytest.raises(UsageError, match=r"TRACE#6\.R64, which does not stand beside it; copy both files"):
        read_trace(path)


@pytest.mark.parametrize(
    ("lost", "complaint"), [(3, "45 bytes are not a whole number"), (8, "holds 5 values, but 3")]
)
def test_a_truncated_partner_is_refused(tmp_path: Path, lost: int, complaint: str) -> None:
    path = _trace(tmp_path)
    partner = tmp_path / "trace#6.r64"
    partner.write_bytes(partner.read_bytes()[:-lost])
    with pytest.raises(UsageError, match=complaint):
        read_trace(path)


def test_a_wrong_count_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="holds 6 values, but 4 rows of 2 channels are 8"):
        read_trace(_trace(tmp_path, count=4))


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("DIAEXTENDED", "PNG", "does not begin with DIAEXTENDED"),
        ("210,IMPLIZIT", "210,WHATEVER", "dat:8: .* key 210 is 'WHATEVER', neither EXPLIZIT"),
        ("214,REAL64", "214,INT16", "key 214 is INT16, a trace has REAL64"),
        ("221,2", "221,7", "key 221 is 7, but 2 channels stand in"),
        ("220,3\n240", "220,-1\n240", "key 220 is -1, no count"),
        ("241,2.0", "241,two", "key 241 holds 'two', no number"),
        ("241,2.0", "241,2_0", "key 241 holds '2_0', no number"),
        ("200,Zeit", "Zeit", "dat:9: 'Zeit' is not a key with a value"),
        ("200,Zeit\n", "", "key 200 is missing"),
    ],
)
def test_a_damaged_header_names_its_line(tmp_path: Path, old: str, new: str, complaint: str) -> None:
    path = _trace(tmp_path)
    path.write_text(path.read_text("latin-1").replace(old, new), "latin-1")
    with pytest.raises(UsageError, match=complaint):
        read_trace(path)


def test_a_header_that_is_cut_off_is_refused(tmp_path: Path) -> None:
    path = _trace(tmp_path)
    path.write_text(path.read_text("latin-1")[:-30], "latin-1")
    with pytest.raises(UsageError, match="dat:28: the header that begins here does not end"):
        read_trace(path)


@pytest.mark.parametrize("key", ["2²1,1", "9" * 5000 + ",1"])
def test_a_key_that_is_no_number_is_named(tmp_path: Path, key: str) -> None:
    path = tmp_path / "trace.dat"
    path.write_text(f"DIAEXTENDED\n#BEGINGLOBALHEADER\n{key}\n#ENDGLOBALHEADER\n", "latin-1")
    with pytest.raises(UsageError, match=r"trace\.dat:3: .* is not a key with a value"):
        read_trace(path)


def test_counted_channels_are_no_longer_than_stored_ones(tmp_path: Path) -> None:
    # Some lines of text would otherwise take a gigabyte.
    path = _trace(tmp_path)
    path.write_text(path.read_text("latin-1").replace("220,3\n240,1.5", "220,134217727\n240,1.5"), "latin-1")
    with pytest.raises(
        UsageError, match=r"dat:8: .* key 220 is 134217727, but no file holds more than 3 values"
    ):
        read_trace(path)
