"""The result of a procedure whose runs no command of the program works on: what it says itself."""

from catseye.app.protocol.procedures import declared_by
from catseye.app.results.model import Section, Sign, Statement, section
from catseye.app.results.runs.event_text import event_text, texts_of
from catseye.app.store.reader import RunReader


def declared_sections(reader: RunReader) -> list[Section]:
    """Return the last of each event that a run was made for, in its procedure's words; none where it has none."""
    procedure = str(reader.meta.get("procedure"))
    declared = declared_by(procedure)
    if declared is None or declared.analyses:
        return []
    texts = texts_of(procedure)
    last = {event.kind: event for event in reader.events()}
    said = [event_text(last[kind], texts) for kind, text in texts.items() if text.shown and kind in last]
    statements = [Statement(Sign.NEUTRAL, text) for text in said if text]
    return [section("result", "Result", statements, brief=True)] if statements else []
