"""What programs may read on stdout: every document that a command writes, by name, with its format and its model."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any, Final

_DIALECT: Final = "https://json-schema.org/draft/2020-12/schema"


@dataclass(frozen=True)
class Output:
    """A document, one line of stdout each.

    Attributes:
        model: of its fields, `module:name` below `catseye.app`; imported when the schema is asked for.
        commands: that write it, as they are typed.
        summary: what it says, in a few words.
        version: raised when a field goes or means something else; further fields do not raise it.
    """

    model: str
    commands: tuple[str, ...]
    summary: str
    version: int = 1


OUTPUTS: Final[Mapping[str, Output]] = {
    "events": Output(
        "cli.documents:RunLine",
        ("run --json", "resume --json"),
        "an event of a run, as it happens",
    ),
    "rehearsal": Output(
        "protocol.rehearsal:Rehearsal", ("run --dry-run --json",), "what a run would do and how long it takes"
    ),
    "detached": Output(
        "cli.documents:DetachedRun",
        ("run --detach --json",),
        "a run that goes on by itself",
    ),
    "attached": Output(
        "cli.documents:AttachedLine",
        ("attach --json",),
        "a message of the engine: its snapshot, an event, or an answer",
    ),
    "engine": Output("protocol.commands:EngineLine", ("engine",), "where an engine listens, and its end"),
    "endpoint": Output("cli.documents:Endpoint", ("emulate",), "an emulator that answers"),
    "error": Output(
        "cli.documents:Failure", ("any command --json",), "why a command has nothing else to say"
    ),
    "refusal": Output("cli.documents:Refused", ("identify --json",), "why a result is not kept"),
    "cell-check": Output(
        "cli.documents:CellCheck", ("config validate --json",), "whether a cell file can be used"
    ),
    "cell-values": Output(
        "cli.documents:CellValues", ("config show --json",), "each value of a cell and its origin"
    ),
    "doctor": Output(
        "protocol.examination:CellExamination", ("doctor --json",), "who answers behind each endpoint"
    ),
    "alarm": Output("cli.documents:AlarmFound", ("reset-alarm --json",), "the alarm of a controller"),
    "procedure": Output(
        "results.readiness.survey_document:ProcedureEntry",
        ("procedures --json",),
        "a procedure, its parameters and its needs",
    ),
    "stages": Output(
        "results.readiness.survey_document:StagesLine",
        ("procedures --cell FILE --json",),
        "the stages of a cell; the last line",
    ),
    "prompts": Output(
        "cli.documents:PromptsDocument",
        ("prompts --json",),
        "the questions of a procedure and which answers a file may give",
    ),
    "campaign-events": Output(
        "protocol.campaign_events:CampaignStep",
        ("campaign --json",),
        "an event of a job of stages; those of its runs are `events`",
    ),
    "campaign-verdict": Output(
        "protocol.campaign_events:CampaignEnded",
        ("campaign --json",),
        "the verdict of a job and of each of its stages; the last line",
    ),
    "campaign-plan": Output(
        "cli.documents:CampaignPlan",
        ("campaign --dry-run --json",),
        "what a job of stages would do, and how long that took the last time",
    ),
    "campaign-file": Output(
        "cli.documents:ShippedCampaign", ("campaign --json",), "a campaign file that comes with the program"
    ),
    "run-entry": Output("results.runs.documents:RunEntry", ("runs --json",), "a stored run"),
    "pruned-run": Output(
        "cli.documents:PrunedRun", ("runs prune --json",), "an old run: whether it goes, and why not"
    ),
    "run": Output("results.runs.documents:RunDocument", ("show --json",), "what a run keeps"),
    "verification": Output(
        "results.runs.documents:VerificationDocument",
        ("verify --json",),
        "whether a run is what was written",
    ),
    "mapping": Output(
        "cli.documents:MappingPreview",
        ("validate --preview --json", "resolution --preview --json"),
        "how a foreign file would be read",
    ),
    "identification": Output(
        "results.scara.identification_document:IdentificationDocument",
        ("identify --json",),
        "an identified SCARA",
    ),
    "measured-budget": Output(
        "results.scara.measured_budget_document:MeasuredBudgetDocument",
        ("budget --json",),
        "what a run has measured of the error budget",
    ),
    "diagnosis": Output(
        "results.scara.diagnosis_document:DiagnosisDocument",
        ("diagnose --json",),
        "what speaks against a fit",
    ),
    "comparison": Output(
        "results.scara.comparison_document:ComparisonDocument",
        ("compare --json",),
        "two results of a SCARA",
    ),
    "arm-comparison": Output(
        "results.serial_arm.comparison_document:ArmComparisonDocument",
        ("compare --json",),
        "two results of a serial arm",
    ),
    "trend": Output(
        "results.trend.document:TrendDocument", ("trend --json",), "the results of an arm over months"
    ),
    "path-prediction": Output(
        "results.scara.prediction:PredictionDocument",
        ("predict --path FILE --json",),
        "where a SCARA goes on a path",
    ),
    "pose-prediction": Output(
        "results.serial_arm.facts:PosePrediction",
        ("predict --poses FILE --json",),
        "where a serial arm goes at poses",
    ),
    "path-validation": Output(
        "results.scara.validation_document:ValidationDocument",
        ("validate --json",),
        "a SCARA against measured positions",
    ),
    "distance-validation": Output(
        "results.scara.validation_document:DistanceValidationDocument",
        ("validate --json",),
        "a SCARA against measured distances",
    ),
    "arm-validation": Output(
        "results.serial_arm.validation_document:ArmValidationDocument",
        ("validate --json",),
        "a serial arm against measured poses",
    ),
    "path-compensation": Output(
        "results.scara.compensation_report:CompensationDocument",
        ("compensate --path FILE --json",),
        "corrected commands of a path",
    ),
    "table-compensation": Output(
        "cli.documents:CompensationTables",
        ("compensate --format kw-ssfk --json",),
        "tables of corrections",
    ),
    "pose-compensation": Output(
        "results.serial_arm.facts:PoseCompensation",
        ("compensate --poses FILE --json",),
        "corrected commands of poses",
    ),
    "design": Output(
        "results.scara.design.document:DesignDocument",
        ("design --json",),
        "where to put reflectors and which commands to use",
    ),
    "resolution": Output(
        "results.resolution.documents:ResolutionDocument",
        ("resolution --json",),
        "step errors, least steps and reversal errors",
    ),
    "joint-models": Output(
        "results.resolution.modelling:ModelsDocument",
        ("resolution-model --json",),
        "look-up tables of step errors",
    ),
    "step-prediction": Output(
        "results.resolution.documents:StepPrediction",
        ("predict-resolution --json",),
        "the smallest steps of the tool",
    ),
    "pose-selection": Output(
        "results.serial_arm.selection_document:SelectionDocument",
        ("select-poses --json",),
        "the poses that identify best",
    ),
    "calibration": Output(
        "results.serial_arm.calibration_document:CalibrationDocument",
        ("calibrate --json",),
        "an identified serial arm",
    ),
    "demo": Output("results.scara.job_document:JobDocument", ("demo --json",), "the day of a SCARA"),
    "resolution-demo": Output(
        "cli.resolution.demo_truth:ResolutionDemo",
        ("demo resolution --json",),
        "the day of motion resolution",
    ),
    "arm-demo": Output("cli.serial_arm.demo:ArmDemo", ("demo six-axis --json",), "the day of a six-axis arm"),
    "dossier": Output(
        "results.dossier.document:DossierDocument", ("dossier --json",), "the page of a cell's day"
    ),
}
"""By name, in the order of the help; a further document is a further entry, and `write_document` with its name."""


def format_of(name: str) -> str:
    """Return the `format` that each document of this name carries."""
    return f"catseye-{name}/{OUTPUTS[name].version}"


@cache
def schema_of(name: str) -> dict[str, Any]:
    """Return the JSON schema of a document.

    Raises:
        KeyError: there is no document of this name.
    """
    from pydantic import TypeAdapter

    module, _, model = OUTPUTS[name].model.partition(":")
    declared = getattr(import_module(f"catseye.app.{module}"), model)
    fields = TypeAdapter(declared).json_schema(mode="serialization")
    definitions = fields.pop("$defs", {})
    document: dict[str, Any] = {
        "$schema": _DIALECT,
        "$id": format_of(name),
    }
    stated = {"format": {"const": format_of(name)}}
    if "properties" in fields:
        # A model of a file names the format of that; the line has its own.
        required = ["format", *(each for each in fields.get("required", ()) if each != "format")]
        document |= fields | {"properties": fields["properties"] | stated, "required": required}
    else:
        document |= fields | {"properties": stated, "required": ["format"]}
    return document | {"title": OUTPUTS[name].summary, "$defs": definitions}
