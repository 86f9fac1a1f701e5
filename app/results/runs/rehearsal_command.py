"""The command that rehearses a run once more, from what the run says about itself."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from pydantic import BaseModel, JsonValue, ValidationError

_LONGEST_WORD: Final = 100_000
"""The system takes no longer argument; such a run is not rehearsed again."""


class _Started(BaseModel):
    procedure: str
    configuration_file: str
    params: dict[str, JsonValue]
    aim: str


def rehearsal_command(meta: Mapping[str, object], root: Path) -> tuple[str, ...]:
    """Return the words of `catseye` that rehearse the same run; empty when it does not say enough of itself."""
    try:
        started = _Started.model_validate(meta)
    except ValidationError:
        return ()
    words = ["run", started.procedure, "--cell", started.configuration_file, "--runs", str(root)]
    words += ["--search", "none" if started.aim == "cell file" else started.aim]
    for name, value in started.params.items():
        if value is not None:
            words += ["--param", f"{name}={json.dumps(value, ensure_ascii=False)}"]
    words += ["--dry-run", "--json"]
    return () if max(map(len, words)) > _LONGEST_WORD else tuple(words)
