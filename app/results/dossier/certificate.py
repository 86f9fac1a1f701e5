"""The certificate of a day: one page that states what was found, with what, when, and what it can be traced to."""

from collections.abc import Iterable, Mapping
from datetime import datetime
from typing import Final

from catseye.app.cell.arm import arm_description
from catseye.app.results.dossier.day import Day, StageOfDay
from catseye.app.results.model import (
    Block,
    Column,
    Entries,
    Paragraph,
    Section,
    Sign,
    Statement,
    Table,
    section,
)
from catseye.app.results.numbers import BLANK, counted, fixed, listed, number
from catseye.app.results.runs.records import EnvironmentSummary, Measurement

_NOTE: Final = (
    "U: expanded uncertainty, k = 2, about 95 %; where none stands, none is stated. The results hold for this arm at "
    "the place, loads and temperature of the measurement. How they were found, what limits them and the digests in "
    "full stand on the following pages."
)
_DIGITS: Final = 12
"""Of a digest, which tell files of one day apart; the last section has all of them."""

_WORDS: Final[Mapping[Sign, str]] = {
    Sign.GOOD: "in order",
    Sign.NEUTRAL: "stated",
    Sign.ATTENTION: "with doubts",
    Sign.BAD: "not in order",
}


def certificate(day: Day) -> Section:
    """Return one page for the file."""
    tables = tuple(table for one in day.stages for table in one.worth.tables)
    blocks: list[Block | None] = [
        verdict(day),
        Entries(tuple(_about(day))),
        _instruments(day.measurement),
    ]
    blocks += [_stages(day), *tables, Entries(_SIGNATURES), Paragraph(_NOTE)]
    return section("certificate", "Certificate", blocks)


_SIGNATURES: Final = (("measured by, signature", BLANK), ("approved by, place, date, signature", BLANK))


def verdict(day: Day) -> Statement:
    """Return how far the day has come, and whether anything in it is not in order."""
    by_state = {
        state: [one for one in day.stages if one.stage.state == state]
        for state in ("done", "failed", "next", "later", "left out")
    }
    wrong = [one.stage.name for one in day.stages if one.worth.sign is Sign.BAD]
    doubtful = [one.stage.name for one in day.stages if one.worth.sign is Sign.ATTENTION]
    open_yet = [one.stage.name for one in (*by_state["next"], *by_state["later"])]
    parts = [f"{len(by_state['done'])} of {counted(len(day.stages), 'stage')} done"]
    named = (
        ("not in order", wrong),
        ("not reached", [one.stage.name for one in by_state["failed"]]),
        ("with doubts", doubtful),
        ("open", open_yet),
        ("left out", [one.stage.name for one in by_state["left out"]]),
    )
    parts += [f"{label}: {listed(names, 12)}" for label, names in named if names]
    sign = Sign.BAD if wrong else Sign.ATTENTION if doubtful or open_yet or by_state["failed"] else Sign.GOOD
    return Statement(sign, f"{'; '.join(parts)}.")


def verdict_word(one: StageOfDay) -> str:
    """Return how a stage is judged, in a word; empty where it has found nothing."""
    return _WORDS[one.worth.sign] if one.worth.figure else ""


def figure_text(one: StageOfDay) -> str:
    """Return what a stage found, or why it has found nothing."""
    figure = one.worth.figure or ", ".join(path.name for path in one.stage.files)
    if one.stale:
        return f"{figure}; it no longer counts"
    # What an open stage is for, and why one is left out; of a finished one the run stands beside it.
    return figure or ("" if one.stage.state == "done" else one.stage.text)


def arm_text(day: Day) -> str:
    """Return the name of the arm, and how its controller calls it."""
    stated = day.cell.robot.arm
    name = arm_description(stated).name
    return name if not isinstance(stated, str) or stated == name else f"{name} ({stated})"


def _about(day: Day) -> list[tuple[str, str]]:
    runs = day.measurement.runs
    days = sorted({run.started_utc[:10] for run in runs})
    about = [
        ("cell, arm", f"{day.cell.name}, {arm_text(day)}"),
        ("measured on (UTC)", " … ".join(dict.fromkeys((days[0], days[-1])))),
        ("operator", _listed(run.operator for run in runs)),
        ("measured by", _listed(run.software for run in runs)),
        ("air", _air_text(day.measurement.environment)),
    ]
    corrected = " ".join(day.measurement.compensation)
    return [*about, ("lengths", corrected)] if corrected else about


def _air_text(air: EnvironmentSummary | None) -> str:
    """Return the mean of each quantity with its range; of runs that measure none, a line to be filled in."""
    if air is None:
        return BLANK
    known = (
        ("°C", air.temperature_c, fixed(2)),
        ("hPa", air.pressure_hpa, fixed(2)),
        ("%RH", air.humidity_percent, fixed(1)),
    )
    return "; ".join(
        f"{number(spread.mean, form)} {unit} ({number(spread.lowest, form)} … {number(spread.highest, form)})"
        for unit, spread, form in known
        if spread is not None
    )


def _listed(texts: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(text for text in texts if text)) or BLANK


def _instruments(measurement: Measurement) -> Table | None:
    """Return who answered; what a device cannot say, its calibration, is left to be filled in."""
    titles = ("device", "model", "serial number", "firmware", "", "calibration, valid until")
    keys = ("name", "model", "serial", "firmware", "simulated", "calibration")
    rows = tuple(
        (
            d.name,
            d.model,
            d.serial or BLANK[:6],
            d.firmware,
            "EMULATED" if d.simulated else "real",
            BLANK[:14],
        )
        for d in measurement.devices
    )
    columns = tuple(Column(key, title) for key, title in zip(keys, titles, strict=True))
    return Table("instruments", "Arm and instruments", columns, rows) if rows else None


def _stages(day: Day) -> Table:
    columns = (
        Column("name", "stage"),
        Column("state", "state"),
        Column("verdict", "verdict"),
        Column("figure", "found (U: k = 2)"),
        Column("of", "run or file"),
        Column("started_utc", "begun (UTC)"),
        Column("sha256", "SHA-256"),
    )
    return Table("stages", "Stages of the way", columns, tuple(_row(one, day) for one in day.stages))


def _row(one: StageOfDay, day: Day) -> tuple[str, ...]:
    known = {run.name: run for run in day.measurement.runs}
    digests, times, of = [], [], []
    for path in one.stage.files:
        of.append(path.name)
        digests.append(day.sources.digests.get(path.name, ""))
    # A stage of work on data stands by its files, which name their runs.
    for name in one.runs if one.stage.procedure else ():
        of.append(name.rpartition("_")[2])
        times.append(
            f"{datetime.fromisoformat(known[name].started_utc):%m-%d\u00a0%H:%M}".replace("-", "\u2011")
        )
        digests.append(known[name].files.get("run.sqlite", "not sealed"))
    short = ", ".join(digest[:_DIGITS] for digest in digests)
    figure = figure_text(one)
    return (
        one.stage.name,
        one.stage.state,
        verdict_word(one),
        figure,
        ", ".join(of),
        ", ".join(times),
        short,
    )
