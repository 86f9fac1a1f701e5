"""How it was measured: search, incidents, runs, devices, air, configuration."""

import re
from collections.abc import Mapping, Sequence

from catseye.app.cell.bench import unread_keys
from catseye.app.cell.model import Cell as CellFile
from catseye.app.files.flat import flattened
from catseye.app.results.model import (
    Bullets,
    Cell,
    Column,
    Listing,
    Paragraph,
    Quantity,
    Section,
    Table,
    section,
)
from catseye.app.results.numbers import COUNT, DURATION, fixed, utc_text
from catseye.app.results.runs.records import DeviceRecord, EnvironmentSummary, Measurement, RunRecord


def incident_section(warnings: Sequence[str], incidents: Sequence[str]) -> Section:
    """Return what the plan warned of and what happened."""
    parts = (("Known from the plan", warnings), ("Happened on the way", incidents))
    blocks = [Bullets(title, tuple(texts)) for title, texts in parts if texts]
    return section("incidents", "Plan and incidents", blocks)


def run_section(measurement: Measurement, sources: Sequence[str]) -> Section:
    """Return runs, devices and the air.

    Args:
        sources: names of the runs and files from which the results were identified.
    """
    known = {run.name for run in measurement.runs}
    others = [name for name in sources if name not in known]
    air = measurement.environment
    return section(
        "runs",
        "Runs and instruments",
        [
            _runs(measurement.runs) if measurement.runs else None,
            Paragraph(f"Results were identified from: {', '.join(others)}.") if others else None,
            _devices(measurement.devices) if measurement.devices else None,
            None if air is None else _air(air),
            *map(Paragraph, measurement.compensation),
        ],
    )


def _runs(runs: Sequence[RunRecord]) -> Table:
    return Table(
        "runs",
        "Runs",
        (
            Column("name", "run"),
            Column("procedure", "procedure"),
            Column("status", "ended"),
            Column("started_utc", "started"),
            Column("duration_s", "duration", format=DURATION),
            Column("points", "points", format=COUNT),
            Column("healed", "links healed", format=COUNT),
        ),
        tuple(
            (
                run.name,
                run.procedure,
                run.status,
                utc_text(run.started_utc),
                run.duration_s,
                run.points,
                run.healed,
            )
            for run in runs
        ),
    )


def _devices(devices: Sequence[DeviceRecord]) -> Table:
    titles = ("device", "model", "firmware", "serial", "endpoint", "")
    keys = ("name", "model", "firmware", "serial", "endpoint", "simulated")
    return Table(
        "devices",
        "Devices",
        tuple(Column(key, title) for key, title in zip(keys, titles, strict=True)),
        tuple(
            (d.name, d.model, d.firmware, d.serial, d.endpoint, "EMULATED" if d.simulated else "real")
            for d in devices
        ),
    )


def _air(air: EnvironmentSummary) -> Table | None:
    quantities = (
        ("temperature / °C", air.temperature_c, fixed(2)),
        ("pressure / hPa", air.pressure_hpa, fixed(2)),
        ("humidity / %RH", air.humidity_percent, fixed(1)),
    )
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (name, *(Quantity(value, form) for value in (spread.lowest, spread.mean, spread.highest)))
        for name, spread, form in quantities
        if spread is not None
    )
    columns = (
        Column("quantity", "quantity"),
        *(Column(name, name, format=fixed(2)) for name in ("lowest", "mean", "highest")),
    )
    return Table("air", "Air", columns, rows) if rows else None


def configuration_section(cell: CellFile | None, origins: Mapping[str, str]) -> Section:
    """Return the cell file as text."""
    if cell is None:
        return section("configuration", "Configuration", ())
    marked = (
        Paragraph("Values marked “default” do not stand in the cell file, but are read on this bench.")
        if origins
        else None
    )
    listing = Listing(tuple(cell_lines(cell, origins)))
    return section("configuration", "Configuration", [listing, marked])


def cell_lines(cell: CellFile, origins: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return a cell with its values, one a line, as the cell file names them, each with its origin.

    Defaults that nothing on its bench reads are left out.

    Args:
        origins: "file" or "default" by dotted key; what is missing counts as "file".
    """
    values, unread = flattened(cell.model_dump(exclude_none=True)), unread_keys(cell)
    return [
        (f"{key} = {value}" + ("  # default" if origin == "default" else ""), origin)
        for key, value in values.items()
        for origin in [origins.get(key, "file")]
        if origin != "default" or not any(re.match(rf"{re.escape(one)}\b", key) for one in unread)
    ]
