"""What is said of a start before it begins: what was chosen, its motions, and what is still lacking."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from catseye.app.render.text import block_lines
from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.survey_report import need_statement
from catseye.app.results.rehearsal import first_target_text, totals_text
from catseye.app.tui.widgets.status_bar import override_text

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import RobotStatus
    from catseye.app.protocol.rehearsal import Rehearsal
    from catseye.app.protocol.requests import Start

WALK_LINES: Final = (
    "Its motions at 10 % and 250 mm/s at most; nothing is measured.",
    "After F8 hold Space on Run (F4); let go and the arm is stopped.",
    "This is no enabling device: keep a hand on the emergency stop.",
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


def open_lines(needs: Iterable[Need]) -> list[str]:
    """Say what is lacking."""
    statements = (need_statement(need) for need in needs if need.met != "met")
    return [line for statement in statements for line in block_lines(statement)]


def motion_lines(robot: "RobotStatus | None", rehearsal: "Rehearsal | None") -> list[str]:
    """Say where the arm goes first, how fast, at which override, as far as anybody knows.

    Args:
        robot: as it was seen last; None before that.
        rehearsal: with the parameters of the start; None where there was none.
    """
    shown = (
        []
        if robot is None
        else [f"  override {override_text(robot)}, at most {robot.override_cap_percent:g} %"]
    )
    if rehearsal is None:
        return [*shown, "! not rehearsed with these parameters: r does that"]
    return [*shown, f"  {first_target_text(rehearsal)}", f"  {totals_text(rehearsal)}"]
