"""A job: one time through a campaign, which goes on after anything that interrupts it."""

import fcntl
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Final, Literal

from pydantic import BaseModel, ValidationError

from catseye.app.campaign.load import LoadedCampaign
from catseye.app.errors import CatseyeError, StorageError, UsageError
from catseye.app.exitcode import ExitCode
from catseye.app.files.atomic import write_atomically
from catseye.app.files.documents import LARGEST_RESULT_BYTES, read_document
from catseye.app.protocol.campaign_events import CampaignEnded
from catseye.app.store.run_names import STARTED

_FOLDER: Final = "jobs"
_FILE: Final = "job.json"
_VERDICT: Final = "verdict.json"
_ID: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+-]{0,79}")


class CampaignBusyError(CatseyeError):
    """Another job of this cell is under way."""

    exit_code = ExitCode.TIMEOUT


class Attempt(BaseModel):
    """One try of a stage.

    Attributes:
        place: among all tries of the job, from 1: clocks are set.
        command: as somebody would type it.
        work: `LoadedCampaign.fingerprint` of the stage; empty of one that was tried before there were any.
        started: UTC time.
        ended: UTC time; None where the job died meanwhile.
        exit_code: of the process; None where the job died meanwhile.
        text: why it failed; empty otherwise.
    """

    place: int = 0
    command: str
    work: str = ""
    started: str
    ended: str | None = None
    exit_code: int | None = None
    text: str = ""


class JobRecord(BaseModel):
    """What a job knows of itself beside its runs and files.

    Attributes:
        format: of the file.
        job: its id.
        campaign: name of the campaign.
        campaign_sha256: of the bytes of its file, as it was read last.
        cell: name of the cell.
        started: UTC time at which it first began.
        tries: of each stage.
        verdict: how it ended last; None before its first end.
    """

    format: Literal["catseye-job/1"] = "catseye-job/1"
    job: str
    campaign: str
    campaign_sha256: str
    cell: str
    started: str
    tries: dict[str, tuple[Attempt, ...]] = {}
    verdict: CampaignEnded | None = None

    @property
    def passed(self) -> bool:
        """Whether its last end was that every stage has passed."""
        return self.verdict is not None and self.verdict.verdict == "passed"


