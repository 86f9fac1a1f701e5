"""Sections about how it was measured: layout, search, incidents, runs, devices, air, conventions, configuration."""

from collections.abc import Mapping
from typing import Any

from catseye.app.cell.model import Cell
from catseye.app.render.drawing import figure
from catseye.app.render.markup import Html, bullets, element, join, paragraphs, section, table
from catseye.app.results.numbers import NOTHING, duration_text, fixd
from catseye.app.results.scara.content import EnvironmentSummary, ReportContent, Spread
from catseye.app.results.scara.figures.layout import layout_figure
from catseye.app.results.scara.layout import scene_of


def layout_section(content: ReportContent) -> Html:
    """Return the bench from above."""
    scene = scene_of(content)
    if scene is None:
        return Html()
    caption = "The bench from above, with the arm at one pose and the beam to the first reflector."
    if scene.column_radius_mm is not None:
        caption += " Wedges: field that a reflector looks into. "
        blind = any(len(target.blind_mm) for target in scene.targets)
        caption += (
            "Open symbols: commands that cannot see that reflector." if blind else "No command is blind."
        )
    return section("layout", "Layout", figure(layout_figure(scene), "layout", "Layout of the bench", caption))


def search_section(content: ReportContent) -> Html:
    """Return what the reflector search found."""
    return section("search", "Reflector search", *(_search(found) for found in content.search))


def _search(found: Mapping[str, Any]) -> Html:
    rows = [
        [
            str(place["name"]),
            fixd(place["x_mm"], 2),
            fixd(place["u_x_mm"], 2),
            fixd(place["y_mm"], 2),
            fixd(place["u_y_mm"], 2),
            fixd(place["u_aim_mm"], 2),
        ]
        for place in found["reflectors"]
    ]
    head = ["reflector", "x / mm", "u / mm", "y / mm", "u / mm", "u of the aim / mm"]
    text = (
        f"Beam direction at J4 = 0: θ40 = {fixd(found['theta40_deg'], 4)}° "
        f"(u = {fixd(found['u_theta40_deg'], 4)}°); rms of the sightings {fixd(found['rms_deg'], 4)}°."
    )
    return Html(table("Places found by turning J4 (k = 1)", head, rows) + paragraphs(text))


def incident_section(content: ReportContent) -> Html:
    """Return what the plan warned of and what happened."""
    parts = [
        join([element("h3", title), bullets(texts)])
        for title, texts in (
            ("Known from the plan", content.warnings),
            ("Happened on the way", content.events),
        )
        if texts
    ]
    return section("incidents", "Plan and incidents", *parts)


def run_section(content: ReportContent) -> Html:
    """Return runs, devices and the air."""
    runs = [
        [
            run.name,
            run.procedure,
            run.status,
            run.started_utc,
            NOTHING if run.duration_s is None else duration_text(run.duration_s),
            NOTHING if run.points is None else str(run.points),
        ]
        for run in content.runs
    ]
    devices = [
        [d.name, d.model, d.firmware, d.serial, d.endpoint, "EMULATED" if d.simulated else "real"]
        for d in content.devices
    ]
    sources = sorted({name for result in content.results for name in result.provenance.runs})
    known = {run.name for run in content.runs}
    others = [name for name in sources if name not in known]
    return section(
        "runs",
        "Runs and instruments",
        table("Runs", ["run", "procedure", "ended", "started (UTC)", "duration", "points"], runs, 5)
        if runs
        else "",
        paragraphs(f"Results were identified from: {', '.join(others)}.") if others else "",
        table("Devices", ["device", "model", "firmware", "serial", "endpoint", ""], devices, 6)
        if devices
        else "",
        _air(content.environment),
        paragraphs(*content.compensation),
    )


def _air(air: EnvironmentSummary | None) -> Html:
    if air is None:
        return Html()
    quantities = (
        ("temperature / °C", air.temperature_c, 2),
        ("pressure / hPa", air.pressure_hpa, 2),
        ("humidity / %RH", air.humidity_percent, 1),
    )
    rows = [_spread(name, spread, decimals) for name, spread, decimals in quantities if spread is not None]
    return table("Air", ["quantity", "lowest", "mean", "highest"], rows) if rows else Html()


def _spread(name: str, spread: Spread, decimals: int) -> list[str]:
    return [name, *(fixd(value, decimals) for value in (spread.lowest, spread.mean, spread.highest))]


def convention_section(content: ReportContent) -> Html:
    """Return what the numbers mean."""
    gauges = [f"Gauge of the {result.model} model: {result.gauge}." for result in content.results]
    return section(
        "conventions",
        "Conventions",
        bullets(
            [
                "All uncertainties are standard uncertainties (k = 1).",
                "Angular positioning deviation Δθ: actual minus command angle; 1 mdeg = 0.001°.",
                "Direction of approach: + after real motion upwards, − after real motion downwards.",
                "Reversal error: the map of the negative direction minus that of the positive one.",
                "Maps are piecewise linear between their nodes and never extrapolated.",
                "Origin: J1 axis. Distances cannot see a rotation of everything about J1; the gauge fixes it.",
                *dict.fromkeys(gauges),
            ]
        ),
    )


def configuration_section(content: ReportContent) -> Html:
    """Return the cell file as text."""
    if content.cell is None:
        return Html()
    lines = (
        element("span", line, class_=origin) for line, origin in cell_lines(content.cell, content.origins)
    )
    return section(
        "configuration",
        "Configuration",
        element("pre", Html("\n".join(lines))),
        paragraphs("Values marked “default” do not stand in the cell file." if content.origins else ""),
    )


def cell_lines(cell: Cell, origins: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return a cell with all its values, one a line, as the cell file names them, each with its origin.

    Args:
        cell: the configuration.
        origins: "file" or "default" by dotted key; what is missing counts as "file".
    """
    values = _values(cell.model_dump(exclude_none=True), "")
    return [
        (f"{key} = {value}" + ("  # default" if origin == "default" else ""), origin)
        for key, value in values.items()
        for origin in [origins.get(key, "file")]
    ]


def _values(value: Any, name: str) -> dict[str, Any]:
    """Return every value by its dotted key."""
    if isinstance(value, dict):
        parts = [(f"{name}.{key}" if name else str(key), part) for key, part in value.items()]
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        parts = [(f"{name}[{i}]", part) for i, part in enumerate(value, start=1)]
    else:
        return {name: value}
    return {key: leaf for inner, part in parts for key, leaf in _values(part, inner).items()}
