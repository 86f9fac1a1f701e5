"""The arm as it stands, to scale: a SCARA with its beam from above, any other from the side and from above."""

from textual.app import RenderResult
from textual.content import Content
from textual.geometry import Size
from textual.widget import Widget

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from catseye.app.tui.widgets.picture import Picture, Seen
from catseye.app.tui.widgets.status_bar import STALE_S


class BenchView(Widget):
    """The arm as it stands, drawn anew only where it or the size has changed."""

    DEFAULT_CSS = """
    BenchView { height: 1fr; min-height: 8; border-subtitle-color: $foreground; }
    """

    def __init__(self, *, id: str | None = None, classes: str | None = None) -> None:
        super().__init__(id=id, classes=classes)
        self.border_title = "Arm"
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
        seen = _seen(engine, now_s)
        key = (seen, self.size)
        if key == self._key:
            return
        self._key = key
        picture = _picture(seen, self.size)
        set_title(self, picture.title)
        set_subtitle(self, picture.caption)
        self._shown = picture.drawing
        self.refresh()

    def on_resize(self) -> None:
        """Fill the new size."""
        if self._last is not None:
            self.show(*self._last)

    def render(self) -> RenderResult:
        """Return the drawing."""
        return self._shown


def _seen(engine: EngineState, now_s: float) -> Seen:
    bench, robot, beam = engine.bench, engine.robot, None if engine.bench is None else engine.bench.beam
    since_s = now_s - engine.bench_at_s
    return Seen(
        layout=None if bench is None else bench.layout,
        posture=None if bench is None else bench.posture,
        joints=None if robot is None else robot.known_joints,
        names=() if bench is None else tuple(axis.name for axis in bench.axes),
        moving=None if engine.jog is None else engine.jog.moving,
        beam_ok=beam.beam_ok if beam is not None and _is_fresh(beam.age_s, since_s) else None,
        stale=robot is None or not _is_fresh(robot.age_s, since_s),
    )


def _is_fresh(age_s: float, since_s: float) -> bool:
    return age_s + since_s <= STALE_S


def _picture(seen: Seen, size: Size) -> Picture:
    if seen.layout is not None:
        from catseye.app.tui.scara.plan_view import plan_picture

        return plan_picture(seen.layout, seen, size)
    if seen.posture is not None:
        from catseye.app.tui.serial.posture_view import posture_picture

        return posture_picture(seen.posture, seen, size)
    return Picture("Arm", Content.styled("the position of the arm is not known yet", "dim"))
