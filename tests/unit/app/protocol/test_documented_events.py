"""The events in docs/engine.md have the keys that an engine writes."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from catseye.app.protocol.events import encode_event, event_of

_PAGE = Path(__file__).parents[4] / "docs" / "engine.md"
_BLOCK = re.compile(r"^```\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def examples() -> list[dict[str, Any]]:
    """Return the events of the page; what an example leaves out (`, …`) is left out here too."""
    found = []
    for block in _BLOCK.findall(_PAGE.read_text(encoding="utf-8")):
        for message in re.split(r"^[←→] ", block, flags=re.MULTILINE)[1:]:
            fields = json.loads(message.replace(", …", ""))
            if "event" in fields:
                found.append(fields)
    return found


def keys(value: object) -> object:
    """Return a value's keys at every depth."""
    if isinstance(value, dict):
        return {key: keys(inner) for key, inner in value.items()}
    return [keys(inner) for inner in value] if isinstance(value, list) else None


@pytest.mark.parametrize("example", examples(), ids=lambda example: str(example["event"]))
def test_documented_events_have_every_key(example: dict[str, Any]) -> None:
    # The page shows a part of the layout only.
    example.pop("layout", None)
    written = json.loads(encode_event(event_of({**example, "layout": None})))
    written.pop("layout", None)
    assert keys(written) == keys(example)
