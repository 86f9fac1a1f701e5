"""What a validation on a measured file says: the report of the results, with the measured path."""

from dataclasses import replace

from catseye.app.results.model import Report, Section, Sign, Statement
from catseye.app.results.origin import now_utc
from catseye.app.results.scara.content import ReportContent
from catseye.app.results.scara.run_report import run_report
from catseye.app.results.scara.validation_of_files import FileValidation
from catseye.app.store.software import SOFTWARE


def file_validation_report(found: FileValidation, measured: str) -> Report:
    """Return what models leave on the path of a file.

    Args:
        found: what was compared.
        measured: name of the file.
    """
    report = run_report(
        ReportContent(
            title=f"Validation on {measured}",
            created_utc=now_utc(),
            software=SOFTWARE,
            simulated=any(bool(one.provenance.simulated) for one in found.results),
            results=found.results,
            validation=found.validation,
            lines=found.lines,
        )
    )
    first, *others = report.sections
    return replace(report, sections=(_with_remarks(first, found), *others))


def _with_remarks(verdict: Section, found: FileValidation) -> Section:
    left_out = (Statement(Sign.NEUTRAL, f"Left out: {text}.") for text in found.left_out)
    remarks = (Statement(Sign.ATTENTION, f"{text}.") for text in found.remarks)
    return replace(verdict, blocks=(*verdict.blocks, *left_out, *remarks))
