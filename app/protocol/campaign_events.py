"""The events of a campaign, as `catseye campaign --json` writes them between those of its runs."""

from typing import Annotated, Literal

from pydantic import BaseModel, Field, PlainSerializer

from catseye.app.protocol.message import Event, absent

Verdict = Literal["passed", "failed", "not-done"]

Code = Literal[
    "passed",
    "limit",
    "criterion",
    "rejected",
    "usage",
    "device",
    "timeout",
    "safety",
    "storage",
    "fault",
    "killed",
    "interrupted",
    "terminated",
    "deadline",
    "time-limit",
    "waits-for",
    "busy",
]
"""Why a stage or a job has its verdict, for programs; docs/unattended.md says what each means."""


def _figures(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.9g}")


_Figure = Annotated[float | None, PlainSerializer(_figures)]


class LimitVerdict(BaseModel):
    """Whether a value is within its limit.

    Attributes:
        value: where it stands in the document of the stage.
        found: the value that is nearest to its limit or farthest beyond it; None where there is none.
        u: its standard uncertainty; None where none is stated.
        min: smallest value that passes; None for none.
        max: largest value that passes; None for none.
        guard_k: standard uncertainties that it has to spare.
        met: it passes.
        text: the same for people.
    """

    value: str
    found: _Figure
    u: _Figure
    min: float | None
    max: float | None
    guard_k: float
    met: bool
    text: str


class StageVerdict(BaseModel):
    """How a stage went.

    Attributes:
        stage: its name.
        verdict: passed, failed, or not done.
        code: why.
        text: the same for people.
        found: the figure that stands for it; empty where there is none.
        limits: of its values, in the order of the file.
        runs: names of its runs.
        files: that it wrote.
        exit_code: of its last try; None where there was none.
        tries: how often it was tried in this job.
        started: UTC time of the first try; None where there was none.
        ended: UTC time of the end of the last one.
    """

    stage: str
    verdict: Verdict
    code: Code
    text: str
    found: str = ""
    limits: tuple[LimitVerdict, ...] = ()
    runs: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    exit_code: int | None = None
    tries: int = 0
    started: str | None = None
    ended: str | None = None


class CampaignStarted(Event):
    """A job begins, or goes on.

    Attributes:
        job: its id.
        campaign: name of the campaign.
        cell: name of the cell.
        stages: names of the stages, in order.
        goes_on: the job had begun before.
        deadline: UTC time at which it has to be over; None for never.
    """

    event: Literal["campaign-started"] = "campaign-started"
    job: str
    campaign: str
    cell: str
    stages: tuple[str, ...]
    goes_on: bool
    deadline: str | None


class StageStarted(Event):
    """A stage is tried.

    Attributes:
        job: id of the job.
        stage: its name.
        number: of the stage, from 1.
        count: of stages.
        attempt: from 1.
        command: as somebody would type it.
        expected_s: how long the stage took the last time on this cell, real s; None where nobody knows.
        left_s: the same for it and all that is to be done after it, as far as somebody knows; None where nobody does.
        unknown: stages of these that are not counted in it.
    """

    event: Literal["stage-started"] = "stage-started"
    job: str
    stage: str
    number: int
    count: int
    attempt: int
    command: str
    expected_s: _Figure = None
    left_s: _Figure = None
    unknown: tuple[str, ...] = ()


class StageEnded(Event):
    """A stage has its verdict.

    Attributes:
        job: id of the job.
        result: the verdict.
    """

    event: Literal["stage-ended"] = "stage-ended"
    job: str
    result: StageVerdict


class CampaignEnded(Event):
    """A job is over; the last line.

    Attributes:
        format: of the document, which stands in the folder of the job too.
        job: its id.
        campaign: name of the campaign.
        campaign_sha256: of the bytes of its file.
        cell: name of the cell.
        verdict: passed if every stage has; failed if one has; otherwise not done.
        code: of the stage that decided it.
        text: for people.
        exit_code: of the process.
        started: UTC time at which the job first began.
        ended: UTC time.
        deadline: UTC time at which it had to be over; None for never.
        folder: of the job.
        stages: of each stage, in order.
    """

    event: Literal["campaign-ended"] = "campaign-ended"
    format: Literal["catseye-campaign-verdict/1"] = "catseye-campaign-verdict/1"
    job: str
    campaign: str
    campaign_sha256: str
    cell: str
    verdict: Verdict
    code: Code
    text: str
    exit_code: int
    started: str
    ended: str
    deadline: str | None = Field(default=None, exclude_if=absent)
    folder: str
    stages: tuple[StageVerdict, ...]


CampaignStep = CampaignStarted | StageStarted | StageEnded

CampaignEvent = CampaignStep | CampaignEnded
