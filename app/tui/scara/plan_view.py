"""The bench from above."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.widgets.inks import painted
from catseye.app.tui.widgets.status_bar import STALE_S

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.scara.layout import Layout

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


class PlanView(Widget):
    """Arm, beam and reflectors, to scale."""

    DEFAULT_CSS = """
    PlanView { height: 1fr; min-height: 8; border-subtitle-color: $foreground; }
    """

    def __init__(self, *, id: str | None = None, classes: str | None = None) -> None:
        super().__init__(id=id, classes=classes)
        self.border_title = "From above"
        self._key: object = None
        self._shown = Content("")
        self._last: tuple[EngineState, float] | None = None

    @property
    def shown(self) -> Content:
        """What is painted."""
        return self._shown

    def show(self, engine: EngineState, now_s: float) -> None:
        """Show where everything is."""
        self._last = engine, now_s
        bench, robot, beam = engine.bench, engine.robot, None if engine.bench is None else engine.bench.beam
        since_s = now_s - engine.bench_at_s
        layout = None if bench is None else bench.layout
        joints = None if robot is None else robot.known_joints
        stale = robot is None or not _is_fresh(robot.age_s, since_s)
        beam_ok = beam.beam_ok if beam is not None and _is_fresh(beam.age_s, since_s) else None
        key = (layout, joints, beam_ok, stale, self.size)
        if key == self._key:
            return
        self._key = key
        self._shown = self._drawn(layout, joints, beam_ok, stale=stale)
        self.border_subtitle = _caption(layout, joints, beam_ok, stale=stale)
        self.refresh()

    def on_resize(self) -> None:
        """Fill the new size."""
        if self._last is not None:
            self.show(*self._last)

    def render(self) -> RenderResult:
        """Return the drawing."""
        return self._shown

    def _drawn(
        self, layout: "Layout | None", joints: Sequence[float] | None, beam_ok: bool | None, *, stale: bool
    ) -> Content:
        if layout is None:
            return Content.styled("nothing is known of the bench yet", "dim")
        from catseye.app.tui.scara.plan_drawing import draw_plan

        canvas = draw_plan(layout, joints, beam_ok, self.size.width, self.size.height)
        return painted(canvas.lines(), _STYLES, faded=stale)


def _is_fresh(age_s: float, since_s: float) -> bool:
    return age_s + since_s <= STALE_S


def _caption(
    layout: "Layout | None", joints: Sequence[float] | None, beam_ok: bool | None, *, stale: bool
) -> str:
    """Return the beam's state as word and sign."""
    if layout is None:
        return ""
    if joints is None:
        return "arm unknown"
    if stale:
        return "arm as it was: old"
    beam = {True: "── beam ok", False: "╌╌ NO BEAM", None: "╌╌ beam unknown"}[beam_ok]
    return f"{beam} → {layout.aim}" if layout.aim else beam
