"""What is wrong with a campaign on a cell, found before anything moves."""

from collections.abc import Iterable, Sequence

from catseye.app.campaign.load import LoadedCampaign
from catseye.app.campaign.model import StageEntry
from catseye.app.campaign.words import Options, option_of, require_data_command, require_options
from catseye.app.errors import UsageError
from catseye.app.protocol.procedures import parse_params
from catseye.app.results.readiness.stages import CellStage
from catseye.procedures.kit.procedure import Procedure


def require_doable(
    loaded: LoadedCampaign, stages: Sequence[CellStage], procedures: Iterable[Procedure], options: Options
) -> None:
    """Check every stage of a campaign against the way of a cell.

    Args:
        stages: of the way.
        procedures: that are installed.
        options: returns the options of a command, with their dashes.

    Raises:
        UsageError: a stage is not on the way, or cannot be given what the file gives it; every fault is named.
    """
    known = {stage.name: stage for stage in stages}
    installed = {each.name: each for each in procedures}
    faults = []
    for entry in loaded.campaign.stage:
        try:
            _require_stage(loaded, entry, known, installed, options)
        except UsageError as error:
            faults.append(f"  {error}")
    if faults:
        raise UsageError("the campaign cannot be done on this cell:\n" + "\n".join(faults))


def _require_stage(
    loaded: LoadedCampaign,
    entry: StageEntry,
    known: dict[str, CellStage],
    installed: dict[str, Procedure],
    options: Options,
) -> None:
    if entry.command:
        require_data_command(entry, loaded.path, options)
        return
    stage = known.get(entry.name)
    where = f"{loaded.path}: stage {entry.name}:"
    if stage is None:
        raise UsageError(
            f"{where} it is not on the way of this cell, which with these stages has {', '.join(known)}"
        )
    if stage.procedure:
        if entry.options or entry.files:
            raise UsageError(f"{where} a procedure takes params, neither options nor files")
        texts = [f"{name}={loaded.text(value)}" for name, value in entry.params.items()]
        try:
            parse_params(installed[entry.name].params_type, texts)
        except UsageError as error:
            raise UsageError(f"{where} {error}") from error
        _require_what_it_counts_after(loaded, entry, installed[entry.name], where)
        return
    if entry.params:
        raise UsageError(f"{where} work on stored data takes options and files, no params")
    require_options(where, stage.words[0], map(option_of, entry.options), options)
    asked = {each.name: each.hint for each in stage.asks}
    for name, hint in asked.items():
        if name not in entry.files:
            raise UsageError(f'{where} it asks for a file: add files.{name} = "…" ({hint})')
        if not loaded.file(entry.files[name]).is_file():
            raise UsageError(f"{where} there is no file {entry.files[name]}")
    for name in entry.files:
        if name not in asked:
            raise UsageError(f"{where} it asks for no file {name}")


def _require_what_it_counts_after(
    loaded: LoadedCampaign, entry: StageEntry, procedure: Procedure, where: str
) -> None:
    """Check that a job which does everything anew has the stage after which a run of this one counts."""
    since = "" if procedure.stage is None else procedure.stage.since
    names = [each.name for each in loaded.campaign.stage]
    if since and loaded.campaign.reuse == "job" and since not in names[: names.index(entry.name)]:
        raise UsageError(
            f"{where} it counts only after {since} of the same job: put a stage {since} before it, "
            'or let what the cell has done before count (reuse = "cell")'
        )
