"""What a report can be traced to: programs, runs, their files with digests, how to check them."""

import hashlib
import platform
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path

from catseye.app.files.documents import LARGEST_RESULT_BYTES, read_document
from catseye.app.results.model import Block, Column, Listing, Paragraph, Section, Table, section
from catseye.app.results.runs.records import RunRecord, Sources


def sources_of(results: Iterable[Path] = ()) -> Sources:
    """Return what this program runs on, and the digests of the result files that a report is made from.

    Raises:
        ConfigError: a file cannot be read.
    """
    packages = {name: version(name) for name in ("numpy", "scipy", "matplotlib")}
    digests = {
        path.name: hashlib.sha256(read_document(path, largest_bytes=LARGEST_RESULT_BYTES)).hexdigest()
        for path in results
    }
    return Sources(
        {"python": platform.python_version(), **packages, "platform": platform.platform()}, digests
    )


def trace_section(
    software: str, sources: Sources, runs: Sequence[RunRecord], result_software: Iterable[str]
) -> Section:
    """Return versions, runs with the digests of their files, and the commands that check them.

    Args:
        software: name and version of the program that made the report.
        sources: what it ran on, and the result files that it was made from.
        result_software: what identified the results; shown where no run is known.
    """
    files = [(run.name, name, digest) for run in runs for name, digest in run.files.items()]
    files += [("result", name, digest) for name, digest in sources.digests.items()]
    others = () if runs else tuple(dict.fromkeys(result_software))
    columns = (Column("of", "of"), Column("file", "file"), Column("sha256", "SHA-256"))
    return section(
        "trace",
        "Traceability",
        [
            _programs(software, sources.versions, runs, others),
            Table("files", "Files with their SHA-256", columns, tuple(files)) if files else None,
            *_checks([run.name for run in runs if run.files]),
        ],
    )


def _checks(names: Sequence[str]) -> list[Block]:
    if not names:
        return []
    return [
        Paragraph(
            "Each command recomputes the digests and compares them, and the run's own record, with what was sealed "
            "at its end; sha256sum gives the same digests."
        ),
        Listing(tuple((f"catseye verify {name}", "") for name in names)),
    ]


def _programs(
    software: str, versions: Mapping[str, str], runs: Sequence[RunRecord], others: Sequence[str]
) -> Table:
    rows = [("this page", software, _listed(versions), "")]
    rows += [(run.name, run.software, _listed(run.versions), run.operator) for run in runs]
    rows += [("identified results", name, "", "") for name in others]
    columns = (
        Column("made", "made"),
        Column("by", "by"),
        Column("with", "with"),
        Column("operator", "operator"),
    )
    return Table("programs", "Programs", columns, tuple(rows))


def _listed(versions: Mapping[str, str]) -> str:
    return ", ".join(f"{name} {version}" for name, version in versions.items())
