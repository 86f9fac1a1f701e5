"""Poses of a calibration are chosen where it is begun, with the index against their number as a picture."""

import asyncio
import json
from collections.abc import Callable
from pathlib import Path

import pytest
from textual.widgets import Input, Select

from catseye.app.protocol.commands import CommandEvent, CommandProgress
from catseye.app.service.command_process import Done
from catseye.app.tui.app import CatseyeApp
from catseye.app.tui.dialogs.form_dialog import FormDialog
from catseye.app.tui.serial.pose_choice import PoseChoice
from catseye.app.tui.widgets.figure_view import FigureView
from catseye.app.tui.widgets.parameter_form import ParameterForm, ParameterRow
from catseye.app.tui.widgets.task_line import TaskLine
from tests.unit.app.tui.screens.surveyed import facts, stage
from tests.unit.app.tui.scripted import (
    ScriptedLink,
    ScriptedWork,
    changed_screen,
    failed,
    make_app,
    settled,
    shown,
    work_of,
)

SIZES = [(80, 24), (120, 40)]
GROWTH = [(10, 3.1e-5), (14, 4.6e-5), (24, 5.9e-5), (38, 6.4e-5), (57, 6.7e-5), (76, 6.8e-5)]
CHOSEN = {
    "output": "poses.csv",
    "index": "O1",
    "value": 6.412e-5,
    "count": 38,
    "measurements": 38,
    "candidates": 5000,
    "drawn": 61000,
    "exchanges": 151,
    "starts": 4,
    "model": "geometric+compliance",
    "parameters": [f"p{k}" for k in range(33)],
    "index_of_count": [{"count": count, "value": value} for count, value in GROWTH],
}


def app_with(tmp_path: Path, names: tuple[str, ...] = ("tracker-calibration",)) -> CatseyeApp:
    cell = tmp_path / "cell.toml"
    app = make_app(ScriptedLink({"cell": str(cell)}), "procedures", cell=cell)
    listed = [facts(name, plan=("met", "limits hold with default parameters")) for name in names]
    said = [*listed, {"cell": "arm-1", "stages": [stage(names[0], "next")]}]
    work_of(app).outcomes["procedures"] = Done((), 0, "\n".join(map(json.dumps, said)), "")
    work_of(app).outcomes["select-poses"] = Done((), 0, json.dumps(CHOSEN), "")
    return app


