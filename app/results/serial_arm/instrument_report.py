"""What an instrument is worth: Table V and section 2 of the six-axis paper, from a run of instrument-check."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.figures import Axis, Figure, Panel, Points, Role
from catseye.app.results.model import Bullets, Cell, Column, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, fixed, number
from catseye.app.results.serial_arm.figures import signed_by_target
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.serial_arm.instrument_check import NEST, CheckedLength
from catseye.procedures.serial_arm.length_scatter import scatter_of

_MM = fixed(4)
_SIGNED = fixed(4, signed=True)
_ASPECT = 0.35

_ABOUT = (
    "Scatter of repeats: standard deviation of the place within a face. Two faces: distance of the means of both.",
    "Error of length: measured less that of the certificate or of the tool's file.",
)


def instrument_section(reader: RunReader) -> Section:
    """Return nests and lengths of a check of an instrument; nothing of another run."""
    steps = [step.result for step in reader.steps() if step.step_id.startswith(NEST)]
    nests = [row for row in steps if not row["hidden"]]
    lengths = reader.rows(CheckedLength.table)
    blocks = [_nests(nests), _kinds(lengths), _lengths(lengths)]
    tables = [table for table in blocks if table.rows]
    if not tables:
        return section("instrument", "Instrument", [])
    figures = [*([_nests_figure(nests)] if nests else []), *([_lengths_figure(lengths)] if lengths else [])]
    said = _said(nests, lengths)
    return section("instrument", "Instrument", [said, *tables, Bullets("", _ABOUT), *figures], brief=True)


def _said(nests: Sequence[Row], lengths: Sequence[Row]) -> Statement:
    """Return the worst of what was checked; that of the lengths stands for the whole, else that of the faces."""
    scatter, faces = _largest(nests, "repeatability_mm"), _largest(nests, "two_face_mm")
    length = _largest(lengths, "error_mm")
    parts = [
        f"{text} {value} mm at most"
        for text, value in (("repeats scatter by", scatter), ("both faces differ by", faces))
        if value
    ]
    parts.append(f"lengths are off by {length} mm at most" if length else "no length was checked")
    known = (("lengths off ≤", length), ("faces ≤", faces), ("scatter ≤", scatter))
    short = next((f"{text} {value} mm" for text, value in known if value), "")
    text = "; ".join(parts)
    return Statement(Sign.NEUTRAL, f"{text[0].upper()}{text[1:]}.", short)


def _largest(rows: Sequence[Row], key: str) -> str:
    """Return the largest size of a value as text; empty without any."""
    sizes = [abs(value) for row in rows if (value := _known(row, key)) is not None]
    return number(max(sizes), fixed(3)) if sizes else ""


def _nests_figure(nests: Sequence[Row]) -> Figure:
    """Return scatter and difference of the faces at each nest; those of an instrument with one face alone."""
    kinds = (
        ("repeatability_mm", "scatter of repeats", Role.POSITIVE),
        ("two_face_mm", "two faces", Role.NEGATIVE),
    )
    place = np.arange(len(nests), dtype=np.float64)
    marks = tuple(
        Points(place, np.array([number_of(row, key) for row in nests]), role, label)
        for key, label, role in kinds
        if all(row[key] is not None for row in nests)
    )
    names = tuple(str(row["nest"]) for row in nests)
    panel = Panel("", Axis("", names=names), Axis("mm", low=0.0), marks)
    title = "Repeats and faces at the fixed nests"
    return Figure("instrument-nests", title, f"{title}.", ((panel,),), aspect=_ASPECT)


def _lengths_figure(lengths: Sequence[Row]) -> Figure:
    errors_mm = np.array([number_of(row, "error_mm") for row in lengths])
    standards = [str(row["what"]) for row in lengths]
    return signed_by_target(
        "instrument-lengths", "Errors of length", [("measured", errors_mm)], standards, "error / mm"
    )


def _nests(nests: Sequence[Row]) -> Table:
    columns = (
        Column("nest", "nest"),
        Column("repeatability_mm", "scatter of repeats", "mm", _MM),
        Column("two_face_mm", "two faces", "mm", _MM),
    )
    rows = tuple(
        (str(row["nest"]), number_of(row, "repeatability_mm"), _known(row, "two_face_mm")) for row in nests
    )
    return Table("nests", "Fixed nests", columns, rows)


def _known(row: Row, key: str) -> float | None:
    return None if row[key] is None else number_of(row, key)


def _kinds(lengths: Sequence[Row]) -> Table:
    """Return the errors of length of the scale bar and of the tool, summed up."""
    columns = (
        Column("what", "standard"),
        Column("n", "lengths", "", COUNT),
        Column("mean_mm", "mean error", "mm", _SIGNED),
        Column("std_mm", "standard deviation", "mm", _MM),
        Column("max_mm", "largest", "mm", _MM),
    )
    rows: list[tuple[Cell, ...]] = []
    for what in dict.fromkeys(str(row["what"]) for row in lengths):
        errors = np.array([number_of(row, "error_mm") for row in lengths if row["what"] == what])
        rows.append(
            (what, len(errors), float(errors.mean()), scatter_of(errors), float(np.abs(errors).max()))
        )
    return Table("length-errors", "Errors of length", columns, tuple(rows))


def _lengths(lengths: Sequence[Row]) -> Table:
    columns = (
        Column("ends", "length"),
        Column("what", "standard"),
        Column("laid", "place", "", COUNT),
        Column("measured_mm", "measured", "mm", _MM),
        Column("reference_mm", "known", "mm", _MM),
        Column("error_mm", "error", "mm", _SIGNED),
    )
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (
            f"{row['from_point']}–{row['to_point']}",
            str(row["what"]),
            int(number_of(row, "laid")) or None,
            *(number_of(row, key) for key in ("measured_mm", "reference_mm", "error_mm")),
        )
        for row in lengths
    )
    return Table("lengths", "Lengths", columns, rows)
