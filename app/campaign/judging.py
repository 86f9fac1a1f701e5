"""What a stage's end means for the job."""

from collections.abc import Mapping
from typing import Any, Final

from catseye.app.campaign.ending import Cause
from catseye.app.campaign.limits import judged
from catseye.app.campaign.model import StageEntry
from catseye.app.errors import exit_code_of, text_of
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.campaign_events import Code, StageVerdict
from catseye.app.results.readiness.stages import CellStage

_CODES: Final[Mapping[int, Code]] = {
    ExitCode.REJECTED: "rejected",
    ExitCode.USAGE: "usage",
    ExitCode.DEVICE: "device",
    ExitCode.TIMEOUT: "timeout",
    ExitCode.SAFETY: "safety",
    ExitCode.STORAGE: "storage",
    ExitCode.FAULT: "fault",
    ExitCode.INTERRUPTED: "interrupted",
    ExitCode.TERMINATED: "terminated",
}

_EXITS: Final[Mapping[Code, ExitCode]] = {
    **{code: ExitCode(number) for number, code in _CODES.items()},
    "limit": ExitCode.REJECTED,
    "criterion": ExitCode.REJECTED,
    "deadline": ExitCode.TIMEOUT,
    "time-limit": ExitCode.TIMEOUT,
    "busy": ExitCode.TIMEOUT,
    "killed": ExitCode.DEVICE,
    "waits-for": ExitCode.USAGE,
}

_OF_THE_PROCESS: Final = frozenset[Code]({"interrupted", "terminated"})


def not_done(entry: StageEntry, cause: Cause, exit_code: int | None = None) -> StageVerdict:
    """Return that a stage was not done, and why."""
    return StageVerdict(
        stage=entry.name, verdict="not-done", code=cause.code, text=cause.text, exit_code=exit_code
    )


def of_exit(entry: StageEntry, exit_code: int, text: str) -> StageVerdict:
    """Return what the exit code of a stage that did not go well means."""
    if exit_code < 0 or exit_code not in _CODES:
        said = f"its process was ended by signal {-exit_code}" if exit_code < 0 else text
        return not_done(entry, Cause("killed", said), exit_code)
    code = _CODES[exit_code]
    verdict = not_done(entry, Cause(code, text), exit_code)
    # The measurement itself says no; everything else has kept it from saying anything.
    return verdict.model_copy(update={"verdict": "failed"}) if code == "rejected" else verdict


def judged_stage(entry: StageEntry, stage: CellStage | None, document: object) -> StageVerdict:
    """Return the verdict of a stage that came to its end.

    Args:
        stage: as the day's list has it; None of one with a command of its own.
        document: what its limits judge.
    """
    found: dict[str, Any] = {}
    if stage is not None:
        found = {"found": stage.found, "runs": stage.runs, "files": tuple(map(str, stage.files))}
    limits = tuple(judged(limit, document) for limit in entry.limit)
    beyond = [one.text for one in limits if not one.met]
    if beyond:
        return _verdict(entry, "limit", "; ".join(beyond), limits=limits, **found)
    if stage is not None and not _reached(stage):
        text = stage.text if stage.state != "failed" else f"not reached: {stage.found}"
        return _verdict(entry, "criterion", text, limits=limits, **found)
    said = "" if stage is None else stage.found or stage.text
    return _verdict(entry, "passed", said or "done", limits=limits, **found)


def _reached(stage: CellStage) -> bool:
    """Return whether a stage that came to its end has what is wanted of it.

    A command on stored data says by its exit code that it is done; the list of the day goes by the times of files,
    which a clock that was set back makes older than what they were made from.
    """
    return stage.state == "done" or (not stage.procedure and stage.state != "failed")


def of_error(error: Exception) -> Cause:
    """Return why a job cannot go on."""
    return Cause(_CODES.get(exit_code_of(error), "fault"), text_of(error))


def _verdict(entry: StageEntry, code: Code, text: str, **found: Any) -> StageVerdict:
    verdict = "passed" if code == "passed" else "failed"
    return StageVerdict(stage=entry.name, verdict=verdict, code=code, text=text, **found)


def deciding(stages: tuple[StageVerdict, ...]) -> StageVerdict | None:
    """Return the verdict of the stage that decides about the job; None where every one has passed.

    What ended the job from outside comes first, then the first failure, then the first thing that was not done.
    """
    ended = (each for each in stages if each.code in _OF_THE_PROCESS)
    failed = (each for each in stages if each.verdict == "failed")
    left = (each for each in stages if each.verdict == "not-done")
    return next(ended, None) or next(failed, None) or next(left, None)


def exit_code_of_job(decided: StageVerdict | None) -> ExitCode:
    """Return the exit code of a job."""
    if decided is None:
        return ExitCode.DONE
    return _EXITS.get(decided.code, ExitCode.REJECTED)