@pytest.mark.parametrize("size", SIZES)
async def test_the_index_against_poses_is_drawn(
    tmp_path: Path, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    app = app_with(Path())
    async with app.run_test(size=size) as pilot:
        await settled(app, pilot)
        await pilot.press("j")
        text = await settled(app, pilot)
        assert isinstance(app.screen, FormDialog)
        assert not changed_screen(f"procedures-poses-asked-{size[0]}x{size[1]}", text)
        await pilot.press("enter")
        text = await settled(app, pilot)
        assert isinstance(app.screen, PoseChoice)
        assert [figure.key for figure in app.screen.query_one(FigureView).figures] == ["growth"]
        assert "the 38 poses chosen" in text
        assert not changed_screen(f"procedures-poses-{size[0]}x{size[1]}", text)
        words = (
            "select-poses",
            "--cell",
            "cell.toml",
            "--count",
            "38",
            "--candidates",
            "5000",
            "--index",
            "O1",
        )
        assert work_of(app).done[-1] == (*words, "-o", "poses.csv", "--json")


async def test_chosen_poses_are_those_of_the_run(tmp_path: Path) -> None:
    app = app_with(tmp_path)
    async with app.run_test(size=(120, 40)) as pilot:
        await settled(app, pilot)
        await pilot.press("j", "enter")
        await settled(app, pilot)
        await pilot.press("ctrl+s")
        await settled(app, pilot)
        assert app.screen.query_one(ParameterForm).typed["poses"] == str(tmp_path / "poses.csv")


async def test_poses_are_chosen_as_the_form_says(tmp_path: Path) -> None:
    app = app_with(tmp_path)
    typed = {
        "targets": "nest2, nest 3",
        "approach_deg": "3",
        "count": "45",
        "targets_per_pose": "2",
        "model": "geometric",
        "rest_deg": "[0, 0, 0, 0, 30, 0]",
    }
    async with app.run_test(size=(120, 40)) as pilot:
        await settled(app, pilot)
        for name, text in typed.items():
            row = next(one for one in app.screen.query(ParameterRow) if one.parameter == name)
            field = row.query_one("Input, Select")
            assert isinstance(field, Input | Select)
            field.value = text
        await settled(app, pilot)
        await pilot.press("escape", "j")
        text = await settled(app, pilot)
        assert "As the form says" in text
        assert "approach_deg 3" in text
        await pilot.press("enter")
        await settled(app, pilot)
        words = work_of(app).done[-1]
        options = dict(zip(words[1:-1:2], words[2::2], strict=False))
        wanted = {"--count": "45", "--approach": "3", "--targets-per-pose": "2", "--model": "geometric"}
        assert wanted.items() <= options.items()
        assert [words[k + 1] for k, word in enumerate(words) if word == "--target"] == ["nest2", "nest 3"]


async def test_a_wrong_form_chooses_no_poses(tmp_path: Path) -> None:
    app = app_with(tmp_path)
    async with app.run_test(size=(120, 40)) as pilot:
        await settled(app, pilot)
        app.screen.query_one(ParameterForm).fill("approach_deg", "far")
        await settled(app, pilot)
        await pilot.press("escape", "j")
        await settled(app, pilot)
        assert not isinstance(app.screen, FormDialog)


async def test_poses_that_are_left_change_nothing(tmp_path: Path) -> None:
    app = app_with(tmp_path)
    async with app.run_test(size=(120, 40)) as pilot:
        await settled(app, pilot)
        for keys in (["p", "escape"], ["p", "enter", "escape"]):
            await pilot.press(*keys)
            await settled(app, pilot)
        assert app.screen.query_one(ParameterForm).typed == {}


@pytest.mark.parametrize(
    ("field", "typed", "said"),
    [
        ("count", "many", "give whole numbers above 0"),
        ("candidates", "20", "38 poses cannot be chosen from 20 candidates"),
        ("file", "there.csv", "there.csv is there already"),
    ],
)
async def test_wrong_answers_choose_nothing(tmp_path: Path, field: str, typed: str, said: str) -> None:
    (tmp_path / "there.csv").touch()
    app = app_with(tmp_path)
    async with app.run_test(size=(120, 40)) as pilot:
        await settled(app, pilot)
        await pilot.press("j")
        await settled(app, pilot)
        answer = str(tmp_path / typed) if field == "file" else typed
        app.screen.query_one(f"#{field}", Input).value = answer
        await pilot.press("enter")
        assert said in await settled(app, pilot)
        assert "select-poses" not in [words[0] for words in work_of(app).done]


async def test_a_refused_choice_says_why_and_cannot_be_used(tmp_path: Path) -> None:
    app = app_with(tmp_path)
    work_of(app).outcomes["select-poses"] = failed(2, "hardly a pose keeps the rules")
    async with app.run_test(size=(120, 40)) as pilot:
        await settled(app, pilot)
        await pilot.press("j", "enter")
        assert "✗ hardly a pose keeps the rules" in await settled(app, pilot)
        await pilot.press("ctrl+s")
        await settled(app, pilot)
        assert isinstance(app.screen, PoseChoice)


class Choosing(ScriptedWork):
    """A choice that never comes to its end by itself."""

    cancelled = False

    async def do(self, *arguments: str | Path, heard: Callable[[CommandEvent], None] | None = None) -> Done:
        if arguments[0] != "select-poses" or heard is None:
            return await super().do(*arguments, heard=heard)
        heard(CommandProgress(title="exchange", share=0.5, elapsed_s=4.0, left_s=4.0, text="start 2 of 3"))
        try:
            await asyncio.Event().wait()
        except asyncio.CancelledError:
            self.cancelled = True
            raise
        raise AssertionError


async def test_a_choice_shows_progress_and_is_ended_by_escape(tmp_path: Path) -> None:
    app = app_with(tmp_path)
    work = Choosing()
    work.outcomes = work_of(app).outcomes
    app.session.work = work
    async with app.run_test(size=(120, 40)) as pilot:
        await settled(app, pilot)
        await pilot.press("j", "enter")
        await pilot.pause()
        assert "50 %  4 s left  start 2 of 3" in await shown(app, pilot)
        link = app.session.link
        assert isinstance(link, ScriptedLink)
        link.now_s += 5.0
        app.screen.query_one(TaskLine)._show()  # noqa: SLF001  # what its timer does twice a second
        assert "50 %  takes longer than estimated  start 2 of 3" in await shown(app, pilot)
        await pilot.press("escape")
        await settled(app, pilot)
        assert work.cancelled
        assert not isinstance(app.screen, PoseChoice)


async def test_no_poses_are_offered_where_none_are_chosen(tmp_path: Path) -> None:
    app = app_with(tmp_path, ("axis-analysis",))
    async with app.run_test(size=(120, 40)) as pilot:
        await settled(app, pilot)
        await pilot.press("j")
        await settled(app, pilot)
        assert not isinstance(app.screen, FormDialog)
