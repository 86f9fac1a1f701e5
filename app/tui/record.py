"""What the record of a run under way says that began before this client came."""

import json
from pathlib import Path
from typing import Any, Final

from catseye.app.tui.run_state import MAP_KNOWN, NOT_LOGGED, LogLine, MapKnowledge, SoFar

_LEVELS: Final = {"warning": "warning", "error": "error", "beam-lost": "warning", "step-dropped": "warning"}
_LONGEST_WORD: Final = 100_000
"""The system takes no longer argument; such a run is not rehearsed again."""


def read_record(path: Path) -> SoFar:
    """Return what a record holds; it opens files, so call it in a thread.

    Raises:
        StorageError: it cannot be read.
    """
    from catseye.app.results.runs.event_text import event_text
    from catseye.app.store.reader import RunReader

    reader = RunReader(path)
    events = reader.events()
    log = [
        LogLine(event.time_utc, _LEVELS.get(event.kind, "info"), text)
        for event in events
        if event.kind not in NOT_LOGGED and (text := str(event.data.get("text") or "") or event_text(event))
    ]
    return SoFar(
        steps=[(step.step_id, step.title) for step in reader.steps()],
        points=reader.count("points"),
        map_known=[MapKnowledge.of(event.data) for event in events if event.kind == MAP_KNOWN],
        log=log,
        command=rehearsal_of(dict(reader.meta), path.parent),
        speed=float(speed) if isinstance(speed := reader.meta.get("clock_speed"), (int, float)) else None,
    )


def rehearsal_of(meta: dict[str, Any], root: Path) -> tuple[str, ...]:
    """Return the words of `catseye` that rehearse the same run; empty when it does not say enough of itself.

    Args:
        meta: what the run says about itself.
        root: folder of all runs.
    """
    if not {"procedure", "configuration_file", "params", "aim"} <= meta.keys():
        return ()
    words = ["run", str(meta["procedure"]), "--cell", str(meta["configuration_file"]), "--runs", str(root)]
    words += ["--search", "none" if meta["aim"] == "cell file" else str(meta["aim"])]
    for name, value in meta["params"].items():
        if value is not None:
            words += ["--param", f"{name}={json.dumps(value, ensure_ascii=False)}"]
    words += ["--dry-run", "--json"]
    return () if max(map(len, words)) > _LONGEST_WORD else tuple(words)
