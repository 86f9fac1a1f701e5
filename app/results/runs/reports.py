"""Stored runs as reports: the list, the timeline of one, whether one is what was written."""

from collections.abc import Sequence
from datetime import datetime
from itertools import groupby

from catseye.app.results.model import (
    Bullets,
    Column,
    Entries,
    Report,
    Section,
    Sign,
    Statement,
    Table,
    section,
)
from catseye.app.results.origin import origin_now
from catseye.app.results.runs.documents import RunEntry, VerificationDocument
from catseye.app.results.runs.summary import summary
from catseye.app.results.runs.timeline import timeline
from catseye.app.store.reader import RunReader


def list_report(runs: Sequence[RunEntry]) -> Report:
    """Return the stored runs, one a row."""
    keys = ("id", "started", "procedure", "status", "to go on")
    rows = tuple(
        (run.id, run.started, run.procedure, run.status, f"catseye resume {run.id}" if run.resumable else "")
        for run in runs
    )
    table = Table("runs", "Runs", tuple(Column(key, key) for key in keys), rows)
    return Report("Runs", origin_now(), (section("runs", "Runs", [table], brief=True),))


def story_report(reader: RunReader, found: Sequence[Section] = ()) -> Report:
    """Return summary and timeline of a run, one section a day.

    Args:
        found: what the run found, between both.
    """
    days = groupby(timeline(reader), key=lambda moment: moment.time_utc[:10])
    sections = [
        _timeline_section(day, [(_time_of_day(moment.time_utc), moment.text) for moment in moments])
        for day, moments in days
    ]
    return Report(
        f"{reader.path.name}: {reader.status}",
        origin_now(simulated=bool(reader.meta.get("simulated")), unverified=reader.unverified),
        (section("summary", "Summary", [Entries(tuple(summary(reader)))], brief=True), *found, *sections),
    )


def verification_report(verification: VerificationDocument) -> Report:
    """Return whether a run is what was written."""
    compared = "manifest, database" if verification.sealed else "database"
    verdict = (
        Statement(Sign.GOOD, f"{verification.run}: {compared} and sequence numbers agree")
        if verification.sound
        else Statement(Sign.BAD, f"{verification.run} is not what was written")
    )
    blocks = [
        verdict,
        Bullets("", verification.problems) if verification.problems else None,
        *(Statement(Sign.NEUTRAL, f"{verification.run}: {note}") for note in verification.notes),
    ]
    return Report(
        "Verification", origin_now(), (section("verification", "Verification", blocks, brief=True),)
    )


def _timeline_section(day: str, entries: list[tuple[str, str]]) -> Section:
    return section(f"timeline-{day}", f"{day} (UTC)", [Entries(tuple(entries))], brief=True)


def _time_of_day(time_utc: str) -> str:
    time = datetime.fromisoformat(time_utc)
    return f"{time:%H:%M:%S}.{time.microsecond // 100_000}"
