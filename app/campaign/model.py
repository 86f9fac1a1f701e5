"""The campaign file: stages with parameters and limits, and what becomes of the others when one fails."""

import math
from typing import Annotated, Literal, Self

import tomlkit
from pydantic import Field, StringConstraints, model_validator

from catseye.app.cell.section import Finite, Name, NotNegative, Positive, Section

FORMAT = "catseye-campaign/1"

OnFailure = Literal["stop", "go-on"]

_Text = Annotated[str, StringConstraints(pattern=r"^[^\x00]*$")]
"""What the words of a process may hold."""

_Scalar = bool | int | Finite | _Text
Value = _Scalar | list[_Scalar]
"""What a parameter or an option may be given as."""

_Place = Annotated[str, StringConstraints(pattern=r"^[^.\s]+(\.[^.\s]+)*$")]


class Limit(Section):
    """What a value of a stage's document may be.

    Attributes:
        value: where it stands, keys joined by dots; `*` stands for every key or place of a list.
        min: smallest value that passes.
        max: largest value that passes.
        guard_k: the value passes only if it does with so many standard uncertainties to spare (ISO 14253-1).
    """

    value: _Place
    min: Finite | None = None
    max: Finite | None = None
    guard_k: NotNegative = 0.0

    @model_validator(mode="after")
    def _limits_something(self) -> Self:
        if self.min is None and self.max is None:
            raise ValueError(f"the limit of {self.value} has neither min nor max: give one of them")
        if self.low > self.high:
            raise ValueError(f"the limit of {self.value} has min {self.min:g} above max {self.max:g}")
        return self

    @property
    def low(self) -> float:
        """Smallest value that passes."""
        return -math.inf if self.min is None else self.min

    @property
    def high(self) -> float:
        """Largest value that passes."""
        return math.inf if self.max is None else self.max

    @property
    def text(self) -> str:
        """Its range, for people."""
        parts = (("≥", self.min), ("≤", self.max))
        return " and ".join(f"{sign} {bound:g}" for sign, bound in parts if bound is not None)


class StageEntry(Section):
    """One stage.

    Attributes:
        name: of the stage, as the list of the day has it; of one with `command` any name of its own.
        params: of a procedure.
        options: of a command on stored data, by the names of its options without the dashes.
        files: that its command asks for, by their names in the list of the day.
        command: words of a command on stored data that the list of the day does not have.
        limit: what its values may be.
        retries: how often it is tried again when it fails.
        retry_after_s: real s before that.
        time_limit_s: real s that one try may take; None for as long as the job has.
        on_failure: whether the stages after it are done where it does not pass; None as the file says for all.
    """

    name: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9 _.+-]{0,59}$")]
    params: dict[str, Value] = Field(default_factory=dict)
    options: dict[str, Value] = Field(default_factory=dict)
    files: dict[str, _Text] = Field(default_factory=dict)
    command: list[_Text] = Field(default_factory=list)
    limit: list[Limit] = Field(default_factory=list)
    retries: Annotated[int, Field(ge=0, le=20)] = 0
    retry_after_s: NotNegative = 10.0
    time_limit_s: Positive | None = None
    on_failure: OnFailure | None = None

    @model_validator(mode="after")
    def _is_one_thing(self) -> Self:
        if self.command and (self.params or self.options or self.files):
            raise ValueError(f"stage {self.name}: put everything into the words of its command")
        return self


class Campaign(Section):
    """A campaign file.

    Attributes:
        name: begins the name of a job that is given none.
        reuse: a stage counts as done by a run of the same job, or by any run of the cell that still holds.
        on_failure: whether the stages after one that does not pass are done.
        deadline: when a job has to be over, a time of day or a duration; empty for never.
        answers: of questions, by their ids.
        stage: in their order.
    """

    format: Literal["catseye-campaign/1"]
    name: Name
    reuse: Literal["job", "cell"] = "job"
    on_failure: OnFailure = "stop"
    deadline: str = ""
    answers: dict[str, bool | int | Finite | str] = Field(default_factory=dict)
    stage: Annotated[list[StageEntry], Field(min_length=1)]

    @model_validator(mode="after")
    def _names_are_own(self) -> Self:
        names = [each.name for each in self.stage]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise ValueError(f"two [[stage]] are called {twice}: each is done once")
        return self

    def goes_on_after(self, entry: StageEntry) -> bool:
        """Return whether the stages after one that does not pass are done."""
        return (entry.on_failure or self.on_failure) == "go-on"


def value_text(value: Value) -> str:
    """Return a value as the command line takes it."""
    return value if isinstance(value, str) else toml_text(value)


def toml_text(value: Value) -> str:
    """Return a value as a TOML file has it."""
    return str(tomlkit.item(value).as_string())
