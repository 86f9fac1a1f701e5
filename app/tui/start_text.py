"""What is said of a start before it begins: what was chosen, its motions, and what is still lacking."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from catseye.app.render.text import block_lines
from catseye.app.results.readiness.need import Need, alarm_need, links_need
from catseye.app.results.readiness.survey_report import need_statement
from catseye.app.results.rehearsal import brief_text
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.motion_text import row, speed_rows, way_rows
from catseye.app.tui.rehearsing import UNDER_WAY, Verdict

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import Rehearsal
    from catseye.app.protocol.requests import Start

WALK_LINES: Final = (
    "Drives its motions at 10 % and 250 mm/s at most; nothing is measured.",
    "After F8 hold Space on Run (F4); the arm stops when you let go.",
    "This is not an enabling device: keep a hand on the emergency stop.",
    "",
)
"""What a walk-through is."""


def choice_lines(request: "Start", *, aims: bool) -> list[str]:
    """Say what was chosen for a run.

    Args:
        aims: it takes an aim from a search.
    """
    chosen = [f"  {text}" for text in request.params] or ["  every parameter at its default"]
    return [*chosen, f"  aim: {request.search}"] if aims else chosen


def speed_lines(request: "Start") -> list[str]:
    """Say how fast a bench is whose time is not real."""
    return [f"  {request.speed:g} bench seconds in one real second"] if request.speed != 1.0 else []


def bench_needs(engine: EngineState) -> tuple[Need, ...]:
    """Return what every procedure needs of devices and controller as they are now."""
    links = links_need(None if engine.bench is None else engine.bench.devices)
    robot = engine.robot
    if robot is None or not robot.alarm_number:
        return (links,)
    return (links, alarm_need(robot.alarm_number, robot.alarm_text, resets=robot.resets_alarms))


def open_lines(needs: Iterable[Need]) -> list[str]:
    """Say what is lacking."""
    statements = (need_statement(need) for need in needs if need.met != "met")
    return [line for statement in statements for line in block_lines(statement)]


def start_rows(engine: EngineState, verdict: Verdict, now_s: float) -> list[str]:
    """Say where the arm goes first, how far, how fast, at which override, and what the rehearsal found.

    Args:
        now_s: monotonic time, s.
    """
    rehearsal = verdict.rehearsal
    if verdict.state == "refused":
        return [*speed_rows(engine), row("rehearsed", f"✗ {verdict.stale}REFUSED: {verdict.fault}")]
    if rehearsal is None:
        return [*speed_rows(engine), row("rehearsed", f"! {_REHEARSED[verdict.state]}")]
    whole = f"{'! ' if verdict.stale else ''}{verdict.stale}{brief_text(rehearsal)}"
    return [
        *_motion_rows(engine, rehearsal, now_s),
        row("rehearsed", whole),
        *(row("", f"! {text}") for text in rehearsal.warnings),
    ]


def _motion_rows(engine: EngineState, rehearsal: "Rehearsal", now_s: float) -> list[str]:
    """Say where a rehearsed run takes the arm first."""
    step = next((step for step in rehearsal.steps if step.moves), None)
    if step is None:
        return [row("target", "none: the arm stands still; its drives go on")]
    return [*way_rows(engine, step.first or step.end, now_s), *speed_rows(engine)]


_REHEARSED: Final = {"none": "no", "under way": UNDER_WAY, "ended": "no: it was ended before it was complete"}
