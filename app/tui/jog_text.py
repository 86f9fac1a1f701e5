"""What the screen Jog says."""

from dataclasses import dataclass, field
from typing import Final

from textual.content import Content

from catseye.app.protocol.banners import SIMULATION
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.scara.jog_keys import JOINT_ROWS, NO_AIM, WITH_AIM
from catseye.app.tui.serial.jog_keys import axis_lines
from catseye.app.tui.serial.range_bar import range_bar
from catseye.app.tui.widgets.status_bar import STALE_S, value_style

STEPS: Final = (0.01, 0.1, 1.0, 5.0, 10.0)
"""Sizes of a step, deg; mm for the beam."""

STEPS_ONLY: Final = "steps only: this arm has no continuous jog"
"""Where the driver knows no jog that ends by itself."""

_RANGE_CELLS: Final = 16

PERCENTS: Final = (1, 2, 5, 10, 15, 20, 30, 50, 100)
"""Speed overrides that can be chosen."""


@dataclass
class Choices:
    """What the user has chosen on the screen.

    Attributes:
        holds: keys move a joint as long as they are held; otherwise by steps.
        step: which size.
        percent: speed override that is asked for.
        aim: reflector; None for none.
        axis: number of the axis that keys move where they do not name one themselves, from 0.
        said: what happened last.
    """

    holds: bool = False
    step: int = 1
    percent: int = 5
    aim: str | None = None
    axis: int = 0
    said: str = field(default="")

    @property
    def by(self) -> float:
        """Size of a step, deg or mm."""
        return STEPS[self.step]

    def faster(self, cap_percent: float) -> None:
        """Choose the next higher speed, at most the cell's."""
        self.percent = next((each for each in PERCENTS if self.percent < each <= cap_percent), self.percent)

    def slower(self) -> None:
        """Choose the next lower speed."""
        self.percent = next((each for each in reversed(PERCENTS) if each < self.percent), self.percent)

    def next_axis(self, way: int, count: int) -> None:
        """Choose the axis after or before; the first one after the last."""
        self.axis = (self.axis + way) % max(count, 1)

    def next_aim(self, names: list[str]) -> None:
        """Choose the next reflector; none after the last."""
        known: list[str | None] = [None, *names]
        place = known.index(self.aim) if self.aim in known else -1
        self.aim = known[(place + 1) % len(known)]


def entry_lines(engine: EngineState, choices: Choices, said: str) -> list[Content]:
    """Return what has to be known before jogging: cell, real or not, speed, and who else is at it."""
    cap = cap_percent(engine)
    return [
        Content.assemble("cell    ", (engine.cell_name or "not known", "bold")),
        Content.assemble("bench   ", _kind(engine)),
        Content.assemble(
            "speed   ", (f"{min(choices.percent, cap):g} %", "bold"), f" (cap {cap:g} %)", ("   + −", "dim")
        ),
        _left_low(engine, cap),
        *_hindrance(engine),
        Content.styled(said, "$warning") if said else Content(""),
    ]


def _left_low(engine: EngineState, cap: float) -> Content:
    """Return that the controller's override is below that of the cell, as a jog leaves it."""
    percent = None if engine.robot is None else engine.robot.override_percent
    if percent is None or percent > cap - 1.0:
        return Content("")
    left = engine.override_left
    how = "until raised at controller" if left is None else f"= sets {left.before_percent:g} % again"
    return Content.styled(f"override {percent:g} %, {how}", "$warning")


def fresh_joints(engine: EngineState, now_s: float) -> tuple[float, ...] | None:
    """Return the joints as they were just now, deg and mm; None when they are old or not known."""
    robot = engine.robot
    if robot is None or robot.age_s + now_s - engine.bench_at_s > STALE_S:
        return None
    return robot.known_joints


def cap_percent(engine: EngineState) -> float:
    """Return the cell's highest speed override; 100 while it is not known: the engine caps it then."""
    return 100.0 if engine.robot is None else engine.robot.override_cap_percent


def can_hold(engine: EngineState) -> bool:
    """Return whether a joint may be kept moving while a key is held."""
    return engine.robot is not None and engine.robot.jogs


def jog_lines(engine: EngineState, choices: Choices, now_s: float) -> list[Content]:
    """Return mode, step, aim, the table of keys with the joints beside them, and what happened last."""
    moving = None if engine.jog is None else engine.jog.moving
    state = Content.styled(f"MOVES {moving.upper()}", "$warning bold") if moving else Content("stands")
    return [
        Content.assemble((f"JOG {_percent_text(engine)}", "bold $accent"), "  ", state),
        Content.assemble("m  ", _mode(choices.holds)) if can_hold(engine) else Content(STEPS_ONLY),
        *_moved(engine, choices, now_s),
        Content(""),
        Content.assemble(("  F12  STOP  ", "bold $background on $error"), "   Esc ends the jog"),
        Content.styled(choices.said or jog_reason(engine), "$warning"),
    ]


