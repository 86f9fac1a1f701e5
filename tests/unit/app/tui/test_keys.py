"""A user's keys: what may be changed, and what may not."""

from pathlib import Path

import pytest

from catseye.app.errors import ConfigError
from catseye.app.tui.keys import read_keymap


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "keys.toml"


def test_keys_are_read_without_blanks(file: Path) -> None:
    file.write_text('"go.jog" = "f5, j"\n', encoding="utf-8")
    assert read_keymap(file) == {"go.jog": "f5,j"}


@pytest.mark.parametrize(("name", "own"), [("run.stop", "f12"), ("run.ladder", "ctrl+c")])
def test_stop_keys_cannot_be_taken_away(file: Path, name: str, own: str) -> None:
    file.write_text(f'"{name}" = "f11"\n', encoding="utf-8")
    assert read_keymap(file) == {name: f"{own},f11"}


@pytest.mark.parametrize("line", ['"go.jog" = "f12"', '"run.hold" = "h,ctrl+c"', '"app.help" = "f1, f12"'])
def test_stop_keys_cannot_be_given_to_anything_else(file: Path, line: str) -> None:
    file.write_text(line, encoding="utf-8")
    with pytest.raises(ConfigError, match="stops the arm"):
        read_keymap(file)


@pytest.mark.parametrize("name", ["motion.confirm", "run.move", "start.begin", "jog.begin", "terminal.send"])
def test_enter_never_lets_the_arm_move(file: Path, name: str) -> None:
    file.write_text(f'"{name}" = "f8,enter"', encoding="utf-8")
    with pytest.raises(ConfigError, match="Enter never"):
        read_keymap(file)


@pytest.mark.parametrize("line", ['"go.jog" = ""', '"go.jog" = "f5,,j"', '"go.jog" = 5', "go.jog = "])
def test_what_is_no_key_is_reported_with_an_example(file: Path, line: str) -> None:
    file.write_text(line, encoding="utf-8")
    with pytest.raises(ConfigError, match='"f5,j"'):
        read_keymap(file)
