"""The screen Bench: devices, arm, beam and air as they are now."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar, Final

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content

from catseye.app.tui.bench_text import air_lines, engine_lines, has_air, robot_lines, troubles
from catseye.app.tui.bench_view import BenchView
from catseye.app.tui.dialogs.error_dialog import split_remedy
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.screens.base import MainScreen
from catseye.app.tui.serial.instrument_text import instrument_lines, instrument_title
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.beam_panel import BeamPanel
from catseye.app.tui.widgets.device_list import DeviceList
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from catseye.app.tui.widgets.static_text import StaticText, lines

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import BenchStatus

_NOMINAL: Final = "X, Y: nominal arm"
_OF_BEAMS: Final = frozenset({"view", "unit", "window"})
"""Keys that do nothing where an instrument stands in the place of the beam."""

_LOG_LINES: Final = 8
_OTHER_LINES: Final = 6
"""Of what is said of the engine, besides its newest warnings."""

_TROUBLES: Final = 4
_TROUBLES_LOW: Final = 2


class BenchScreen(MainScreen):
    """The home screen. On a small one the picture of the arm takes the place of the beam, and back, by a key."""

    SCREEN = "bench"

    DEFAULT_CSS = """
    BenchScreen #bench { height: 1fr; scrollbar-size-vertical: 1; }
    BenchScreen #troubles { height: auto; max-height: 6; padding: 0 1; display: none; }
    BenchScreen.-low #troubles { max-height: 3; }
    BenchScreen #parts { height: 1fr; min-height: 11; }
    BenchScreen #left { width: 40; }
    BenchScreen #right { width: 1fr; }
    BenchScreen #robot { height: 1fr; min-height: 6; }
    BenchScreen #air { height: 5; }
    BenchScreen.-high #plan { height: 1.5fr; }
    BenchScreen.-high #robot { height: auto; min-height: 9; }
    BenchScreen #engine { height: 1fr; display: none; }
    BenchScreen.-high #engine { display: block; }
    BenchScreen.-low #plan { display: none; }
    BenchScreen.-low.plan #plan { display: block; }
    BenchScreen.-low.plan BeamPanel { display: none; }
    BenchScreen #instrument { height: auto; display: none; }
    BenchScreen.-instrument #instrument, BenchScreen.-low.-instrument #plan { display: block; }
    BenchScreen.-instrument BeamPanel { display: none; }
    BenchScreen.-huge #right { layout: horizontal; }
    BenchScreen.-huge #plan { height: 1fr; width: 1fr; }
    BenchScreen.-huge BeamPanel { width: 1fr; }
    BenchScreen.-huge.-instrument #right { layout: vertical; }
    BenchScreen.-narrow #parts { layout: vertical; height: auto; }
    BenchScreen.-narrow #left { width: 1fr; height: auto; }
    BenchScreen.-narrow #robot { height: auto; }
    BenchScreen.-narrow #right { height: 14; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("v", "view", "beam / arm", id="bench.view", tooltip="the beam, or the arm to scale"),
        Binding(
            "u",
            "unit",
            "deg / mm",
            show=False,
            id="bench.unit",
            tooltip="shows angular optics as angle or displacement",
        ),
        Binding(
            "exclamation_mark",
            "reset_alarm",
            "reset alarm",
            show=False,
            key_display="!",
            id="bench.reset-alarm",
            tooltip="shows the controller's alarm; y there resets it",
        ),
        Binding(
            "comma",
            "window",
            "10/30/60 s",
            key_display=",",
            id="bench.window",
            tooltip="length of the strip chart",
        ),
    ]

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (76, "-wide"), (180, "-huge")]
        self.VERTICAL_BREAKPOINTS = [(0, "-low"), (36, "-high")]

    def body(self) -> ComposeResult:
        """Devices above; joints and air at the left, beam and the picture of the arm at the right."""
        with VerticalScroll(id="bench", can_focus=False):
            yield DeviceList()
            yield StaticText(id="troubles")
            with Horizontal(id="parts"):
                with Vertical(id="left"):
                    yield _panel("robot", "Robot")
                    yield _panel("air", "Air")
                    yield _panel("engine", "Engine")
                with Vertical(id="right"):
                    yield BeamPanel()
                    yield _panel("instrument", "Tracker")
                    yield BenchView(id="plan", classes="panel")

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do."""
        yield SystemCommand("Beam or arm", "if there is room for one only", self.action_view)
        yield SystemCommand(
            "Reset the alarm", "of the controller; shows its text first", self.action_reset_alarm
        )
        yield SystemCommand("Angle or displacement", "of angular optics", self.action_unit)
        yield SystemCommand("Length of the strip chart", "10, 30 or 60 s", self.action_window)

    def show_state(self, engine: EngineState, now_s: float) -> None:
        """Show the bench."""
        bench, since_s = engine.bench, now_s - engine.bench_at_s
        self.query_one(DeviceList).show(bench, since_s)
        self._show_troubles(bench)
        robot = self.query_one("#robot", StaticText)
        set_subtitle(robot, _NOMINAL if engine.layout is not None else "")
        robot.set_text(lines(*robot_lines(bench, since_s, roomy=self.has_class("-high"))))
        self._show_surroundings(bench, since_s)
        told = self.query_one("#engine", StaticText)
        told.set_text(lines(*engine_lines(engine, max(_LOG_LINES, told.size.height - _OTHER_LINES))))
        self.query_one(BeamPanel).show(engine, now_s)
        self.query_one(BenchView).show(engine, now_s)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the keys of a beam where there is one."""
        offered = action not in _OF_BEAMS or not self.has_class("-instrument")
        return offered and super().check_action(action, parameters)

    def _show_surroundings(self, bench: "BenchStatus | None", since_s: float) -> None:
        """Show the air, and an instrument that measures targets in the place of a beam."""
        alone = bench is not None and bench.is_without_beam
        if alone != self.has_class("-instrument"):
            self.set_class(alone, "-instrument")
            self.refresh_bindings()
        air = self.query_one("#air", StaticText)
        set_title(air, "Air" if bench is None or has_air(bench) else "Door, disk")
        air.set_text(lines(*air_lines(bench, since_s)))
        if bench is not None and bench.instrument is not None:
            shown = self.query_one("#instrument", StaticText)
            set_title(shown, instrument_title(bench.instrument))
            shown.set_text(lines(*instrument_lines(bench.instrument)))

    def action_view(self) -> None:
        """Show the picture of the arm in place of the beam, or the beam again."""
        self.toggle_class("plan")
        self.call_after_refresh(self.show_now)

    def action_unit(self) -> None:
        """Show the displacement of angular optics, or their angle again."""
        self.query_one(BeamPanel).next_unit()
        self.show_now()

    def action_window(self) -> None:
        """Show another length of time in the strip."""
        self.query_one(BeamPanel).next_window()
        self.show_now()

    def _show_troubles(self, bench: "BenchStatus | None") -> None:
        found = [] if bench is None else troubles(bench)
        most = _TROUBLES_LOW if self.has_class("-low") else _TROUBLES
        listed = [_trouble_line(*each) for each in (found if len(found) <= most else found[: most - 1])]
        if len(found) > most:
            more = f"✗ and {len(found) - len(listed)} more: Enter shows all about a device"
            listed.append(Content.styled(more, "$error"))
        shown = self.query_one("#troubles", StaticText)
        shown.display = bool(listed)
        shown.set_text(lines(*listed))


def _trouble_line(name: str, text: str) -> Content:
    cause, remedy = split_remedy(text)
    return Content.assemble(
        (f"✗ {name}: ", "$error bold"), cause, (f" → {remedy}" if remedy else "", "$success")
    )


def _panel(name: str, title: str) -> StaticText:
    panel = StaticText(id=name, classes="panel")
    set_title(panel, title)
    return panel
