"""The bench from above."""

from typing import Any, Final

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.widgets.inks import painted
from catseye.app.tui.widgets.status_bar import STALE_S

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
        bench = engine.bench or {}
        since_s = now_s - engine.bench_at_s
        robot, beam = bench.get("robot"), bench.get("beam")
        stale = not _is_fresh(robot, since_s)
        beam_ok = bool(beam["beam_ok"]) if isinstance(beam, dict) and _is_fresh(beam, since_s) else None
        joints = robot.get("joints") if isinstance(robot, dict) else None
        key = (repr(bench.get("layout")), repr(joints), beam_ok, stale, self.size)
        if key == self._key:
            return
        self._key = key
        self._shown = self._drawn(bench.get("layout"), joints, beam_ok, stale=stale)
        self.border_subtitle = _caption(bench.get("layout"), joints, beam_ok, stale=stale)
        self.refresh()

    def on_resize(self) -> None:
        """Fill the new size."""
        if self._last is not None:
            self.show(*self._last)

    def render(self) -> RenderResult:
        """Return the drawing."""
        return self._shown

    def _drawn(self, layout: Any, joints: Any, beam_ok: bool | None, *, stale: bool) -> Content:
        if not isinstance(layout, dict):
            return Content.styled("no bench is told yet", "dim")
        from catseye.app.tui.widgets.plan_drawing import draw_plan

        canvas = draw_plan(layout, joints, beam_ok, self.size.width, self.size.height)
        return painted(canvas.lines(), _STYLES, faded=stale)


def _is_fresh(part: Any, since_s: float) -> bool:
    age_s = part.get("age_s") if isinstance(part, dict) else None
    return isinstance(age_s, (int, float)) and age_s + since_s <= STALE_S


def _caption(layout: Any, joints: Any, beam_ok: bool | None, *, stale: bool) -> str:
    """Return the beam's state as word and sign."""
    if not isinstance(layout, dict):
        return ""
    if joints is None:
        return "arm unknown"
    if stale:
        return "arm as it was: old"
    beam = {True: "── beam ok", False: "╌╌ NO BEAM", None: "╌╌ beam unknown"}[beam_ok]
    return f"{beam} → {layout['aim']}" if layout.get("aim") else beam
