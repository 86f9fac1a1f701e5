"""What hands have to do, as a small picture of characters."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from catseye.procedures.kit.tasks import (
    AlignOptics,
    ClearBeam,
    ExportBallbar,
    LeadTracker,
    MountArtefact,
    MountBallbar,
    MountInterferometer,
    MountOptics,
    PlaceReflector,
    PlaceTarget,
    ReadBallbar,
    ReadIndicator,
    SeatInCup,
    SetUpScaleBar,
    TakeBallbarOff,
    TakeIndicatorOff,
    TapArtefact,
    Task,
    TurnScrew,
)

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.prompts import UnknownTask
    from catseye.app.protocol.scara.layout import ReflectorPlace


def task_picture(task: "Task | UnknownTask | None", reflectors: "Sequence[ReflectorPlace]" = ()) -> list[str]:
    """Return lines that show a task; none for a mere question."""
    match task:
        case TurnScrew():
            return _screw(task.turns, task.screw)
        case PlaceReflector():
            return _nests(task.reflector, reflectors)
        case MountInterferometer():
            return _mounting(task.turned_deg)
        case MountOptics(optics="angular"):
            return [f"▣━━━━━━━┫▞┣━━━━━━━◖◗   the double reflector turns with {task.on}"]
        case MountOptics():
            return [f"▣━━━━━━━┫▞┣━━━━━━━◖ →   the reflector moves along {task.on}"]
        case AlignOptics():
            return ["▣━━━━━━━┫▞┣━━━━━━━◖◗   turn and shift until the signal is at its largest"]
        case ClearBeam():
            return ["▣━━━━━━━ ╳ ━━━━━━━◗   nothing may stand in the beam"]
        case SeatInCup():
            return [f"◉ → ◡   the ball of {task.target} into the cup, down to its seat"]
        case MountBallbar():
            return [f"◡●━━━━━━━━━●◡   from the cup to {task.target}"]
        case TakeBallbarOff():
            return ["◡   ●━━━━━━━━━●   ◡   balls out of cup and nest"]
        case ReadBallbar():
            return ["●━━━━▐ ±0.0000 ▌━━━━●   type what it shows, mm"]
        case MountArtefact():
            return [_gauge(task.turned)]
        case TapArtefact():
            arrow = "→" if task.by_um > 0.0 else "←"
            return [f"◯ {arrow} ├──▐   tap the artefact by {abs(task.by_um):.0f} µm"]
        case ReadIndicator():
            return [f"◯├──▐ ±000 ▌   type what the indicator in {task.direction} shows, µm"]
        case TakeIndicatorOff():
            return ["◯   ├──▐   artefact and indicators off"]
        case ExportBallbar():
            return ["●━━━━▐ ▁▁▃▃▂▂▅▅ ▌━━━━● → CSV   one plateau for each place"]
        case PlaceTarget():
            return [f"◉ → ◡   into {task.target}"]
        case LeadTracker():
            return [f"▣━━━━━━━━━━━◉   the beam follows the target, {task.target}"]
        case SetUpScaleBar():
            return ["◉━━━━━━━━━━━┳━━━━━━━━━━━◉   the bar lies level"]
        case None:
            return []
        case _:
            return [f"? {task.do}: unknown here, of a newer engine; do what the question says"]


def _gauge(turned: bool) -> str:
    """Draw artefact and indicator from above."""
    if turned:
        return "▌──┤◯   the artefact turned by half a turn, the indicator on the other side"
    return "◯├──▐   the indicator's tip on the artefact, in x"


def _screw(turns: float, screw: str) -> list[str]:
    """Draw the head of a screw from above, arrows the way it turns; clockwise is positive."""
    above, below = ("▶", "◀") if turns > 0.0 else ("◀", "▶")
    way = "clockwise ↻" if turns > 0.0 else "anticlockwise ↺"
    return [
        f"╭──{above}──╮",
        f"│  ✚  │   {abs(turns):.2f} turns {way}",
        f"╰──{below}──╯   {360.0 * abs(turns):.0f}° of the {screw} screw",
    ]


def _mounting(turned_deg: float) -> list[str]:
    """Draw the flange from above, and where the beam leaves before and after."""
    return [
        "before  ◀━━━━━━(◎)",
        f"after          (◎)━━━━━━▶   turned by {turned_deg:.0f}° on the flange",
    ]


def _nests(name: str, reflectors: "Sequence[ReflectorPlace]") -> list[str]:
    names = [each.name for each in reflectors] or [name]
    line = "   ".join(f"[◗] {each}" if each == name else f"[ ] {each}" for each in names)
    places = [f"x {each.x_mm:.0f} mm, y {each.y_mm:.0f} mm" for each in reflectors if each.name == name]
    return [line + (f"      {name}: {places[0]}" if places else "")]
