"""A SCARA's bench from above."""

from typing import Final

from textual.geometry import Size

from catseye.app.protocol.scara.layout import Layout
from catseye.app.tui.scara.plan_drawing import draw_plan
from catseye.app.tui.widgets.inks import painted
from catseye.app.tui.widgets.picture import Picture, Seen

_STYLES: Final = {
    "arm": "$primary bold",
    "base": "dim",
    "beam-ok": "$success",
    "beam-lost": "$error bold",
    "beam-unknown": "dim",
    "reflector": "$secondary",
    "aimed": "$accent bold",
    "range": "dim",
    "word": "dim",
}


def plan_picture(layout: Layout, seen: Seen, size: Size) -> Picture:
    """Return arm, beam and reflectors from above."""
    canvas = draw_plan(layout, seen.joints, seen.beam_ok, size.width, size.height)
    drawing = painted(canvas.lines(), _STYLES, faded=seen.stale)
    return Picture("From above", drawing, _caption(layout, seen))


def _caption(layout: Layout, seen: Seen) -> str:
    """Return the beam's state as word and sign."""
    if seen.joints is None:
        return "arm unknown"
    if seen.stale:
        return "arm as it was: old"
    beam = {True: "── beam ok", False: "╌╌ NO BEAM", None: "╌╌ beam unknown"}[seen.beam_ok]
    return f"{beam} → {layout.aim}" if layout.aim else beam
