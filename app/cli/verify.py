"""verify: a run against its manifest and its own rules."""

from catseye.app.cli.options import AsJson, Runs, StoredRun
from catseye.app.cli.output import write_document
from catseye.app.cli.report_output import note_statements
from catseye.app.errors import StorageError
from catseye.app.store.runs_folder import runs_folder


def verify(
    run: StoredRun,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Check whether a stored run was changed. Compares it with its manifest and checks its consistency."""
    from catseye.app.results.runs.documents import verification_document
    from catseye.app.results.runs.reports import verification_report
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.verify import verify as verified

    path = resolve_run(runs_folder(runs), run)
    verification = verification_document(path.name, verified(path))
    if as_json:
        write_document("verification", verification.model_dump(mode="json"))
    else:
        note_statements(verification_report(verification))
    if verification.problems:
        raise StorageError(f"{path.name}: " + "; ".join(verification.problems))
