"""What the bodies of an arm have to keep clear of, as a cell file has it."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from catseye.app.cell.arm import Triple
from catseye.app.cell.section import Finite, Name, NotNegative, Positive, Section


class Box(Section):
    """[[workspace.keep_out]], [[workspace.keep_in]]: a box along the axes of the arm's base."""

    name: Name
    min_mm: Triple
    max_mm: Triple

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not all(low < high for low, high in zip(self.min_mm, self.max_mm, strict=True)):
            raise ValueError(f"box {self.name}: each of min_mm has to be below its max_mm")
        return self


class Table(Section):
    """[workspace.table]: what arm and reflectors stand on."""

    z_mm: Finite = 0.0
    confirmed: bool = False


class Stands(Section):
    """[workspace.stands]: the reflectors with what carries them, from the table up to the flange."""

    radius_mm: Positive = 15.0
    confirmed: bool = False


class Flange(Section):
    """[workspace.flange]: height of the flange above the foot where a sliding joint is at 0; None: as described."""

    z_mm: Finite | None = None
    confirmed: bool = False


class Workspace(Section):
    """[workspace]: what is kept clear of, and how far."""

    clearance_mm: Annotated[NotNegative, Field(le=100.0)] = 5.0
    table: Table = Table()
    stands: Stands = Stands()
    flange: Flange = Flange()
    keep_out: list[Box] = Field(default_factory=list)
    keep_in: list[Box] = Field(default_factory=list)
