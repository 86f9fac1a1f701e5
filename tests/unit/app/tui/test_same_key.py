"""A key that is a character, or a character with Ctrl, does the same wherever it does something."""

from collections import defaultdict
from typing import Final

from catseye.app.tui.key_table import key_table

JUSTIFIED: Final = {
    "a": {"attach", "control", "link"},
    "f": {"level", "state"},
    "m": {"mode", "hex"},
    "n": {"next", "aim", "device", "no"},
    "e": {"export", "save"},
    "x": {"clear"},
    "ctrl+l": {"enlarge", "shrink"},
    "ctrl+s": {"answer", "go", "start", "save", "use"},
    "ctrl+t": {"test", "again"},
}
"""What differs in name only: taking over, showing one kind only, how it is done or typed, the next of several,
writing a file, a way and its way back, sending a form. `n` is also no, where a procedure asks for yes or no."""

JOGS: Final = frozenset({"jog.axis", "jog.j1", "jog.j2", "jog.j4", "jog.beam", "jog.point"})
"""Keys by which the arm is jogged lie where the fingers lie, and do something only after F8."""


def test_a_letter_has_one_meaning() -> None:
    meanings: dict[str, set[str]] = defaultdict(set)
    for key in key_table():
        if key.name.startswith(tuple(JOGS)):
            continue
        for one in key.keys.split(","):
            if len(one.removeprefix("ctrl+")) == 1 and not one.isdigit():
                meanings[one].add(key.name.rpartition(".")[2])
    two = {
        key: names
        for key, names in meanings.items()
        if len(names) > 1 and not names <= JUSTIFIED.get(key, set())
    }
    assert two == {}
