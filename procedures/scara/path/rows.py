"""Rows that a path is driven by: wished places, or joint commands that are driven as they stand."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

Number = Annotated[float, Field(allow_inf_nan=False)]
State = Literal[1, -1]
"""State of approach of a joint."""


class _Row(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    line: int | None = None


_STATED = ("x_mm", "y_mm", "theta1_deg", "theta2_deg", "direction1", "direction2")


class JointRow(_Row):
    """A joint command that is driven as it stands.

    Attributes:
        line: that the row belongs to; None for a path that names none.
        x_mm: where the arm shall stand.
        y_mm: where the arm shall stand.
        theta1_deg: command of J1.
        theta2_deg: command of J2.
        direction1: state of approach of J1.
        direction2: state of approach of J2.
        j3_mm: command of J3; None for the height of the cell file.
        j4_deg: command of J4; None for 0.
    """

    x_mm: Number
    y_mm: Number
    theta1_deg: Number
    theta2_deg: Number
    direction1: State
    direction2: State
    j3_mm: Number | None = None
    j4_deg: Number | None = None

    @model_validator(mode="before")
    @classmethod
    def _of_a_list(cls, row: Any) -> Any:
        """Take the six numbers of a list: so they stand in runs of earlier versions."""
        if not isinstance(row, list | tuple):
            return row
        if len(row) != len(_STATED):
            raise ValueError(
                f"a row has at least 6 items ({', '.join(_STATED)}), and this one has {len(row)}"
            )
        *numbers, one, two = row
        return dict(zip(_STATED, (*numbers, _state(one), _state(two)), strict=True))


class PathRow(_Row):
    """A wished place, or a joint command whose nominal place is wished.

    Attributes:
        line: that the row belongs to; None for a path that names none.
        x_mm: where the arm shall stand; None for a joint command.
        y_mm: likewise.
        theta1_deg: command of J1; None for a place.
        theta2_deg: likewise.
        direction1: state of approach of J1; None for a place.
        direction2: likewise.
        z_mm: height; None for that of the cell file.
        c_deg: orientation of the tool in the world; None where J4 stands at 0.
        speed_mm_s: for programs; a measurement stands still at each point.
    """

    x_mm: Number | None = None
    y_mm: Number | None = None
    theta1_deg: Number | None = None
    theta2_deg: Number | None = None
    direction1: State | None = None
    direction2: State | None = None
    z_mm: Number | None = None
    c_deg: Number | None = None
    speed_mm_s: Number | None = None

    @model_validator(mode="after")
    def _has_one_form(self) -> Self:
        stated = tuple(name for name in _STATED if getattr(self, name) is not None)
        if stated not in (_STATED[:2], _STATED[2:]):
            raise ValueError(f"a row states either {', '.join(_STATED[:2])} or {', '.join(_STATED[2:])}")
        return self


def line_of(rows: Sequence[_Row]) -> list[int]:
    """Return the number of the line of each row; 1 where a path names none."""
    return [1 if row.line is None else row.line for row in rows]


def _state(value: Any) -> Any:
    """Return 1 or -1 for the same as a float; what is neither, as it is."""
    return int(value) if value in (1.0, -1.0) else value
