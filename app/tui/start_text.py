"""What is said of the motions that a start begins."""

from typing import TYPE_CHECKING

from catseye.app.results.rehearsal import first_target_text, totals_text

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import Rehearsal


def rehearsed_lines(rehearsal: "Rehearsal | None") -> list[str]:
    """Say where the arm goes first, as far as anybody knows.

    Args:
        rehearsal: with the parameters of the start; None where there was none.
    """
    if rehearsal is None:
        return ["! not rehearsed with these parameters: r does that"]
    return [f"  {first_target_text(rehearsal)}", f"  {totals_text(rehearsal)}"]