class Job:
    """A job with its folder.

    Attributes:
        folder: of what belongs to it alone.
        record: what it knows of itself.
        goes_on: it had begun before.
    """

    def __init__(self, folder: Path, record: JobRecord, *, goes_on: bool) -> None:
        self.folder = folder
        self.record = record
        self.goes_on = goes_on

    @classmethod
    def seen(cls, root: Path, job: str, loaded: LoadedCampaign, cell: str, now: datetime) -> "Job":
        """Return a job as it would go on, or begin; nothing is written.

        Args:
            root: folder of the runs.
            job: its id.

        Raises:
            ConfigError: its record cannot be read.
            UsageError: it is of another cell or campaign, or the id cannot name a folder.
        """
        folder = jobs_folder(root) / _checked(job)
        path = folder / _FILE
        if not path.is_file():
            record = JobRecord(
                job=job,
                campaign=loaded.campaign.name,
                campaign_sha256=loaded.sha256,
                cell=cell,
                started=now.isoformat(timespec="milliseconds"),
            )
            return cls(folder, record, goes_on=False)
        record = _read(path)
        _require_same(record, loaded, cell)
        if not record.passed or record.campaign_sha256 != loaded.sha256:
            record = record.model_copy(update={"campaign_sha256": loaded.sha256, "verdict": None})
        return cls(folder, record, goes_on=True)

    @classmethod
    def opened(cls, root: Path, job: str, loaded: LoadedCampaign, cell: str, now: datetime) -> "Job":
        """Return a job that exists, or begin it; one that has passed stays as it is while the campaign is the same.

        Args:
            root: folder of the runs.
            job: its id.

        Raises:
            ConfigError: its record cannot be read.
            StorageError: its folder cannot be made.
            UsageError: it is of another cell or campaign, or the id cannot name a folder.
        """
        opened = cls.seen(root, job, loaded, cell, now)
        if opened.record.passed:
            return opened
        try:
            opened.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StorageError(f"{opened.folder}: no folder can be made there: {error.strerror}") from error
        opened.forget_verdict()
        opened.save()
        return opened

    def tries(self, stage: str) -> tuple[Attempt, ...]:
        """Return the tries of a stage."""
        return self.record.tries.get(stage, ())

    @property
    def next_place(self) -> int:
        """The place of the next try."""
        return 1 + sum(map(len, self.record.tries.values()))

    def began(self, stage: str, attempt: Attempt) -> None:
        """Keep that a stage is tried."""
        self._set_tries({**self.record.tries, stage: (*self.tries(stage), attempt)})

    def tried(self, stage: str, attempt: Attempt) -> None:
        """Keep how the try of a stage that was begun last has ended."""
        self._set_tries({**self.record.tries, stage: (*self.tries(stage)[:-1], attempt)})

    def ended(self, verdict: CampaignEnded) -> None:
        """Keep how it ended."""
        # A job whose record says that it has passed is not touched any more: that is written last.
        write_atomically(self.folder / _VERDICT, verdict.model_dump_json(indent=1) + "\n")
        self.record = self.record.model_copy(update={"verdict": verdict})
        self.save()

    def forget_verdict(self) -> None:
        """Take away how it ended before: whoever dies now has not ended.

        Raises:
            StorageError: the file cannot be removed.
        """
        path = self.folder / _VERDICT
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise StorageError(f"{path}: cannot be removed: {error.strerror}; check the rights") from error
        self.record = self.record.model_copy(update={"verdict": None})

    def save(self) -> None:
        """Write its record.

        Raises:
            StorageError: it cannot be written.
        """
        write_atomically(self.folder / _FILE, self.record.model_dump_json(indent=1) + "\n")

    def _set_tries(self, tries: Mapping[str, tuple[Attempt, ...]]) -> None:
        self.record = self.record.model_copy(update={"tries": dict(tries)})
        self.save()


def jobs_folder(root: Path) -> Path:
    """Return the folder of all jobs of a folder of runs."""
    return root / _FOLDER


def job_id(campaign: str, now: datetime) -> str:
    """Return the id of a job that is given none."""
    return f"{campaign}-{now:{STARTED}}"


@contextmanager
def alone(root: Path, cell: str) -> Iterator[None]:
    """Let no other job of a cell begin meanwhile; the kernel gives the right back when this process dies.

    Raises:
        CampaignBusyError: another one is under way.
        StorageError: the folder of jobs cannot be made.
    """
    path = jobs_folder(root) / f".{cell}.lock"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise StorageError(f"{path}: cannot be made: {error.strerror}; check folder and rights") from error
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise CampaignBusyError(
                f"another job of cell {cell} is under way in {root}: wait for its end (--wait-lock), or end it"
            ) from error
        yield
    finally:
        os.close(descriptor)


def _checked(job: str) -> str:
    if not _ID.fullmatch(job):
        raise UsageError(
            f"--job {job!r}: an id begins with a letter or digit and goes on with letters, digits, _ . + and -, "
            "80 at most"
        )
    return job


def _read(path: Path) -> JobRecord:
    raw = read_document(path, largest_bytes=LARGEST_RESULT_BYTES)
    try:
        return JobRecord.model_validate_json(raw)
    except ValidationError as error:
        raise UsageError(
            f"{path}: is no record of a job ({error.errors()[0]['msg']}): choose another --job, or restore the file"
        ) from error


def _require_same(record: JobRecord, loaded: LoadedCampaign, cell: str) -> None:
    if record.cell != cell:
        raise UsageError(f"job {record.job} is of cell {record.cell}, not of {cell}: choose another --job")
    if record.campaign != loaded.campaign.name:
        raise UsageError(
            f"job {record.job} is of campaign {record.campaign}, not of {loaded.campaign.name}: choose another --job"
        )
