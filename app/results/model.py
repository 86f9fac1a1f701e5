"""What an analysis says: statements with their sign, tables of typed columns, figures as data.

A renderer adds nothing to it and judges nothing: words, signs and number formats are decided here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from catseye.app.protocol.banners import SIMULATION_TEXT, unverified_text
from catseye.app.results.figures import Figure
from catseye.app.results.numbers import TEXT, Format


class Sign(StrEnum):
    """How a statement is meant."""

    GOOD = "good"
    ATTENTION = "attention"
    BAD = "bad"
    NEUTRAL = "neutral"


@dataclass(frozen=True)
class Statement:
    """A whole sentence and how it is meant.

    Attributes:
        short: its figure alone, for a list of results; empty where it is none that stands for the whole.
        expanded: the same with its expanded uncertainty (k = 2), for a certificate; empty where none is known.
        see: figures and tables of the page that show it, as `figure-…` or `table-…` with their key.
    """

    sign: Sign
    text: str
    short: str = ""
    expanded: str = ""
    see: tuple[str, ...] = ()


@dataclass(frozen=True)
class Quantity:
    """A number whose format is its row's, not its column's: lengths and angles in one column.

    Attributes:
        value: the number.
        format: of it.
        standard: it is a standard uncertainty in a column of other values, shown as that of a `Column`.
    """

    value: float | None
    format: Format
    standard: bool = False


Cell: TypeAlias = str | int | float | Quantity | None
"""None where there is no value."""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        key: name of the value in JSON; the unit in it where it has one.
        title: heading without the unit.
        unit: of all values; empty for none.
        format: of its numbers; TEXT for texts.
        standard: the cells are standard uncertainties. Readers see them expanded (k = 2), so the title says U;
            programs get them as they are, so the key says u.
    """

    key: str
    title: str
    unit: str = ""
    format: Format = TEXT
    standard: bool = False


@dataclass(frozen=True)
class Table:
    """Rows of one kind; the first column names the row."""

    key: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True)
class Paragraph:
    """Text that explains; for pages only."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """Short texts without a sign; for pages only."""

    title: str
    texts: tuple[str, ...]


@dataclass(frozen=True)
class Listing:
    """Lines that keep their breaks, each marked by a class of its own or none."""

    lines: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Entries:
    """Texts that have a label each: parameters, a timeline. A text may have several lines."""

    entries: tuple[tuple[str, str], ...]


Block: TypeAlias = Statement | Table | Figure | Paragraph | Bullets | Listing | Entries


@dataclass(frozen=True)
class Section:
    """Part of a report; one without blocks is not shown.

    Attributes:
        key: anchor on the page, part on the screen.
        title: heading.
        blocks: in reading order.
        brief: the command line shows its statements and tables too.
    """

    key: str
    title: str
    blocks: tuple[Block, ...]
    brief: bool = False


@dataclass(frozen=True)
class Origin:
    """Where a report comes from.

    Attributes:
        software: name and version of the program.
        created_utc: ISO 8601 UTC time.
        simulated: a device was an emulator.
        unverified: what speaks against data that were changed after their end.
    """

    software: str
    created_utc: str
    simulated: bool = False
    unverified: tuple[str, ...] = ()

    @property
    def banners(self) -> list[str]:
        """What a reader has to know before anything else."""
        return [*map(unverified_text, self.unverified), *([SIMULATION_TEXT] if self.simulated else [])]


@dataclass(frozen=True)
class Report:
    """Everything that one analysis says."""

    title: str
    origin: Origin
    sections: tuple[Section, ...]

    def blocks(self, *, brief: bool = False) -> Iterator[Block]:
        """Yield all blocks, or those that the command line shows."""
        return (block for section in self.sections if section.brief or not brief for block in section.blocks)

    def section(self, key: str) -> Section:
        """Return a section by its key.

        Raises:
            KeyError: there is none.
        """
        for section in self.sections:
            if section.key == key:
                return section
        raise KeyError(key)

    def statements(self) -> list[Statement]:
        """Return all statements in order."""
        return [block for block in self.blocks() if isinstance(block, Statement)]

    def figures(self, section: str) -> list[Figure]:
        """Return the figures of a section."""
        return [
            block
            for one in self.sections
            if one.key == section
            for block in one.blocks
            if isinstance(block, Figure)
        ]

    def table(self, key: str) -> Table:
        """Return a table by its key.

        Raises:
            KeyError: there is none.
        """
        for block in self.blocks():
            if isinstance(block, Table) and block.key == key:
                return block
        raise KeyError(key)


def section(key: str, title: str, blocks: Sequence[Block | None], *, brief: bool = False) -> Section:
    """Return a section of the blocks that there are."""
    return Section(key, title, tuple(block for block in blocks if block is not None), brief)
