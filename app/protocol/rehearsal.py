"""A plan that was gone through without any device, as `catseye run --dry-run --json` writes it."""

from typing import Annotated

from pydantic import BaseModel, Field, PlainSerializer

from catseye.app.protocol.message import absent
from catseye.drivers.roles.pose import Unit


def _rounded(digits: int) -> PlainSerializer:
    return PlainSerializer(lambda value: None if value is None else round(value, digits))


class RehearsedJoint(BaseModel):
    """A joint of the arm: its name and the unit of its values."""

    name: str
    unit: Unit


class RehearsedStep(BaseModel):
    """One line of the step table.

    Attributes:
        step: stable name within the run.
        title: what it does.
        moves: how many motions.
        measurements: how many distances, or measurements of targets and nests.
        duration_s: expected time.
        first: where its first motion ends, in the units of the joints; None of one without motions.
        end: pose at its end, in the same units.
        joint_deg_s: the fastest joint.
        tool_mm_s: the fastest tool.
        beam_mm: length of the beam at its end; None when nothing returns it.
        miss_mm: largest miss on the ways over which the beam is kept; None when it is kept on none.
    """

    step: str
    title: str
    moves: int
    measurements: int
    duration_s: Annotated[float, _rounded(3)]
    first: tuple[Annotated[float, _rounded(4)], ...] | None = Field(default=None, exclude_if=absent)
    end: tuple[Annotated[float, _rounded(4)], ...]
    joint_deg_s: Annotated[float, _rounded(3)]
    tool_mm_s: Annotated[float, _rounded(3)]
    beam_mm: Annotated[float | None, _rounded(3)]
    miss_mm: Annotated[float | None, _rounded(4)]


class RehearsedQuestion(BaseModel):
    """A question that will be asked; see `catseye.procedures.kit.context.Prompt`.

    Attributes:
        after_s: expected time from the beginning until it is asked.
    """

    id: str
    kind: str
    text: str
    after_s: float


class Rehearsal(BaseModel):
    """What a run would do, and how long it takes.

    Attributes:
        procedure: its name.
        total_s: expected time.
        override_percent: speed override of the run.
        led_deg_s: fastest joint while the arm is led along the beam; None where it stops at its targets.
        joint_deg_s: the fastest joint.
        tool_mm_s: the fastest tool.
        miss_mm: largest miss where the beam is kept; None when it never is.
        max_miss_mm: what the plan allows itself.
        joints: of the poses.
        steps: in order.
        warnings: what to know before it runs.
        questions: in the order in which they are asked.
    """

    procedure: str
    total_s: float
    override_percent: float
    led_deg_s: float | None = Field(default=None, exclude_if=absent)
    joint_deg_s: float
    tool_mm_s: float
    miss_mm: float | None
    max_miss_mm: float
    joints: tuple[RehearsedJoint, ...]
    steps: tuple[RehearsedStep, ...]
    warnings: tuple[str, ...]
    questions: tuple[RehearsedQuestion, ...]

    @property
    def misses_too_far(self) -> bool:
        """The beam misses by more than the plan allows itself."""
        return self.miss_mm is not None and self.miss_mm > self.max_miss_mm
