"""What a line of the terminal's input stands for, and which device a name means."""

from pathlib import Path

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.template import TEMPLATE
from catseye.app.cli.terminal import endpoint_of
from catseye.app.errors import UsageError
from catseye.app.protocol.raw_text import LineEnd, encoded


@pytest.mark.parametrize(
    ("line", "end", "data"),
    [
        ("R", "crlf", b"R\r\n"),
        ("R", "cr", b"R\r"),
        ("R", "lf", b"R\n"),
        (r"1;1;STATE\r", "none", b"1;1;STATE\r"),
        (r"\e[A\x00\xFF\t\\n", "none", b"\x1b[A\x00\xff\t\\n"),
        ("", "cr", b"\r"),
        ("µ", "none", b"\xb5"),
    ],
)
def test_text_with_escapes(line: str, end: LineEnd, data: bytes) -> None:
    assert encoded(line, end, as_hex=False) == data


@pytest.mark.parametrize(
    ("line", "fault"),
    [(r"\q", "no escape"), ("a\\", "no escape"), (r"\x1", "no escape"), ("Ω", "no single byte")],
)
def test_text_that_stands_for_no_bytes(line: str, fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        encoded(line, "cr", as_hex=False)


def test_hex_bytes() -> None:
    assert encoded("31 3b0D ff", "none", as_hex=True) == b"1;\r\xff"
    assert encoded("", "cr", as_hex=True) == b"\r"
    with pytest.raises(ValueError, match="no row of hex bytes such as"):
        encoded("31 3", "none", as_hex=True)


@pytest.fixture
def cell(tmp_path: Path) -> Cell:
    path = tmp_path / "cell.toml"
    further = '\n[[device]]\nname = "door"\ndriver = "remote-io"\nendpoint = "tcp://10.0.0.5:502"\n'
    path.write_text(TEMPLATE + further, encoding="utf-8")
    return load_cell(path).cell


def test_devices_by_name(cell: Cell) -> None:
    assert endpoint_of(cell, "interferometer") == cell.interferometer.endpoint
    assert endpoint_of(cell, "robot") == cell.robot.endpoint
    assert endpoint_of(cell, "door") == "tcp://10.0.0.5:502"


@pytest.mark.parametrize(
    ("name", "hint"), [("interferometr", "did you mean interferometer?"), ("x", "there are robot")]
)
def test_an_unknown_device_is_named_with_the_nearest(cell: Cell, name: str, hint: str) -> None:
    with pytest.raises(UsageError, match=hint.replace("?", r"\?")):
        endpoint_of(cell, name)
