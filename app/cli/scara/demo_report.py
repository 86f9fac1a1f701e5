"""What the demo leaves: its page, and its figures as data."""

from pathlib import Path

from catseye.app.cli.scara.demo_job import DemoResult, run_for
from catseye.app.files.documents import read_truth
from catseye.app.render.page import write_page
from catseye.app.results.scara.identify import MODELS
from catseye.app.results.scara.job_document import IdentifiedValue, JobDocument, JobValidation, ModelLeaves
from catseye.app.results.scara.run_report import job_report
from catseye.app.results.scara.truth_tables import truth_tables
from catseye.app.results.scara.validation import PathValidation
from catseye.app.store.reader import RunReader


def write_demo_report(result: DemoResult) -> Path:
    """Write the page of a demo; return its path."""
    path = result.folder / "report.html"
    report = job_report(
        "catseye demo: error map of an emulated SCARA arm",
        [RunReader(run) for run in result.runs.values()],
        RunReader(run_for("identify", result.runs)),
        [result.results[model] for model in MODELS],
        truth_tables(result.identified["error-map"], read_truth(result.folder / "truth.json")),
        result.validation,
    )
    write_page(report, path)
    return path


def job_document(result: DemoResult, report: Path) -> JobDocument:
    """Return what a demo found as plain values."""
    truth = result.truth
    return JobDocument(
        runs={name: str(path) for name, path in result.runs.items()},
        run=str(run_for("identify", result.runs)),
        report=str(report),
        truth=str(result.folder / "truth.json"),
        results={model: str(result.folder / f"result-{model}.json") for model in result.results},
        identified=[
            IdentifiedValue(name=name, unit=unit, truth=float(true), identified=float(estimate), u=float(u))
            for name, unit, true, estimate, u in zip(
                truth.names, truth.units, truth.truth, truth.identified, truth.u, strict=True
            )
        ],
        rms_normalised_error=truth.rms_normalised,
        fit=result.results["error-map"].fit,
        validation=_validation(result.validation),
    )


def _validation(validation: PathValidation) -> JobValidation:
    models = {
        model.model: ModelLeaves(
            e_yy_rms_um=model.comparison.rms_um[1],
            e_xy_rms_um=model.comparison.rms_um[0],
            rms_2d_um=model.comparison.rms_2d_um,
            max_um=model.comparison.max_um,
        )
        for model in validation.models
    }
    return JobValidation(
        models=models,
        ratio=validation.ratio,
        compared=int(validation.compared.sum()),
        left_out=int((~validation.compared).sum()),
    )
