"""docs/terminal-ui.md lists every key of the program."""

import os
import re
from pathlib import Path

import pytest

from catseye.app.tui.key_table import key_table, key_table_markdown
from catseye.app.tui.main_screens import MAIN_SCREENS

ROOT = Path(__file__).parents[4]
PAGE = ROOT / "docs" / "terminal-ui.md"
PART = re.compile(r"(<!-- keys: [^>]*-->\n).*?(<!-- end of keys -->)", re.DOTALL)


def test_the_page_lists_every_key() -> None:
    """CATSEYE_RENEW_SCREENS=1 writes the table anew."""
    text = PAGE.read_text(encoding="utf-8")
    table = f"{key_table_markdown()}\n"
    if os.environ.get("CATSEYE_RENEW_SCREENS"):
        text = PART.sub(lambda found: f"{found[1]}{table}{found[2]}", text)
        PAGE.write_text(text, encoding="utf-8")
    found = PART.search(text)
    assert found is not None
    assert table in found[0]


def test_no_key_says_the_same_words_twice() -> None:
    assert [
        key.text for key in key_table() if key.text.partition(": ")[0] == key.text.partition(": ")[2]
    ] == []


KEYS_NAMED = {
    ROOT / "app/engine/alarm.py": ("bench.reset-alarm", "! on Bench (F2)"),
    ROOT / "app/results/readiness/need.py": ("bench.reset-alarm", "! on Bench (F2)"),
    ROOT / "app/service/manual/jogging.py": ("jog.override", "= on "),
    ROOT / "app/tui/screens/day.py": ("procedures.start", "Ctrl-S begins it again"),
    ROOT / "app/tui/screens/jog.py": ("jog.aim", "choose a reflector with n"),
    ROOT / "app/tui/jog_text.py": ("jog.aim", '"n  "'),
    ROOT / "app/tui/screens/runs.py": ("runs.verify", "k says what is wrong"),
}
SHOWN_AS = {"exclamation_mark": "!", "equals_sign": "=", "ctrl+s": "Ctrl-S"}


@pytest.mark.parametrize("file", KEYS_NAMED)
def test_keys_named_in_instructions_are_the_bound_ones(file: Path) -> None:
    binding, words = KEYS_NAMED[file]
    keys = {key.name: key.keys for key in key_table()}[binding]
    assert SHOWN_AS.get(keys, keys) in re.split(r"[\s\"]+", words)
    assert words in file.read_text(encoding="utf-8")


def test_key_table_includes_every_screen_and_stop() -> None:
    keys = {key.name: key.keys for key in key_table()}
    assert keys["run.stop"] == "f12"
    assert {name: keys[f"go.{name}"] for name in MAIN_SCREENS} == {
        name: entry.key for name, entry in MAIN_SCREENS.items()
    }
