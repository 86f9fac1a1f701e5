"""The way of a serial arm from a tracker on its stand to compensated targets, and what each procedure of it needs."""

from collections.abc import Sequence
from typing import Any, Final

from catseye.drivers.roles.device import Role
from catseye.procedures.kit.dossier import dossier
from catseye.procedures.kit.event_text import EventText, EventTexts
from catseye.procedures.kit.needs import After, Equipment
from catseye.procedures.kit.procedure import Analysis, Asked, Stage
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.records import PLANNED

TRACKER: Final[tuple[Role, ...]] = ("tracker",)

_WAY: Final = "six-axis"

WARM_S: Final = 4 * 3600.0
"""Gears and links cool down within hours."""

WARM: Final = After("tracker-warmup", "warm arm", fresh_for_s=WARM_S)
CHECKED: Final = After("instrument-check", "instrument")


CHECKING: Final = Stage(210, "what the instrument itself is worth", _WAY)
WARMING: Final = Stage(220, "the arm at its working temperature", _WAY, fresh_for_s=WARM_S)
TURNING: Final = Stage(230, "what each joint does beside turning", _WAY)
MEASURING: Final = Stage(240, "targets at chosen poses", _WAY)
CALIBRATE: Final = Analysis(
    "calibrate",
    gives="geometry and compliances with their uncertainty",
    stage=Stage(250, "parameters of the arm from the measured poses", _WAY),
    writes_result=True,
    usage=("{run}", "{runs}", "-o", "{folder}result-{run}.json"),
)
VALIDATING: Final = Stage(260, "targets at random poses, which show how good the result is", _WAY)
SPANNING: Final = Stage(280, "lengths that a ballbar shows at compensated poses", _WAY)
VALIDATE: Final = Analysis(
    "validate",
    gives="",
    stage=Stage(270, "the result against the random poses", _WAY),
    writes_result=False,
    usage=("{result}", "--measured", "{run}", "{runs}", "-o", "{folder}validation-{run}.html"),
    writes="validation-{run}.html",
)
COMPENSATE: Final = Analysis(
    "compensate",
    gives="",
    stage=Stage(285, "commands that bring the tool to the poses of a program", _WAY),
    writes_result=False,
    usage=("{result}", "--poses", "{poses}", "-o", "{folder}compensated-{run}.csv"),
    writes="compensated-{run}.csv",
    asks=(Asked("poses", "poses", "CSV of the program"),),
)
REPORT: Final = Analysis(
    "report",
    gives="",
    stage=Stage(290, "what is known about the arm, on one page", _WAY),
    writes_result=False,
    usage=("{result}", "-o", "{folder}arm-{run}.html"),
    writes="arm-{run}.html",
)
DOSSIER: Final = dossier(295, _WAY)


def _nests(bench: SerialBench) -> str:
    return ", ".join(nest.name for nest in bench.instrument.nests)


def _targets(bench: SerialBench) -> str:
    return ", ".join(target.name for target in bench.targets)


NESTS: Final = Equipment("fixed nests", _nests, without="none: no world frame, so a drift cannot be seen")
TARGETS: Final = Equipment("targets of the tool", _targets)


def _frame_found(data: Any) -> str:
    """Return how far a frame is from what the files say, and the base as the lines of the cell file."""
    shifted = f"{data.get('frame')}: {data.get('shift_mm', 0.0):.2f} mm from where the files have it"
    place = _rounded(data, ("x_mm", "y_mm", "z_mm"))
    if data.get("rx_deg") is None:
        return f"{shifted}, at {place} mm"
    turns = _rounded(data, ("rx_deg", "ry_deg", "rz_deg"))
    return f"{shifted}, turned by {data['turn_deg']:.3f}°: base_mm = {place}, base_deg = {turns}"


def _rounded(data: Any, keys: Sequence[str]) -> list[float]:
    return [round(data.get(key, 0.0), 3) + 0.0 for key in keys]


def _poses_planned(data: Any) -> str:
    return f"{len(data.get('names') or ())} poses are planned"


def _nests_drift(data: Any) -> str:
    return f"nests: {data.get('nest')} has moved by {data.get('drift_mm', 0.0):.3f} mm since the beginning"


POSE_TEXTS: Final[EventTexts] = {
    "frame-found": EventText(_frame_found, shown=True),
    "nests-drift": EventText(_nests_drift, passing=True),
    PLANNED: EventText(_poses_planned, passing=True),
}


def _axis_turned(data: Any) -> str:
    play = data.get("backlash_deg")
    backlash = "" if play is None else f", backlash {play:+.4f}°"
    return (
        f"{data.get('joint')} over {data.get('low_deg', 0.0):.0f} … {data.get('high_deg', 0.0):.0f}°: "
        "tangential error over "
        f"{data.get('tangential_range_mm', 0.0):.3f} mm, angular over "
        f"{data.get('angular_range_deg', 0.0):.4f}°{backlash}"
    )


def _nest_checked(data: Any) -> str:
    apart = data.get("two_face_mm")
    faces = "" if apart is None else f", both faces {apart:.4f} mm apart"
    return f"nest {data.get('nest')}: repeats scatter by {data.get('repeatability_mm', 0.0):.4f} mm{faces}"


def _length_checked(data: Any) -> str:
    return f"{data.get('what')}: {data.get('error_mm', 0.0):+.4f} mm"


def _warmed(data: Any) -> str:
    drift = data.get("drift_um_per_10min")
    known = "unknown" if drift is None else f"{drift:.1f} µm in 10 min"
    return (
        f"after {data.get('elapsed_min', 0.0):.0f} min the drift is {known}, the limit "
        f"{data.get('limit_um_per_10min')}: "
        f"{'warm' if data.get('warm') else 'not warm'}"
    )


def _ballbar(data: Any) -> str:
    std_mm = data.get("std_mm")
    scatter = "" if std_mm is None else f"standard deviation {std_mm:.3f} mm, "
    return (
        f"ballbar at {data.get('nest')}: {data.get('places')} lengths, mean error "
        f"{data.get('mean_mm', 0.0):+.3f} mm, "
        f"{scatter}largest {data.get('max_mm', 0.0):.3f} mm"
    )


def _cup_found(data: Any) -> str:
    x, y, z = data.get("centre_mm") or (0.0, 0.0, 0.0)
    place = f"[{x:.3f}, {y:.3f}, {z:.3f}]"
    return (
        f"the cup stands at {place} mm, the takings within {data.get('apart_mm', 0.0):.3f} mm: go on with "
        f"--param centre_mm={place.replace(' ', '')}, or write centre_mm = {place} into [ballbar] of the cell file"
    )


AXIS_TEXTS: Final[EventTexts] = {"axis-turned": EventText(_axis_turned)}
CHECK_TEXTS: Final[EventTexts] = {
    "nest-checked": EventText(_nest_checked),
    "length-checked": EventText(_length_checked),
}
WARM_TEXTS: Final[EventTexts] = {"warmed": EventText(_warmed)}
BAR_TEXTS: Final[EventTexts] = {"ballbar": EventText(_ballbar, shown=True)}
CUP_TEXTS: Final[EventTexts] = {"cup-found": EventText(_cup_found, shown=True)}
