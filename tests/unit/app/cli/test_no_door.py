"""A cell whose door nobody watches gets a warning before anything is driven."""

import re
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.config import validate

_REAL = TEMPLATE.replace("tcp://127.0.0.1:10001", "tcp://192.168.0.20:10001")


@pytest.mark.parametrize(
    ("text", "warned"),
    [
        (TEMPLATE, False),
        (_REAL, True),
        (re.sub(r"\[tracker\][^\[]*", "", TEMPLATE), True),
        (_REAL.replace("[tracker]", '[io]\nendpoint = "tcp://192.168.0.30:502"\n\n[tracker]'), False),
    ],
    ids=["emulated", "real", "tunnel", "door"],
)
def test_a_real_cell_without_a_door_is_warned(
    text: str, warned: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(text, encoding="utf-8")
    validate(cell, as_json=False)
    assert ("no door is watched" in capsys.readouterr().err) == warned
