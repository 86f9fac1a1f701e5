"""Section about what the page can be traced to: programs, runs, their files with digests, how to check them."""

from collections.abc import Mapping

from catseye.app.render.markup import Html, element, paragraphs, section, table
from catseye.app.results.scara.content import ReportContent, RunRecord


def trace_section(content: ReportContent) -> Html:
    """Return versions, runs with the digests of their files, and the commands that check them."""
    files = [row for run in content.runs for row in _files(run)]
    files += [["result", name, digest] for name, digest in content.digests.items()]
    names = [run.name for run in content.runs if run.files]
    return section(
        "trace",
        "Traceability",
        _versions(content),
        table("Files with their SHA-256", ["of", "file", "SHA-256"], files, 3) if files else "",
        paragraphs(
            "Each command recomputes the digests and compares them, and the run's own record, with what was sealed "
            "at its end; sha256sum gives the same digests."
        )
        if names
        else "",
        element("pre", "\n".join(f"catseye verify {name}" for name in names)) if names else "",
    )


def _versions(content: ReportContent) -> Html:
    rows = [["this page", content.software, _listed(content.versions), ""]]
    rows += [[run.name, run.software, _listed(run.versions), run.operator] for run in content.runs]
    results = dict.fromkeys(result.provenance.software for result in content.results)
    rows += [["identified results", name, "", ""] for name in results if not content.runs]
    return table("Programs", ["made", "by", "with", "operator"], rows, 4)


def _listed(versions: Mapping[str, str]) -> str:
    return ", ".join(f"{name} {version}" for name, version in versions.items())


def _files(run: RunRecord) -> list[list[str]]:
    return [[run.name, name, digest] for name, digest in run.files.items()]
