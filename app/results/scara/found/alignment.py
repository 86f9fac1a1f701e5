"""Pitch or offset of the beam, round by round, from a run that guided hands at a screw."""

from collections.abc import Sequence

import numpy as np

from catseye.app.cell.bench import bench_of
from catseye.app.results.figures import Axis, Figure, Level, Mark, Panel, Points, Role
from catseye.app.results.model import Block, Cell, Column, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import EXPANDED, counted, fixed, number
from catseye.app.results.runs.run_source import cell_of_run
from catseye.app.results.scara.figures.alignment import (
    HeightRound,
    TurnRound,
    heights_figure,
    turns_figure,
)
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.expanded import expanded_text
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import integer, number_of, numbers_of
from catseye.procedures.scara.alignment.beam_level import U_HEIGHT_MM, BeamLevel, fitted_height, level_screw
from catseye.procedures.scara.alignment.beam_to_j4 import BeamToJ4, stage_screw
from catseye.procedures.scara.alignment.screws import Screw
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.records import AlignmentRound

_SCREWS = {BeamLevel.name: level_screw, BeamToJ4.name: stage_screw}


def alignment_section(reader: RunReader) -> Section:
    """Return what the beam was off by before and after, against its tolerance; nothing of another run."""
    guided = _SCREWS.get(str(reader.meta.get("procedure")))
    rounds = reader.records(AlignmentRound.kind)
    if guided is None or not rounds:
        return section("alignment", "Alignment", [])
    bench = bench_of(cell_of_run(reader))
    if not isinstance(bench, ScaraBench):
        raise TypeError("a beam is aligned on a SCARA only")
    screw = guided(bench)
    blocks: list[Block | None] = [_verdict(screw, rounds)]
    if (result := reader.result("result")) is not None and "j3_mm" in result:
        blocks.append(_height(result, bench))
    blocks += [_measured(reader, screw, rounds), _table(screw, rounds), _figure(screw, rounds)]
    return section("alignment", "Alignment", blocks, brief=True)


def _measured(reader: RunReader, screw: Screw, rounds: Sequence[Row]) -> Figure | None:
    """Return what first and last round have measured; None of a run of an early version, which did not keep it."""
    results = {step.step_id: step.result for step in reader.steps()}
    taken = [(integer(row["round"]), results.get(str(row["step_id"]), {})) for row in rounds]
    if screw.name == "level":
        heights = [_height_round(number, row) for number, row in taken if "j3_mm" in row]
        return heights_figure(heights[0], heights[-1], screw.tolerance) if heights else None
    turns = [_turn_round(number, row) for number, row in taken if "turn_deg" in row]
    return turns_figure(turns[0], turns[-1], screw.tolerance) if turns else None


def _height_round(number: int, row: Row) -> HeightRound:
    distance_mm, j3_mm = (np.array(numbers_of(row, key)) for key in ("distance_mm", "j3_mm"))
    return HeightRound(number, distance_mm, j3_mm, fitted_height(row), U_HEIGHT_MM)


def _turn_round(number: int, row: Row) -> TurnRound:
    turn_deg, length_mm, series = (
        np.array(numbers_of(row, key)) for key in ("turn_deg", "length_mm", "series")
    )
    offset_mm, curvature_mm = number_of(row, "value"), number_of(row, "curvature_mm")
    return TurnRound(number, turn_deg, length_mm, series.astype(np.int64), offset_mm, curvature_mm)


def _verdict(screw: Screw, rounds: Sequence[Row]) -> Statement:
    first, last = rounds[0], rounds[-1]
    value, u = number_of(last, "value"), number_of(last, "u")
    before = f"{number_of(first, 'value'):+.3f} {screw.unit} before"
    turned = len({row["instruction"] for row in rounds if row["instruction"]})
    known = f"{expanded_text(value, u, 3, signed=True)} {screw.unit} (k = 2)"
    after = f"{known} after {counted(turned, 'turn')} of the screw"
    limit = f"the tolerance is {screw.tolerance:g} {screw.unit}"
    name = _begun(screw.quantity)
    # As it is judged at the bench: with its uncertainty.
    short = f"{value:+.2f} of ±{screw.tolerance:g} {screw.unit}"
    expanded = (
        f"{number(value, fixed(3, signed=True))} {screw.unit}, U = {EXPANDED * u:.3f} {screw.unit}; {limit}"
    )
    if abs(value) + u <= screw.tolerance:
        return Statement(Sign.GOOD, f"{name}: {before}, {after}; {limit}.", short, expanded)
    text = f"{name} not within its tolerance: {before}, {after}; {limit}."
    return Statement(Sign.BAD, text, short, expanded)


def _begun(text: str) -> str:
    """Return a text with a large first letter; the others, as those of an axis, stay."""
    return text[:1].upper() + text[1:]


def _height(result: Row, bench: ScaraBench) -> Statement:
    j3_mm, u_mm = number_of(result, "j3_mm"), number_of(result, "u_j3_mm")
    text = (
        f"The beam meets the height of the reflectors at j3_mm = {expanded_text(j3_mm, u_mm, 2)} mm (k = 2); the "
        f"cell file had {bench.j3_mm:g} mm."
    )
    return Statement(Sign.NEUTRAL, text)


def _table(screw: Screw, rounds: Sequence[Row]) -> Table:
    columns = (
        Column("round", "round"),
        Column("value", screw.quantity, screw.unit, fixed(3, signed=True)),
        Column("u", "U", screw.unit, fixed(3), standard=True),
        Column("instruction", "measured after"),
    )
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (f"{row['round']}", number_of(row, "value"), number_of(row, "u"), str(row["instruction"] or "–"))
        for row in rounds
    )
    return Table("rounds", "Measurements (U: k = 2)", columns, rows)


def _figure(screw: Screw, rounds: Sequence[Row]) -> Figure:
    value = np.array([number_of(row, "value") for row in rounds])
    u = np.array([number_of(row, "u") for row in rounds])
    number = np.arange(1.0, len(rounds) + 1.0)
    marks: tuple[Mark, ...] = (
        Level(0.0, Role.AXIS),
        *(
            Level(sign * screw.tolerance, Role.EXPECTED, dash="dashed", label="tolerance")
            for sign in (-1.0, 1.0)
        ),
        Points(number, value, Role.CHANGE, u=u, joined=True),
    )
    panel = Panel("rounds", Axis("round", counts=True), Axis(f"{screw.quantity} / {screw.unit}"), marks)
    caption = f"The {screw.quantity} at each measurement; error bars: U (k = 2); dashed: the tolerance."
    return Figure("alignment", _begun(screw.quantity), caption, ((panel,),))
