"""The dossier of a cell as a report: the certificate, a section for each stage, how it was measured."""

from dataclasses import replace

from catseye.app.results.dossier.certificate import certificate, figure_text, verdict_word
from catseye.app.results.dossier.day import Day, StageOfDay
from catseye.app.results.figures import Figure
from catseye.app.results.model import Block, Entries, Report, Section, section
from catseye.app.results.runs.sections import configuration_section, incident_section, run_section
from catseye.app.results.runs.trace import trace_section


def dossier_report(day: Day) -> Report:
    """Return the page of a day."""
    measurement = day.measurement
    sections = (
        certificate(day),
        *(_stage_section(number, one) for number, one in enumerate(day.stages, 1)),
        incident_section(measurement.warnings, measurement.incidents),
        run_section(measurement, ()),
        configuration_section(measurement.cell, measurement.origins),
        trace_section(day.origin.software, day.sources, measurement.runs, ()),
    )
    return Report(f"Dossier of cell {day.cell.name}", day.origin, sections)


def _stage_section(number: int, one: StageOfDay) -> Section:
    """Return state, run and figure of a stage, and what was found in it."""
    stage, key = one.stage, f"stage-{number}"
    about = (
        ("state", stage.state if not (word := verdict_word(one)) else f"{stage.state}, {word}"),
        ("run" if len(one.runs) == 1 else "runs", ", ".join(one.runs)),
        ("files", ", ".join(path.name for path in stage.files)),
        ("found", figure_text(one)),
        ("command", stage.command),
    )
    blocks = [_of_stage(key, block) for part in one.worth.sections for block in part.blocks]
    entries = Entries(tuple((label, text) for label, text in about if text))
    return section(key, f"{number}. {stage.name}", [entries, *blocks], brief=True)


def _of_stage(key: str, block: Block) -> Block:
    """Return a block for a page on which other stages may have figures of the same key."""
    return replace(block, key=f"{key}-{block.key}") if isinstance(block, Figure) else block
