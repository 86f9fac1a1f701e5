"""The way from optics on an arm to the least steps of its joints and of its tool."""

from typing import Final

from catseye.procedures.kit.dossier import dossier
from catseye.procedures.kit.procedure import Analysis, Asked, Stage

_WAY: Final = "resolution"

DECAYING: Final = Stage(110, "smallest step that each joint still makes, in both directions", _WAY)
EQUAL: Final = Stage(120, "the same with equal steps, after ISO 230", _WAY)
THERE_AND_BACK: Final = Stage(130, "how much motion a reversal loses, and whether that is play", _WAY)
EVALUATE: Final = Analysis(
    "resolution",
    gives="step errors, least increment steps and reversal error",
    stage=Stage(140, "least steps with their intervals, from the recordings", _WAY),
    writes_result=True,
    usage=("{run}", "{runs}", "-o", "{folder}result-{run}.json"),
    called="least steps",
)
MODEL: Final = Analysis(
    "resolution-model",
    gives="",
    stage=Stage(150, "look-up tables of the joints, for the prediction", _WAY),
    writes_result=False,
    usage=("{result}", "-o", "{folder}tables.csv"),
    writes="tables.csv",
)
PREDICT: Final = Analysis(
    "predict-resolution",
    gives="",
    stage=Stage(160, "least steps of the tool at poses, to be compared with measured ones", _WAY),
    writes_result=False,
    usage=("{folder}tables.csv", "--arm", "{arm}", "--poses", "{poses}", "-o", "{folder}predicted.json"),
    writes="predicted.json",
    asks=(Asked("poses", "poses", "CSV with directions of the tool"),),
)
STRAIGHT: Final = Stage(170, "smallest straight step that the tool still makes", _WAY)
REPORT: Final = Analysis(
    "report",
    gives="",
    stage=Stage(180, "certificate, tables and figures on one page", _WAY),
    writes_result=False,
    usage=("{result}", "-o", "{folder}resolution.html"),
    writes="resolution.html",
)
DOSSIER: Final = dossier(190, _WAY)
