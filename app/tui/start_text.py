"""What is said of the motions that a start begins."""

from typing import TYPE_CHECKING

from catseye.app.results.rehearsal import first_target_text, totals_text
from catseye.app.tui.widgets.status_bar import override_text

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import RobotStatus
    from catseye.app.protocol.rehearsal import Rehearsal


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
