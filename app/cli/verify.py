"""verify: a run against its manifest and its own rules."""

from catseye.app.cli.options import AsJson, Runs, StoredRun
from catseye.app.cli.output import note, write_json


def verify(
    run: StoredRun,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Check a stored run against its manifest and its own rules."""
    from catseye.app.errors import StorageError
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.runs_folder import runs_folder
    from catseye.app.store.verify import verify as verified

    path = resolve_run(runs_folder(runs), run)
    found = verified(path)
    if as_json:
        facts = {"sealed": found.sealed, "problems": found.problems, "notes": found.notes}
        write_json({"run": path.name, "sound": found.ok, **facts})
    else:
        if found.ok:
            compared = "manifest, database" if found.sealed else "database"
            note(f"{path.name}: {compared} and sequence numbers agree")
        for text in found.notes:
            note(f"{path.name}: {text}")
    if found.problems:
        raise StorageError(f"{path.name}: " + "; ".join(found.problems))
