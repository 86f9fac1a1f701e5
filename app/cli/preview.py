"""How a file of another program would be read: its mapping on stdout, its rows for whoever looks on."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from catseye.app.cli.output import note, write_document, write_line

if TYPE_CHECKING:
    from catseye.app.results.model import Report
    from catseye.procedures.kit.mapping import TableMapping


def show_preview(
    mapping: "TableMapping", facts: Mapping[str, object], report: "Report", *, as_json: bool
) -> None:
    """Write a mapping to stdout, to be kept in a file, and the rows as they are read with it to stderr.

    Args:
        facts: what JSON says beside the mapping.
    """
    from catseye.app.render.text import report_text
    from catseye.app.results.mapping import mapping_text

    if as_json:
        from catseye.app.cli.documents import MappingPreview

        shown = MappingPreview.model_validate({"mapping": mapping.model_dump(exclude_none=True), **facts})
        write_document("mapping", shown.model_dump(mode="json", exclude_unset=True))
    else:
        write_line(mapping_text(mapping).rstrip())
    note(report_text(report))
