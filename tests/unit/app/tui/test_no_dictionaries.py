"""What the engine, the commands and the store say reaches the terminal UI typed, and never as a dictionary."""

import re
from pathlib import Path

import catseye.app.tui

ROOM = Path(catseye.app.tui.__path__[0])

UNTYPED = re.compile(r"(?:dict|Mapping)\[str, (?:Any|object|Json|JsonValue)\]|\bJsonObject\b")
LOOKED_UP = re.compile(r"(?<!environ)\.get\(\s*f?\"")

FOREIGN = {
    "key_table.py": 1,  # the keys of a class, as Textual keeps them
    "start.py": 1,  # a file that may be anything
    "stopping.py": 1,  # a stop depends on no model
    "setup/emulators.py": 1,  # a file that may be anything
    "scara/reflector_rows.py": 1,  # what is typed into a form
    "screens/procedures.py": 2,  # what is typed into a form
    "widgets/parameter_form.py": 4,  # a JSON schema
}
"""Looks into what is none of this program's messages, by file."""


def test_no_message_is_read_as_a_dictionary() -> None:
    found = {}
    for path in sorted(ROOM.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if looks := [*UNTYPED.findall(text), *LOOKED_UP.findall(text)]:
            found[str(path.relative_to(ROOM))] = len(looks)
    assert found == FOREIGN
