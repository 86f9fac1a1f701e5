"""The recording of a test with its plateaus (Fig. 4 of the resolution paper)."""

import numpy as np

from catseye.app.results.figures import Axis, Figure, Line, Mark, Panel, Role
from catseye.app.results.resolution.naming import UNIT_SIGNS, shipped_mark, title
from catseye.app.results.resolution.result import AnyTest

_CAPTION = (
    "Recording of the test, thinned out, and its plateaus: the mean over the last part of each dwell. A step is the "
    "difference of two plateaus."
)


def staircase_figure(test: AnyTest) -> Figure | None:
    """Return the recording of a test with its plateaus; None where the result holds none."""
    stairs = test.staircase
    if stairs is None:
        return None
    start = stairs.t_s[0] if stairs.t_s else 0.0
    middle = np.array(stairs.plateau_t_s) - start
    ends = np.column_stack([middle - 0.5 * stairs.plateau_s, middle + 0.5 * stairs.plateau_s, middle])
    level = np.repeat(np.array(stairs.plateau)[:, None], 3, axis=1)
    # The third point of each breaks the line: plateaus are not joined.
    level[:, 2] = np.nan
    marks: tuple[Mark, ...] = (
        Line(np.array(stairs.t_s) - start, np.array(stairs.position), Role.SCATTER, "recording", width=0.8),
        Line(ends.ravel(), level.ravel(), Role.CHOSEN, "plateaus", width=1.6),
    )
    panel = Panel("", Axis("time / s"), Axis(f"position / {UNIT_SIGNS[test.unit]}"), marks)
    name = title(test)
    return Figure(
        f"staircase-{_word(name)}",
        f"Recording of {name}",
        f"{name}{shipped_mark([test])}. {_CAPTION}",
        ((panel,),),
        aspect=0.4,
    )


def _word(text: str) -> str:
    return "".join(sign if sign.isalnum() else "-" for sign in text.replace("−", "m").replace("+", "p"))
