"""A rehearsed plan as a report: totals, warnings, questions, the table of its steps."""

from typing import TYPE_CHECKING

from catseye.app.protocol.procedures import point_name
from catseye.app.results.model import Column, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, DURATION, counted, duration_text, fixed, listed
from catseye.app.results.origin import origin_now
from catseye.procedures.kit.records import Record

if TYPE_CHECKING:
    from catseye.app.protocol.rehearsal import Rehearsal, RehearsedQuestion

_QUESTIONS_NAMED = 8


def rehearsal_report(rehearsal: "Rehearsal") -> Report:
    """Return what a plan comes to."""
    return Report(
        f"Rehearsal of {rehearsal.procedure}",
        origin_now(),
        (
            section("steps", "Steps", [step_table(rehearsal)], brief=True),
            section("verdict", "Verdict", _verdict(rehearsal), brief=True),
            section("questions", "Questions", [question_table(rehearsal)] if rehearsal.questions else []),
        ),
    )


def totals_text(rehearsal: "Rehearsal") -> str:
    """Return how much it is, how long it takes and how fast it goes."""
    moves = sum(step.moves for step in rehearsal.steps)
    measurements = sum(step.measurements for step in rehearsal.steps)
    # Of other instruments fixed nests count, too, which are none of the points of a run.
    what = "distance" if point_name(rehearsal.procedure) == Record.point_name else "measurement"
    measured = f"{counted(measurements, what)}, " if measurements else ""
    led = "" if rehearsal.led_deg_s is None else f", led at {rehearsal.led_deg_s:g} deg/s at most"
    miss_mm = rehearsal.miss_mm
    miss = "" if miss_mm is None else f"; the beam misses by {miss_mm:.3f} mm at most where it is kept"
    limits = (
        "the joints' limits hold, max_miss_mm does not"
        if rehearsal.misses_too_far
        else "every limit of the cell file holds"
    )
    return (
        f"{len(rehearsal.steps)} steps, {moves} moves, {measured}"
        f"about {duration_text(rehearsal.total_s, whole=True)} at {rehearsal.override_percent:g} % override{led}; "
        f"fastest joint {rehearsal.joint_deg_s:.1f} deg/s, tool {rehearsal.tool_mm_s:.0f} mm/s{miss}; "
        f"{limits}; nothing was moved"
    )


def brief_text(rehearsal: "Rehearsal") -> str:
    """Return in a line how long it takes, how much is measured, how fast it goes, and how much there is to know."""
    measured = sum(step.measurements for step in rehearsal.steps)
    parts = [
        f"about {duration_text(rehearsal.total_s, whole=True)}",
        counted(len(rehearsal.steps), "step"),
        *([counted(measured, "point")] if measured else []),
        f"at most {rehearsal.joint_deg_s:.1f} deg/s, tool {rehearsal.tool_mm_s:.0f} mm/s",
        counted(len(rehearsal.warnings), "warning") if rehearsal.warnings else "no warning",
    ]
    return ", ".join(parts)


_WHERE_MEASURED = frozenset({"measurements", "beam_mm", "miss_mm"})
"""Columns of plans that measure distances; other plans have nothing to say there."""


def step_table(rehearsal: "Rehearsal") -> Table:
    """Return a line for each step; distances and their beam only where the plan has any."""
    columns = [
        Column("step", "step"),
        Column("moves", "moves", format=COUNT),
        Column("measurements", "points", format=COUNT),
        Column("duration_s", "time", "s", fixed(2)),
        Column("beam_mm", "beam", "mm", fixed(1)),
        Column("miss_mm", "miss", "mm", fixed(3)),
        Column("joint_deg_s", "joint", "deg/s", fixed(1)),
        Column("tool_mm_s", "tool", "mm/s", fixed(0)),
    ]
    if not any(step.measurements or step.miss_mm is not None for step in rehearsal.steps):
        columns = [column for column in columns if column.key not in _WHERE_MEASURED]
    ends = [Column(joint.name, joint.name, joint.unit, fixed(3)) for joint in rehearsal.joints]
    rows = ((*(getattr(step, column.key) for column in columns), *step.end) for step in rehearsal.steps)
    return Table("steps", "Steps", (*columns, *ends), tuple(rows))


def question_table(rehearsal: "Rehearsal") -> Table:
    """Return what will be asked, each question once."""
    columns = (Column("id", "question"), Column("after_s", "after", format=DURATION), Column("text", "text"))
    rows = tuple((one.id, one.after_s, one.text) for one in _first_asked(rehearsal))
    return Table("questions", "Questions", columns, rows)


def _first_asked(rehearsal: "Rehearsal") -> "list[RehearsedQuestion]":
    """Return each question once."""
    found: dict[str, RehearsedQuestion] = {}
    for question in rehearsal.questions:
        found.setdefault(question.id, question)
    return list(found.values())


def _verdict(rehearsal: "Rehearsal") -> list[Statement]:
    asked = [
        f"{question.id} after {duration_text(question.after_s, whole=True)}"
        for question in _first_asked(rehearsal)
    ]
    statements = [Statement(Sign.ATTENTION, text) for text in rehearsal.warnings]
    statements.append(Statement(Sign.NEUTRAL, totals_text(rehearsal)))
    if asked:
        text = f"{counted(len(asked), 'question')}: {listed(asked, _QUESTIONS_NAMED)}"
        statements.append(Statement(Sign.NEUTRAL, text))
    return statements
