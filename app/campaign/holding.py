"""Which stages of a job are done, and hold."""

from catseye.app.campaign.job import Job
from catseye.app.campaign.load import LoadedCampaign
from catseye.app.campaign.model import StageEntry
from catseye.app.exitcode import ExitCode
from catseye.app.results.readiness.stages import CellStage


class Holding:
    """What a job has done, held against what its campaign says now."""

    def __init__(self, loaded: LoadedCampaign, job: Job) -> None:
        self._loaded = loaded
        self._campaign = loaded.campaign
        self._job = job
        self._fingerprints: dict[str, str] = {}

    def look(self) -> None:
        """Take note of what the campaign says now, its files included; blocks.

        Raises:
            StorageError: a file that it names cannot be read.
        """
        self._fingerprints = {each.name: self._loaded.fingerprint(each) for each in self._campaign.stage}

    def work(self, entry: StageEntry) -> str:
        """Return the fingerprint of a stage, as of the last look."""
        return self._fingerprints[entry.name]

    def is_same_work(self, entry: StageEntry) -> bool:
        """Return whether the last try of a stage did what the campaign says now."""
        tries = self._job.tries(entry.name)
        return bool(tries) and tries[-1].work == self.work(entry)

    def holds(self, entry: StageEntry, stage: CellStage | None) -> bool:
        """Return whether a stage is done, and holds.

        Args:
            stage: as the day's list has it; None of one with a command of its own.
        """
        tried, went_well = bool(self._job.tries(entry.name)), self._went_well(entry)
        if stage is None:
            # Of its own command only the job knows; it is done again with whatever is done again before it.
            return went_well and self._is_newest(entry)
        if stage.procedure:
            # A run that nobody watched to its end may be done all the same; one of other parameters is not.
            return stage.state == "done" and (self.is_same_work(entry) or not tried)
        return stage.state in {"done", "failed"} and (
            went_well or (not tried and self._campaign.reuse == "cell")
        )

    def _went_well(self, entry: StageEntry) -> bool:
        """Return whether the last try of a stage, as the campaign has it now, went well."""
        return self.is_same_work(entry) and self._job.tries(entry.name)[-1].exit_code == ExitCode.DONE

    def _is_newest(self, entry: StageEntry) -> bool:
        """Return whether no stage before it was tried after it."""
        names = [each.name for each in self._campaign.stage]
        before = names[: names.index(entry.name)]
        tried = [one.place for name in before for one in self._job.tries(name)[-1:]]
        return all(place <= self._job.tries(entry.name)[-1].place for place in tried)
