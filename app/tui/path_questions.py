"""What is asked before a result is validated: which path was measured, and what it is compared with."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.files.documents import is_file
from catseye.app.tui.dialogs.form_dialog import Answers
from catseye.app.tui.screens.working import typed_path

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.results.result_files import ResultFile
    from catseye.app.results.scara.result import Result


def newest_path_run(root: Path) -> str:
    """Return the name of the newest run that `validate` takes, empty when there is none; call it in a thread."""
    from catseye.app.protocol.procedures import analysed_by
    from catseye.app.store.catalog import paths_of

    found = (path.name for each in analysed_by("validate") for path in paths_of(root, each.name))
    return max(found, default="")


def reference_of(file: "ResultFile[Result]", files: "Iterable[ResultFile[Result]]") -> Path | None:
    """Return the first conventional model from the runs of an error map; None when there is none."""
    if file.result is None or file.result.model == "conventional":
        return None
    for each in files:
        result = each.result
        if result is None or result.model != "conventional":
            continue
        if result.provenance.runs == file.result.provenance.runs:
            return each.path
    return None


def path_fault(answers: Answers) -> str:
    """Return what is wrong with the answers, empty when nothing is."""
    if not answers["measured"]:
        return "a run of a path or a measured file is needed"
    reference = answers["reference"]
    return f"there is no file {reference}" if reference and not is_file(typed_path(reference)) else ""
