"""The list of the day as a campaign has it: its stages in its order, with its parameters and limits."""

import shlex
from collections.abc import Callable, Iterable
from dataclasses import replace

from catseye.app.campaign.limits import judged
from catseye.app.campaign.load import LoadedCampaign
from catseye.app.campaign.model import StageEntry
from catseye.app.campaign.words import options_of
from catseye.app.results.readiness.stages import CellStage

Documents = Callable[[StageEntry, CellStage], object]
"""Returns what the limits of a stage judge; blocks."""


def day_of_campaign(
    loaded: LoadedCampaign, stages: Iterable[CellStage], documents: Documents
) -> list[CellStage]:
    """Return the stages of a campaign, at most one of them the next.

    Stages with commands of their own belong to jobs, and are left out.

    Args:
        stages: of the way of the cell.
    """
    known = {stage.name: stage for stage in stages}
    found, open_yet = [], True
    for entry in loaded.campaign.stage:
        if entry.command:
            continue
        stage = _judged(entry, _worded(loaded, entry, known[entry.name]), documents)
        if stage.state not in {"done", "failed"}:
            stage = replace(stage, state="next" if open_yet else "later")
            open_yet = False
        found.append(stage)
    return found


def _worded(loaded: LoadedCampaign, entry: StageEntry, stage: CellStage) -> CellStage:
    """Return a stage with the parameters, options and files of the campaign."""
    params = tuple(f"{name}={loaded.text(value)}" for name, value in entry.params.items())
    limits = tuple(f"{limit.value} {limit.text}" for limit in entry.limit)
    given = {f"{{{name}}}": str(loaded.file(path)) for name, path in entry.files.items()}
    words = (*(given.get(word, word) for word in stage.words), *options_of(loaded, entry))
    asks = tuple(each for each in stage.asks if each.name not in entry.files)
    typed = [word for param in params for word in ("--param", param)]
    return replace(
        stage,
        words=words,
        asks=asks,
        params=params,
        limits=limits,
        command=shlex.join(("catseye", *words, *typed)),
    )


def _judged(entry: StageEntry, stage: CellStage, documents: Documents) -> CellStage:
    """Return a stage that is done and misses a limit as one that has failed."""
    if stage.state != "done" or not entry.limit:
        return stage
    document = documents(entry, stage)
    beyond = [one.text for limit in entry.limit if not (one := judged(limit, document)).met]
    return replace(stage, state="failed", found="; ".join(beyond)) if beyond else stage
