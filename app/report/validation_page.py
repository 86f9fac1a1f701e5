"""The page of a validation: the report of its results, with the measured file in front."""

from datetime import UTC, datetime
from pathlib import Path

from catseye.app.analysis.file_validation import FileValidation
from catseye.app.files.atomic import write_atomically
from catseye.app.report.content import ReportContent
from catseye.app.report.page import render_html
from catseye.app.store.software import SOFTWARE


def write_validation_page(found: FileValidation, measured: Path, output: Path) -> None:
    """Write one self-contained page: the report of the results, with the measured path.

    Args:
        found: what was compared.
        measured: the file that it was compared with.
        output: HTML file.
    """
    content = ReportContent(
        title=f"Validation on {measured.name}",
        created_utc=datetime.now(UTC).isoformat(timespec="seconds"),
        software=SOFTWARE,
        simulated=any(bool(one.provenance.simulated) for one in found.results),
        results=found.results,
        validation=found.validation,
        warnings=[*found.left_out, *found.remarks],
    )
    write_atomically(output, render_html(content))
