"""The screen Results with a calibrated serial arm: its parts, its keys, another kind of result after it."""

import os
from pathlib import Path

import pytest

from catseye.app.results.serial_arm.result import write_serial_arm
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.widgets.bars import TabLine
from tests.unit.app.results.serial_arm.sample import sample_calibration
from tests.unit.app.tui.screens.test_results import open_app, press
from tests.unit.app.tui.scripted import changed_screen, settled, work_of
from tests.unit.app.tui.stored_results import WRITTEN_S, write_results


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a calibration, the newest result."""
    path = tmp_path / "irb.json"
    write_serial_arm(sample_calibration(), path)
    os.utime(path, (WRITTEN_S + 1e4, WRITTEN_S + 1e4))
    monkeypatch.chdir(tmp_path)
    return tmp_path


async def test_a_calibration_is_shown_by_the_sections_of_its_report(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        text = await press(app, pilot, "enter")
        assert "irb.json · irb120 · geometric+compliance" in text
        assert "missed by 0.146 mm on average, 0.437 mm at most" in " ".join(text.split())
        assert "3.168 mm" in text
        assert "not contain errors of single points" in await press(app, pilot, "3")
        text = await press(app, pilot, "4")
        assert "J2.a_mm" in text
        assert "0.1250" in text
        assert "J2" in await press(app, pilot, "5")
        assert "too few poses" in await press(app, pilot, "6")
        assert "pose 17" in await press(app, pilot, "7")
        assert "J3.d_mm is held" in await press(app, pilot, "8")
        assert "depends on masses" in await press(app, pilot, "9")


async def test_every_part_is_named_on_the_smallest_screen(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(80, 24)) as pilot:
        text = await press(app, pilot, "enter")
        shown = [line.strip() for line in text.splitlines()[3:5]]
        assert shown == [
            "1 Files 2 Verdict 3 Errors 4 Parameters 5 Deviations 6 Models 7 Left out",
            "8 Redundant 9 Masses",
        ]
        await pilot.click(TabLine, offset=(16, 1))
        assert "depends on masses" in await settled(app, pilot)
        assert not changed_screen("results-serial-masses-80x24", await settled(app, pilot))


async def test_report_and_commands_of_a_calibration(bench: Path) -> None:
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        await press(app, pilot, "enter", "p")
        assert work_of(app).done == [("report", str(bench / "irb.json"), "-o", str(bench / "irb.html"))]
        text = await press(app, pilot, "colon")
        assert isinstance(app.screen, TextDialog)
        assert "catseye compensate" in text


async def test_a_result_of_joints_read_back_offers_no_commands(bench: Path) -> None:
    read_back = sample_calibration().model_copy(update={"joints": "read back"})
    write_serial_arm(read_back, bench / "irb.json")
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        assert "joints as read back" in await press(app, pilot, "enter")
        text = " ".join((await press(app, pilot, "colon")).replace("┃", " ").split())
        assert "compensate and ballbar refuse this result" in text
        assert "catseye calibrate --poses POSES.csv" in text
        assert "catseye compensate" not in text


async def test_a_scaras_result_is_shown_after_a_calibration(bench: Path) -> None:
    write_results(bench)
    app = open_app(bench)
    async with app.run_test(size=(120, 40)) as pilot:
        assert "4 Parameters" in await press(app, pilot, "enter")
        text = await press(app, pilot, "1", "down", "enter")
        assert "error-map.json · " in text
        assert "4 Layout" in text