def range_lines(engine: EngineState, now_s: float) -> list[Content]:
    """Return where each axis stands between the ends of its range."""
    bench, robot = engine.bench, engine.robot
    if bench is None or not bench.axes:
        return []
    style, age = value_style(
        bench, "robot", None if robot is None else robot.age_s, now_s - engine.bench_at_s
    )
    joints = None if robot is None else robot.joints
    values = (None,) * len(bench.axes) if joints is None else joints
    return [
        Content(""),
        Content.styled(f"within its range   {age.strip()}".rstrip(), "dim"),
        *(
            Content.assemble(
                f"{axis.name:<5}",
                (range_bar(axis, value, _RANGE_CELLS), style),
                (f"  {axis.low:g} … {axis.high:g} {axis.unit}", "dim"),
            )
            for axis, value in zip(bench.axes, values, strict=True)
        ),
    ]


def _percent_text(engine: EngineState) -> str:
    """Return the speed override of the jog under way, as read back; a dash before that."""
    percent = None if engine.jog is None else engine.jog.percent
    return "—" if percent is None else f"{percent:g} %"


def jog_reason(engine: EngineState) -> str:
    """Return why the arm stands, or why the jog is over; empty where nothing is said of it."""
    return "" if engine.jog is None else engine.jog.reason or ""


def _kind(engine: EngineState) -> tuple[str, str]:
    if engine.bench_simulated:
        return f"{SIMULATION}: emulators", "bold $warning"
    if engine.bench_simulated is False:
        return "REAL ARM", "bold $error"
    return "not known yet: treated as a REAL ARM", "bold $error"


def _hindrance(engine: EngineState) -> list[Content]:
    """Return why nobody may jog now; else the key that begins it."""
    if not engine.connected:
        return [Content.styled(f"no engine: {engine.trouble}", "$error")]
    if engine.jogging and engine.jog is not None:
        moving = f", moving {engine.jog.moving}" if engine.jog.moving else ""
        return [
            Content.styled(f"{engine.jog.by} jogs at {_percent_text(engine)}{moving}", "bold"),
            Content("F12 stops the arm"),
        ]
    if engine.running:
        return [Content.styled("a run is under way: jog when it has ended", "$warning")]
    if engine.control is not None and not engine.in_control:
        return [Content.styled(f"{engine.control.who} holds control", "$warning")]
    if engine.robot is not None and engine.robot.alarm_number:
        return [Content.styled(f"✗ ALARM {engine.robot.alarm_number}: ! shows it", "$error bold")]
    begin = [
        Content.assemble(("F8", "bold $success"), "  drives on, then the keys move the arm"),
        Content.styled("steps are checked, not rehearsed", "dim"),
    ]
    return begin if engine.bench_simulated else [*begin, Content("keep a hand on the emergency stop")]


def _mode(holds: bool) -> Content:
    after = "  until the key is let go" if holds else ""
    return Content.assemble(_option("steps", chosen=not holds), _option("hold", chosen=holds), after)


def _moved(engine: EngineState, choices: Choices, now_s: float) -> list[Content]:
    """Return the size of a step, and the keys with what they move."""
    if engine.layout is None:
        return [_steps(choices, "deg or mm"), Content(""), *_axis_table(engine, choices, now_s)]
    return [
        _steps(choices, "deg (beam: mm)"),
        Content.assemble("n  ", *_aim(choices)),
        Content(""),
        *_key_table(engine, choices, now_s),
    ]


def _steps(choices: Choices, units: str) -> Content:
    sizes = [_option(f"{size:g}", chosen=place == choices.step) for place, size in enumerate(STEPS)]
    return Content.assemble("1…5  ", *sizes, f" {units}")


def _aim(choices: Choices) -> list[tuple[str, str]]:
    if choices.aim is None:
        return [(NO_AIM, "dim")]
    return [_option(choices.aim, chosen=True), (WITH_AIM, "")]


def _option(text: str, *, chosen: bool) -> tuple[str, str]:
    return (f"[{text}]", "reverse") if chosen else (f" {text} ", "")


def _axis_table(engine: EngineState, choices: Choices, now_s: float) -> list[Content]:
    bench, robot = engine.bench, engine.robot
    style, age = value_style(
        bench, "robot", None if robot is None else robot.age_s, now_s - engine.bench_at_s
    )
    return [
        Content.styled(f"↑ ↓ axis   ← −   → +   {age.strip()}".rstrip(), "dim"),
        *axis_lines(
            () if bench is None else bench.axes, None if robot is None else robot.joints, choices.axis, style
        ),
    ]


def _key_table(engine: EngineState, choices: Choices, now_s: float) -> list[Content]:
    joints = None if engine.robot is None else engine.robot.joints
    age_s = None if engine.robot is None else engine.robot.age_s
    style, age = value_style(engine.bench, "robot", age_s, now_s - engine.bench_at_s)
    lines = [Content.styled(f"{'':<6}{'+ ↺':<9}{'− ↻':<9}{age.strip()}", "dim")]
    for name, plus, minus, place in JOINT_ROWS:
        value = None if joints is None else joints[place]
        angle = "         —" if value is None else f"{value:10.3f} deg"
        lines.append(Content.assemble(f"{name:<6}{plus:<9}{minus:<9}", (angle, style)))
    aside = "left   right" if choices.aim else "needs an aim"
    lines.append(Content.assemble(f"{'beam':<6}{'z':<9}{'x':<9}", (f"{aside:>14}", "dim")))
    if choices.holds:
        lines.append(Content.styled("a held key moves the arm from its first repeat on", "dim"))
    return lines
