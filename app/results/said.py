"""Statements as plain values: commands write them with `--json`, and the terminal UI reads them back."""

from collections.abc import Iterable

from pydantic import Field

from catseye.app.results.document import Document
from catseye.app.results.model import Block, Section, Sign, Statement


class Said(Document):
    """A sentence and how it is meant.

    Attributes:
        short: its figure alone, where it stands for the whole; empty otherwise.
    """

    sign: Sign
    text: str
    short: str = ""


class Verdicts(Document):
    """What any document says in sentences; whatever else it holds is passed over."""

    said: tuple[Said, ...] = Field(default=())


def said(blocks: Iterable[Block]) -> tuple[Said, ...]:
    """Return the statements among blocks, in order."""
    return tuple(Said.model_validate(block) for block in blocks if isinstance(block, Statement))


def said_in(sections: Iterable[Section]) -> tuple[Said, ...]:
    """Return the statements of sections, in order."""
    return said(block for one in sections for block in one.blocks)


def before_and_after(before: str, after: str) -> str:
    """Return how a figure changed, in a few words."""
    return f"{before} → {after}"
