"""The whole page."""

from catseye.app.render.markup import STYLE, Html, element, join, unbroken
from catseye.app.results.runs.sections import (
    configuration_section,
    convention_section,
    incident_section,
    layout_section,
    run_section,
    search_section,
)
from catseye.app.results.runs.trace import trace_section
from catseye.app.results.scara.content import ReportContent
from catseye.app.results.scara.diagnosis_section import diagnosis_section
from catseye.app.results.scara.distance_report import distance_section
from catseye.app.results.scara.result_report import (
    fit_section,
    map_section,
    parameter_section,
    reflector_section,
)
from catseye.app.results.scara.standards_report import standards_section
from catseye.app.results.scara.validation_report import path_section
from catseye.app.results.scara.verdict import Statement, verdict
from catseye.app.results.uncertainty_report import uncertainty_section

_SIGNS = {"good": "✓", "bad": "✗", "note": "•"}


def render_html(content: ReportContent) -> str:
    """Return one self-contained page: style and figures inside, no script, nothing loaded.

    Args:
        content: what to show; parts that are missing are left out.
    """
    head = element(
        "head",
        Html('<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'),
        element("title", content.title),
        element("style", Html(STYLE.read_text(encoding="utf-8") + _page_margins(content))),
    )
    page = element(
        "html", head, element("body", _heading(content), element("main", *_sections(content))), lang="en"
    )
    return f"<!DOCTYPE html>\n{page}\n"


def _page_margins(content: ReportContent) -> str:
    """Return what stands in the margins of each printed page."""
    banners = ["SIMULATION: emulated devices"] if content.simulated else []
    banners += ["UNVERIFIED: changed data"] if content.unverified else []
    banner = " · ".join(banners)
    return (
        f"@page {{ @top-left {{ content: {_css_text(banner)}; }} "
        f"@top-right {{ content: {_css_text(content.title)}; }} "
        f"@bottom-left {{ content: {_css_text(f'{content.created_utc} · {content.software}')}; }} "
        '@bottom-right { content: counter(page) " / " counter(pages); } }\n'
    )


def _css_text(text: str) -> str:
    """Return a string of a style sheet; escaped so that nothing in it can end the string or the sheet."""
    return '"' + "".join(one if one.isalnum() else f"\\{ord(one):x} " for one in text) + '"'


def _heading(content: ReportContent) -> Html:
    banner = (
        element(
            "p", "SIMULATION: emulated devices. Nothing here was measured on a real arm.", class_="simulation"
        )
        if content.simulated
        else ""
    )
    changed = f"UNVERIFIED: made from what was changed after its end. {'; '.join(content.unverified)}."
    unverified = element("p", changed, class_="simulation") if content.unverified else ""
    made = f"{content.created_utc} · {content.software}"
    return element(
        "header", banner, unverified, element("h1", content.title), element("p", made, class_="made")
    )


def _sections(content: ReportContent) -> list[Html]:
    statements = element("ul", *(_statement(one) for one in verdict(content)), class_="verdict")
    note = element("p", "All uncertainties are standard uncertainties (k = 1).", class_="made")
    return [
        element("section", element("h2", "Verdict"), join([statements, note]), id_="verdict"),
        parameter_section(content),
        map_section(content),
        standards_section(content.error_map),
        path_section(content),
        distance_section(content),
        fit_section(content),
        Html() if content.diagnosis is None else diagnosis_section(content.diagnosis),
        uncertainty_section(content.best, content.cell),
        layout_section(content),
        reflector_section(content),
        search_section(content),
        incident_section(content),
        run_section(content),
        convention_section(content),
        configuration_section(content),
        trace_section(content),
    ]


def _statement(statement: Statement) -> Html:
    sign = element("span", _SIGNS[statement.kind], class_="sign")
    return element("li", sign, element("span", unbroken(statement.text)), class_=statement.kind)
