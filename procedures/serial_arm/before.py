"""The way of a serial arm from a tracker on its stand to compensated targets, and what each procedure of it needs."""

from typing import Any, Final

from catseye.drivers.roles.device import Role
from catseye.procedures.kit.event_text import EventText, EventTexts
from catseye.procedures.kit.needs import Equipment
from catseye.procedures.kit.procedure import Analysis, Stage
from catseye.procedures.serial_arm.bench import SerialBench

TRACKER: Final[tuple[Role, ...]] = ("tracker",)

_WAY: Final = "six-axis"

MEASURING: Final = Stage(240, "targets at chosen poses", _WAY)
CALIBRATE: Final = Analysis(
    "calibrate",
    gives="geometry and compliances with their uncertainty",
    stage=Stage(250, "parameters of the arm from the measured poses", _WAY),
    writes_result=True,
    usage="{run} -o result-{run}.json",
)
VALIDATING: Final = Stage(260, "targets at random poses, which show what the result is worth", _WAY)
VALIDATE: Final = Analysis(
    "validate",
    gives="",
    stage=Stage(270, "the result against the random poses", _WAY),
    writes_result=False,
    usage="{result} --measured {run}",
)


def _nests(bench: SerialBench) -> str:
    return ", ".join(nest.name for nest in bench.instrument.nests)


def _targets(bench: SerialBench) -> str:
    return ", ".join(target.name for target in bench.targets)


NESTS: Final = Equipment("fixed nests", _nests, without="none: no world frame, and a drift stays unseen")
TARGETS: Final = Equipment("targets of the tool", _targets)


def _frame_found(data: Any) -> str:
    turned = f", turned by {data['turn_deg']:.3f}°" if data.get("turn_deg") is not None else ""
    return f"{data.get('frame')}: {data.get('shift_mm', 0.0):.2f} mm from where the files have it{turned}"


def _nests_drift(data: Any) -> str:
    return f"nests: {data.get('nest')} has moved by {data.get('drift_mm', 0.0):.3f} mm since the beginning"


POSE_TEXTS: Final[EventTexts] = {
    "frame-found": EventText(_frame_found),
    "nests-drift": EventText(_nests_drift, passing=True),
}
