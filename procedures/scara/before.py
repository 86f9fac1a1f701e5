"""What the procedures of this system build on, and the way that they make."""

from typing import Final

from catseye.drivers.roles.device import Role
from catseye.procedures.kit.dossier import dossier
from catseye.procedures.kit.needs import After, Aftermath, EarlierRun, Equipment
from catseye.procedures.kit.procedure import Analysis, Asked, Stage
from catseye.procedures.scara.bench import ScaraBench

COUNTER: Final[tuple[Role, ...]] = ("interferometer", "environment")
"""The length counter, and the sensor of the air that its lengths are corrected for."""

WARM_S: Final = 4 * 3600.0
"""Links and drives cool down within hours."""

LEVELLED: Final = After("beam-level", "levelling")
ALIGNED: Final = After("beam-to-j4", "alignment")
WARM: Final = After("warmup", "warm arm", fresh_for_s=WARM_S)

_WAY: Final = "tracking"
"""From an unknown bench to error maps."""

LEVELLING: Final = Stage(10, "the beam in the plane of the arm", _WAY)
ALIGNING: Final = Stage(20, "the beam through the J4 axis", _WAY, renewed_by="beam-level")
SEARCHING: Final = Stage(30, "where the reflectors stand", _WAY)
WARMING: Final = Stage(
    40,
    "the arm at its working temperature",
    _WAY,
    fresh_for_s=WARM_S,
    covered_by="open-loop",
    covered="the measurement is made",
)
GAUGING: Final = Stage(44, "radial error motions of J1 and J2 for the error budget", _WAY, optional=True)
BUDGET: Final = Analysis(
    "budget",
    gives="the radial error motions in the error budget of the cell file",
    stage=Stage(46, "what was measured, in the error budget of the cell file", _WAY, optional=True),
    writes_result=False,
    usage=("{run}", "{runs}", "--cell", "{cell}"),
    changes_cell=True,
)
MEASURING: Final = Stage(50, "the distances", _WAY, since="reflector-search")
IDENTIFY: Final = Analysis(
    "identify",
    gives="error maps with their uncertainty",
    stage=Stage(60, "error maps from the distances", _WAY),
    writes_result=True,
    usage=("{run}", "{runs}", "-o", "{folder}result-{run}.json"),
)
CONVENTIONAL: Final = Analysis(
    "identify",
    gives="",
    stage=Stage(62, "links and an offset alone, with which the error map is compared", _WAY),
    writes_result=False,
    usage=("{run}", "{runs}", "--model", "conventional", "-o", "{folder}conventional-{run}.json"),
    called="identify conventional",
    stands_beside=True,
)
DRIVING_A_PATH: Final = Stage(70, "a path that shows how good the map is", _WAY, since="open-loop")
VALIDATE: Final = Analysis(
    "validate",
    gives="",
    stage=Stage(80, "the error map against the path", _WAY),
    writes_result=False,
    usage=("{result}", "--measured", "{run}", "{runs}", "-o", "{folder}validation-{run}.html"),
    writes="validation-{run}.html",
)
COMPENSATE: Final = Analysis(
    "compensate",
    gives="",
    stage=Stage(85, "commands that bring the arm to the positions of a path", _WAY),
    writes_result=False,
    usage=("{result}", "--path", "{path}", "--cell", "{cell}", "-o", "{folder}compensated-{run}.csv"),
    writes="compensated-{run}.csv",
    asks=(Asked("path", "path", "file of its points: CSV or TOML"),),
)
REPORT: Final = Analysis(
    "report",
    gives="",
    stage=Stage(90, "what is known about the arm, on one page", _WAY),
    writes_result=False,
    usage=("{result}", "-o", "{folder}arm-{run}.html"),
    writes="arm-{run}.html",
)
DOSSIER: Final = dossier(95, _WAY)


def _reflectors(bench: ScaraBench) -> str:
    names = ", ".join(reflector.name for reflector in bench.reflectors)
    return names + (", one cat's eye that is carried from nest to nest" if bench.optics.one_reflector else "")


def _tracker(bench: ScaraBench) -> str:
    return "in the cell file" if bench.tracker else ""


def _left_turned(run: EarlierRun) -> str:
    angles = [data["turned_deg"] for data in run.data_of("mounted")]
    if not angles or not angles[-1]:
        return ""
    return (
        f"left the interferometer turned by {angles[-1]:.1f}° from where it was at the start: unless it has been "
        "mounted as before, or theta40_deg in [optics] includes that angle, the beam will be searched for in the "
        "wrong direction"
    )


TURNED: Final = Aftermath("open-loop", _left_turned, settled_by="reflector-search")
REFLECTORS: Final = Equipment("reflectors", _reflectors)
TRACKER: Final = Equipment(
    "tracker", _tracker, without="none: the interferometer measures, or instrument = file"
)
