"""Which device of the cell a name means."""

from pathlib import Path

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.terminal import endpoint_of
from catseye.app.errors import UsageError


@pytest.fixture
def cell(tmp_path: Path) -> Cell:
    path = tmp_path / "cell.toml"
    further = '\n[[device]]\nname = "door"\ndriver = "remote-io"\nendpoint = "tcp://10.0.0.5:502"\n'
    path.write_text(TEMPLATE + further, encoding="utf-8")
    return load_cell(path).cell


def test_devices_by_name(cell: Cell) -> None:
    assert endpoint_of(cell, "interferometer") == "tcp://127.0.0.1:10002"
    assert endpoint_of(cell, "robot") == cell.robot.endpoint
    assert endpoint_of(cell, "door") == "tcp://10.0.0.5:502"


@pytest.mark.parametrize(
    ("name", "hint"), [("interferometr", "did you mean interferometer?"), ("x", "there are robot")]
)
def test_an_unknown_device_is_named_with_the_nearest(cell: Cell, name: str, hint: str) -> None:
    with pytest.raises(UsageError, match=hint.replace("?", r"\?")):
        endpoint_of(cell, name)
