"""What a validation on a measured file says: the report of the results, with the measured path."""

from dataclasses import replace

from catseye.app.results.model import Report, Section, Sign, Statement
from catseye.app.results.origin import origin_now
from catseye.app.results.scara.arm_report import arm_report
from catseye.app.results.scara.findings import Findings
from catseye.app.results.scara.validation_of_files import FileValidation


def file_validation_report(validation: FileValidation, measured: str) -> Report:
    """Return what models leave on the path of a file."""
    simulated = any(bool(result.provenance.simulated) for result in validation.results)
    report = arm_report(
        f"Validation on {measured}",
        origin_now(simulated=simulated),
        Findings(validation.results, validation=validation.validation, lines=validation.lines),
    )
    first, *others = report.sections
    return replace(report, sections=(_with_remarks(first, validation), *others))


def _with_remarks(verdict: Section, validation: FileValidation) -> Section:
    left_out = (Statement(Sign.NEUTRAL, f"Left out: {text}.") for text in validation.left_out)
    remarks = (Statement(Sign.ATTENTION, f"{text}.") for text in validation.remarks)
    return replace(verdict, blocks=(*verdict.blocks, *left_out, *remarks))
