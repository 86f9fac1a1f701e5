"""What a result or a run comes to, in sentences and figures; it reads files, so call it in a thread."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from catseye.app.errors import CatseyeError
from catseye.app.results.figures import Figure
from catseye.app.results.model import Block, Sign, Statement
from catseye.app.tui import result_shelf as shelf

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.tui.result_shelf import AnyFile

_SENTENCES: Final = 6
_EVENTS, _EVENTS_ALONE = 8, 40
"""Newest events of a run, with figures below them and without."""


@dataclass(frozen=True)
class Previewed:
    """What is shown beside a table.

    Attributes:
        said: the most telling first.
        figures: one below the other.
    """

    said: tuple[Statement, ...] = ()
    figures: tuple[Figure, ...] = ()


def previewed_result(file: "AnyFile") -> Previewed:
    """Return what a result says, and its first figure."""
    if file.result is None:
        return Previewed((Statement(Sign.BAD, file.fault),))
    if (kind := shelf.report_kind(file)) is not None:
        found = _of_blocks(kind.report(kind.files(file.path, file.result)).blocks())
        return Previewed(found.said[:_SENTENCES], found.figures[:1])
    scaras = shelf.as_scaras(file)
    if scaras is None or scaras.result is None:
        return Previewed()
    from catseye.app.results.scara.figures.maps import map_figure
    from catseye.app.results.scara.result_report import residual_figures
    from catseye.app.tui.result_texts import fit_sentences

    figure = map_figure(scaras.result) or next(iter(residual_figures(scaras.result)), None)
    said = tuple(fit_sentences(scaras.result, None)[:_SENTENCES])
    return Previewed(said, () if figure is None else (figure,))


def previewed_run(path: Path) -> Previewed:
    """Return what a run has found, its figures and its newest events."""
    from catseye.app.results.found import found_sections
    from catseye.app.store.reader import RunReader
    from catseye.app.tui.record import read_record

    try:
        found = _of_blocks(block for one in found_sections(RunReader(path)) for block in one.blocks)
        log = read_record(path).log[-(_EVENTS if found.figures else _EVENTS_ALONE) :]
    except CatseyeError as error:
        return Previewed((Statement(Sign.BAD, str(error)),))
    events = (Statement(Sign.NEUTRAL, f"{line.t[11:19]} {line.text}") for line in log)
    return Previewed((*found.said[:_SENTENCES], *events), found.figures[:2])


def _of_blocks(blocks: Iterable[Block]) -> Previewed:
    every = tuple(blocks)
    said = tuple(block for block in every if isinstance(block, Statement))
    return Previewed(said, tuple(block for block in every if isinstance(block, Figure)))
