"""The whole page of a report."""

from pathlib import Path
from typing import Final

from catseye.app.cluster.share import InThisProcess, Share
from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.protocol.banners import SIMULATION, UNVERIFIED
from catseye.app.render.html import picture_html, section_html
from catseye.app.render.labels import Labels
from catseye.app.render.markup import Html, element
from catseye.app.render.palette import GREEN, RED
from catseye.app.results.figures import Figure
from catseye.app.results.model import Origin, Report
from catseye.app.results.numbers import utc_text

_STYLE = Path(__file__).with_name("report.css")
_HERE: Final = InThisProcess()


def require_html(path: Path) -> None:
    """Refuse an output that could not be a report.

    Raises:
        UsageError: the file's name does not end in .html.
    """
    if path.suffix.lower() not in {".html", ".htm"}:
        raise UsageError(f"{path}: a report is an HTML page; write -o {path.with_suffix('.html')}")


def write_page(report: Report, path: Path, share: Share = _HERE) -> None:
    """Write a report as a page.

    Args:
        share: draws the figures, which take a third of a second each.
    """
    write_atomically(path, page_html(report, share))


def page_html(report: Report, share: Share = _HERE) -> str:
    """Return one self-contained page: style and figures inside, no script, nothing loaded.

    Args:
        share: draws the figures.
    """
    head = element(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        element("title", report.title),
        element("style", Html(_style() + _page_margins(report))),
    )
    blocks = [block for part in report.sections for block in part.blocks]
    pictures = iter(share.map(picture_html, [block for block in blocks if isinstance(block, Figure)]))
    labels = Labels(blocks)
    main = element("main", *(section_html(part, pictures, labels) for part in report.sections))
    page = element("html", head, element("body", _heading(report), main), lang="en")
    return f"<!DOCTYPE html>\n{page}\n"


def _style() -> str:
    colours = f":root {{ --good: {GREEN}; --bad: {RED}; }}\n"
    return colours + _STYLE.read_text(encoding="utf-8")


def _page_margins(report: Report) -> str:
    """Return what stands in the margins of each printed page."""
    origin = report.origin
    marks = ((SIMULATION, origin.simulated), (UNVERIFIED, origin.unverified))
    banner = " · ".join(word for word, shown in marks if shown)
    return (
        f"@page {{ @top-left {{ content: {_css_text(banner)}; }} "
        f"@top-right {{ content: {_css_text(report.title)}; }} "
        f"@bottom-left {{ content: {_css_text(_made(origin))}; }} "
        '@bottom-right { content: counter(page) " / " counter(pages); } }\n'
    )


def _css_text(text: str) -> str:
    """Return a string of a style sheet; escaped so that nothing in it can end the string or the sheet."""
    return '"' + "".join(one if one.isalnum() else f"\\{ord(one):x} " for one in text) + '"'


def _made(origin: Origin) -> str:
    return f"{utc_text(origin.created_utc)} · {origin.software}"


def _heading(report: Report) -> Html:
    return element(
        "header",
        *(element("p", text, class_="simulation") for text in report.origin.banners),
        element("h1", report.title),
        element("p", _made(report.origin), class_="made"),
    )
