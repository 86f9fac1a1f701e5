"""What a run of the SCARA has found by itself, as sections of a report."""

from dataclasses import replace

from catseye.app.results.model import Section
from catseye.app.results.scara.found.alignment import alignment_section
from catseye.app.results.scara.found.error_motion import error_motion_section
from catseye.app.results.scara.found.repeatability import repeatability_section
from catseye.app.results.scara.found.warmup import warmup_section
from catseye.app.results.scara.search_section import search_section
from catseye.app.store.reader import RunReader
from catseye.procedures.scara.aiming import search_result
from catseye.procedures.scara.search.reflector_search import ReflectorSearch


def _search_section(reader: RunReader) -> Section:
    search = search_result(reader) if reader.meta.get("procedure") == ReflectorSearch.name else None
    return replace(search_section([] if search is None else [search]), brief=True)


_FOUND = (alignment_section, _search_section, warmup_section, error_motion_section, repeatability_section)


def scara_sections(reader: RunReader) -> list[Section]:
    """Return what a run has found; none of a run that identifies, or of another arm's."""
    return [one for section_of in _FOUND if (one := section_of(reader)).blocks]
