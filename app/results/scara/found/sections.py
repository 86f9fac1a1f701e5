"""What a run of the SCARA has found by itself, as sections of a report."""

from catseye.app.results.model import Section
from catseye.app.results.scara.found.alignment import alignment_section
from catseye.app.results.scara.found.error_motion import error_motion_section
from catseye.app.results.scara.found.path import path_section
from catseye.app.results.scara.found.repeatability import repeatability_section
from catseye.app.results.scara.found.search import searched_section
from catseye.app.results.scara.found.warmup import warmup_section
from catseye.app.store.reader import RunReader

_FOUND = (
    alignment_section,
    searched_section,
    warmup_section,
    error_motion_section,
    repeatability_section,
    path_section,
)


def scara_sections(reader: RunReader) -> list[Section]:
    """Return what a run has found; none of a run that identifies, or of another arm's."""
    return [one for section_of in _FOUND if (one := section_of(reader)).blocks]
