"""Mappings of tables that other programs wrote: which of their columns are what, and how the file is written."""

from collections.abc import Mapping
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from catseye.drivers.roles.text_table import Decimal, Dialect, Encoding, Separator

FORMAT: Final = "catseye-mapping/1"

LENGTHS: Final[Mapping[str, float]] = {
    "mm": 1.0,
    "um": 1e-3,
    "nm": 1e-6,
    "cm": 10.0,
    "m": 1e3,
    "inch": 25.4,
}
"""What a unit is worth in mm."""


class _Mapped(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class MappedColumn(_Mapped):
    """Where a column comes from: its place from 1, the unit there, 1 or −1 for its sign."""

    column: Annotated[int, Field(ge=1, le=1000)]
    unit: str
    sign: Literal[1, -1] = 1


class MappedColumns(_Mapped):
    """Columns of a table, by the names that this program has for them."""

    units: ClassVar[Mapping[str, Mapping[str, float]]]
    """What a unit is worth, by the column that it is turned into."""

    def given(self) -> dict[str, MappedColumn]:
        """Return those that are stated, by name."""
        return {name: one for name in self.units if (one := getattr(self, name)) is not None}

    @model_validator(mode="after")
    def _have_known_units(self) -> Self:
        for name, one in self.given().items():
            if one.unit not in self.units[name]:
                raise ValueError(
                    f"{name}: unknown unit {one.unit!r}; there are {', '.join(self.units[name])}"
                )
        return self


class TableMapping(_Mapped):
    """What all mapping files say; each kind of table adds its columns."""

    format: Literal["catseye-mapping/1"] = FORMAT
    separator: Separator
    decimal: Decimal
    header_lines: Annotated[int, Field(ge=0, le=10_000)]
    encoding: Encoding = "utf-8"
    columns: MappedColumns

    @model_validator(mode="after")
    def _keeps_numbers_apart(self) -> Self:
        if self.decimal == "," and self.separator == ",":
            raise ValueError("separator and decimal sign cannot both be commas")
        return self

    @property
    def dialect(self) -> Dialect:
        """How the file is written."""
        return Dialect(self.separator, self.decimal, self.header_lines, self.encoding)
