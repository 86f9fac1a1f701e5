"""What a cell file hardly means is said by `config validate` and by `doctor`, on the screen and as JSON."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.config import validate
from catseye.app.cli.doctor import doctor
from catseye.app.protocol.examination import DeviceExamination

FLAG = "measurement.dwell_time_s = 408: seconds at each point; usual are 0.2 … 5"


@pytest.fixture(autouse=True)
def no_devices(monkeypatch: pytest.MonkeyPatch) -> None:
    async def nothing_found(_cell: Cell, _only: str | None) -> list[DeviceExamination]:
        return []

    monkeypatch.setattr("catseye.app.service.examination.examine", nothing_found)


def cell_file(folder: Path, dwell_s: str) -> Path:
    path = folder / "cell.toml"
    path.write_text(TEMPLATE.replace("dwell_time_s = 0.5", f"dwell_time_s = {dwell_s}"), encoding="utf-8")
    return path


@pytest.mark.parametrize("command", [validate, doctor])
@pytest.mark.parametrize(("dwell_s", "flagged"), [("408", True), ("0.5", False)])
def test_a_dwell_of_minutes_is_flagged(
    command: Callable[..., None],
    dwell_s: str,
    flagged: bool,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    cell = cell_file(tmp_path, dwell_s)
    command(cell, as_json=False)
    assert (f"warning: {FLAG}" in capsys.readouterr().err) is flagged
    command(cell, as_json=True)
    assert (FLAG in json.loads(capsys.readouterr().out)["warnings"]) is flagged
