"""What commands write with `--json` that no other part of the program knows of."""

from typing import Any, Literal

from pydantic import Field

from catseye.app.protocol.engine_events import Dropped, EngineEvent
from catseye.app.protocol.message import Message, absent
from catseye.app.protocol.run_events import RunEvent
from catseye.app.protocol.snapshot import Snapshot
from catseye.app.results.document import Document


class Failure(Document):
    """Why a command has nothing else to say.

    Attributes:
        error: cause and remedy.
        exit_code: of the process.
    """

    error: str
    exit_code: int


class Refused(Document):
    """Why a result is not kept.

    Attributes:
        reason: a word for programs.
        text: for people.
        findings: what speaks against it.
    """

    reason: str
    text: str
    findings: tuple[str, ...]


class ExpectedStage(Document):
    """A stage of a job of a campaign that is only planned.

    Attributes:
        stage: its name.
        holds: it is done and holds, and is not done again.
        expected_s: how long it takes by its newest run, real s; null where nothing is known.
        run: by which that is known; null for none.
    """

    stage: str
    holds: bool
    expected_s: float | None
    run: str | None


class CampaignPlan(Document):
    """What a job would do.

    Attributes:
        job: its id; empty for a new one.
        stages: in their order.
        expected_s: all that is known of the rest, real s.
        unknown: stages of the rest of which nothing is known.
    """

    job: str
    stages: tuple[ExpectedStage, ...]
    expected_s: float
    unknown: tuple[str, ...]


class DetachedRun(Document):
    """A run whose engine is a process of its own session.

    Attributes:
        run: its name.
        path: of its record.
    """

    run: str
    path: str


class SnapshotLine(Message):
    """The first line of `attach`: everything as it is now."""

    v: int
    snapshot: Snapshot


class AnswerLine(Message):
    """The answer to a request; what it carries beside depends on the request.

    Attributes:
        v: version of the messages.
        re: number of the request; null for what the terminal itself asked.
        ok: it is done.
        error: why it is not.
        exit_code: that the refusal leads to.
    """

    v: int
    re: int | str | None
    ok: bool
    error: str = ""
    exit_code: int | None = None


RunLine = RunEvent | Dropped
"""What `run --json` writes: events, and how many of them a slow reader has missed."""

AttachedLine = SnapshotLine | AnswerLine | RunEvent | EngineEvent


class Endpoint(Document):
    """An emulator that answers.

    Attributes:
        device: its name in the cell file.
        protocol: driver whose bytes it speaks.
        endpoint: where it listens.
    """

    device: str
    protocol: str
    endpoint: str


class CellCheck(Document):
    """Whether a cell file can be used.

    Attributes:
        file: as it was given.
        valid: it can.
        name: of the cell; null where it cannot.
        sha256: of the file; null where it cannot.
        warnings: values that are hardly meant.
        faults: with line, key and remedy.
    """

    file: str
    valid: bool
    name: str | None = Field(default=None, exclude_if=absent)
    sha256: str | None = Field(default=None, exclude_if=absent)
    warnings: list[str] | None = Field(default=None, exclude_if=absent)
    faults: list[str] | None = Field(default=None, exclude_if=absent)


class CellValues(Document):
    """A cell as it is used.

    Attributes:
        file: as it was given.
        sha256: of the file.
        configuration: every value, as the schema of the cell file has it.
        origins: where each value comes from, by its key with dots.
    """

    file: str
    sha256: str
    configuration: dict[str, Any]
    origins: dict[str, str]


class AlarmFound(Document):
    """The alarm of a controller.

    Attributes:
        alarm: its number; 0 for none.
        text: what the controller says of it.
        reset: it has been reset.
    """

    alarm: int
    text: str
    reset: bool


class MappingPreview(Document):
    """How a file of another program would be read.

    Attributes:
        mapping: what a mapping file says.
        positions: that the file has.
        headings: of its columns, by what is read in them.
        samples: that a recording has.
        rate_hz: of a recording; null where nothing says it.
    """

    mapping: dict[str, Any]
    positions: int | None = Field(default=None, exclude_if=absent)
    headings: dict[str, str] | None = Field(default=None, exclude_if=absent)
    samples: int | None = Field(default=None, exclude_if=absent)
    rate_hz: float | None = None


class CompensationTables(Document):
    """Tables of corrections that a controller interpolates.

    Attributes:
        output: files, one a joint.
        form: name of their format.
        links_mm: of the controller's kinematics, without which the tables do not hold.
    """

    output: list[str]
    form: Literal["kw-ssfk"] = "kw-ssfk"
    links_mm: tuple[float, ...]


class PromptEntry(Document):
    """A question that a run of a procedure may ask.

    Attributes:
        id: of its prompts: `<reflector>` stands for what differs, `[/<number>]` for an end that may be missing.
        kind: what an answer may be.
        about: what is asked.
        answers: that it can have; empty where anything of its kind can be typed.
        unit: of a number.
        safe_answer: taken where nobody answers; null where the run then ends with exit code 4.
        motion: the arm moves after an answer that does not let it rest.
        from_file: answers that a file may give to a real arm; null for every one. To emulators it may give all.
        example: a line of an answers file.
        by: who asks it.
    """

    id: str
    kind: str
    about: str
    answers: tuple[str, ...]
    unit: str
    safe_answer: str | None
    motion: bool
    from_file: tuple[str, ...] | None
    example: str
    by: Literal["procedure", "engine"]


class PromptsDocument(Document):
    """What a run of a procedure may ask.

    Attributes:
        procedure: its name.
        prompts: its own, then those of the engine, which every run may ask.
    """

    procedure: str
    prompts: tuple[PromptEntry, ...]


class ShippedCampaign(Document):
    """A campaign file that comes with the program.

    Attributes:
        name: that stands for it on the command line.
        path: to copy it from.
    """

    name: str
    path: str


class PrunedRun(Document):
    """A run that is older than what was asked for.

    Attributes:
        run: its name.
        bytes: that it takes, or took.
        removed: it is gone.
        why_not: why it stays; empty where it goes.
    """

    run: str
    bytes: int
    removed: bool
    why_not: str
