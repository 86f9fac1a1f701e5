"""What the record of a run under way says that began before this client came."""

from pathlib import Path
from typing import Final

from catseye.app.tui.run_state import NOT_LOGGED, LogLine, SoFar

_LEVELS: Final = {"warning": "warning", "error": "error", "beam-lost": "warning", "step-dropped": "warning"}


def read_record(path: Path) -> SoFar:
    """Return what a record holds; it opens files, so call it in a thread.

    Raises:
        StorageError: it cannot be read.
    """
    from catseye.app.protocol.procedures import declared_by
    from catseye.app.results.runs.event_text import event_text, texts_of
    from catseye.app.results.runs.rehearsal_command import rehearsal_command
    from catseye.app.store.reader import RunReader

    reader = RunReader(path)
    events, procedure = reader.events(), reader.procedure
    texts, declared = texts_of(procedure), declared_by(procedure)
    log = [
        LogLine(event.time_utc, _LEVELS.get(event.kind, "info"), text)
        for event in events
        if event.kind not in NOT_LOGGED and (text := event.text or event_text(event, texts))
    ]
    return SoFar(
        steps=[(step.step_id, step.title) for step in reader.steps()],
        points=sum(
            reader.count(kind.table) for kind in (declared.records if declared else ()) if kind.is_point
        ),
        log=log,
        command=rehearsal_command(reader.meta, path.parent),
        speed=reader.clock_speed,
    )
