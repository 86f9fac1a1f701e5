"""A controller's password is typed into a masked field, and stands nowhere but in the environment."""

from pathlib import Path

import pytest
from textual.app import App
from textual.widgets import Input

from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from catseye.app.tui.dialogs.form_dialog import Answers, FormDialog
from catseye.app.tui.login import Login
from tests.unit.app.tui.scripted import changed_screen, screen_text

SECRET = "correct horse"


def cell(tmp_path: Path, endpoint: str = "tcp://192.168.125.1:80") -> Path:
    path = tmp_path / "cell.toml"
    path.write_text(TEMPLATES[SIX_AXIS].text.replace("tcp://127.0.0.1:8080", endpoint), encoding="utf-8")
    return path


class Shown:
    """Answers dialogs and counts them."""

    def __init__(self, answers: Answers | None) -> None:
        self.count = 0
        self._answers = answers

    async def __call__(self, _dialog: FormDialog) -> Answers | None:
        self.count += 1
        return self._answers


async def test_answers_stand_in_the_environment(tmp_path: Path) -> None:
    environment: dict[str, str] = {}
    login = Login(environment)
    login.show = Shown({"user": "", "password": SECRET})
    await login.before_engine(cell(tmp_path))
    assert environment["CATSEYE_ABB_PASSWORD"] == SECRET
    assert environment["CATSEYE_ABB_USER"] == "Default User"


async def test_an_empty_password_leaves_that_of_the_factory(tmp_path: Path) -> None:
    environment: dict[str, str] = {}
    login = Login(environment)
    login.show = Shown({"user": "Default User", "password": ""})
    await login.before_engine(cell(tmp_path))
    assert environment == {}


async def test_a_wrong_password_can_be_typed_again(tmp_path: Path) -> None:
    environment: dict[str, str] = {}
    login, path = Login(environment), cell(tmp_path)
    login.show = Shown({"user": "somebody", "password": "wrong"})
    await login.before_engine(path)
    await login.forget(path)
    assert environment == {}
    login.show = Shown({"user": "somebody", "password": SECRET})
    await login.before_engine(path)
    assert environment["CATSEYE_ABB_PASSWORD"] == SECRET


async def test_going_back_is_not_asked_again(tmp_path: Path) -> None:
    environment: dict[str, str] = {}
    login, shown = Login(environment), Shown(None)
    login.show = shown
    await login.before_engine(cell(tmp_path))
    await login.before_engine(cell(tmp_path))
    assert (shown.count, environment) == (1, {})


@pytest.mark.parametrize(
    ("endpoint", "environment"),
    [("tcp://127.0.0.1:8080", {}), ("tcp://192.168.125.1:80", {"CATSEYE_ABB_PASSWORD": "x"})],
)
async def test_nobody_is_asked_for_what_is_known(
    tmp_path: Path, endpoint: str, environment: dict[str, str]
) -> None:
    login, shown = Login(environment), Shown(None)
    login.show = shown
    await login.before_engine(cell(tmp_path, endpoint))
    assert shown.count == 0


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_dialog_as_it_is_seen(tmp_path: Path, size: tuple[int, int]) -> None:
    login, app = Login({}), Empty()

    async def show(dialog: FormDialog) -> Answers | None:
        async with app.run_test(size=size) as pilot:
            await app.push_screen(dialog)
            password = dialog.query_one("#password", Input)
            password.value, password.cursor_blink = "hunter2", False
            await pilot.pause()
            assert not changed_screen(f"login-{size[0]}x{size[1]}", screen_text(app))
        return None

    login.show = show
    await login.before_engine(cell(tmp_path))


async def test_a_tunnel_to_a_real_controller_wants_a_password(tmp_path: Path) -> None:
    path = cell(tmp_path, "tcp://127.0.0.1:8080")
    lines = path.read_text(encoding="utf-8").splitlines()
    # Nothing in the cell file says that the bench is emulated.
    path.write_text("\n".join(one for one in lines if not one.startswith("control =")), encoding="utf-8")
    login, shown = Login({}), Shown(None)
    login.show = shown
    await login.before_engine(path)
    assert shown.count == 1


class Empty(App[None]):
    """Shows the dialog only."""


async def test_what_is_typed_is_never_drawn(tmp_path: Path) -> None:
    environment: dict[str, str] = {}
    login, app = Login(environment), Empty()

    async def show(dialog: FormDialog) -> Answers | None:
        async with app.run_test(size=(100, 30)) as pilot:
            answered: list[Answers | None] = []
            await app.push_screen(dialog, answered.append)
            await pilot.pause()
            dialog.query_one("#password", Input).focus()
            await pilot.press(*("space" if one == " " else one for one in SECRET))
            drawn = app.export_screenshot()
            assert "correct" not in drawn
            assert "•" in drawn
            await pilot.press("enter")
            await pilot.pause()
            return answered[0]

    login.show = show
    await login.before_engine(cell(tmp_path))
    assert environment["CATSEYE_ABB_PASSWORD"] == SECRET


async def test_enter_in_the_user_field_goes_on_to_the_password(tmp_path: Path) -> None:
    environment: dict[str, str] = {}
    login, app = Login(environment), Empty()

    async def show(dialog: FormDialog) -> Answers | None:
        async with app.run_test(size=(100, 30)) as pilot:
            answered: list[Answers | None] = []
            await app.push_screen(dialog, answered.append)
            await pilot.pause()
            dialog.query_one("#user", Input).focus()
            await pilot.press("enter")
            await pilot.pause()
            assert answered == []
            await pilot.press("x", "enter")
            await pilot.pause()
            return answered[0]

    login.show = show
    await login.before_engine(cell(tmp_path))
    assert environment == {"CATSEYE_ABB_USER": "Default User", "CATSEYE_ABB_PASSWORD": "x"}
