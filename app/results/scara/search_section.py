"""What reflector searches found, as a section of a report."""

from collections.abc import Mapping, Sequence
from typing import Any

from catseye.app.results.model import Block, Column, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import EXPANDED, counted, fixed, number


def search_section(searches: Sequence[Mapping[str, Any]]) -> Section:
    """Return what reflector searches found.

    Args:
        searches: as their last step returns it: `reflectors` (`name`, `x_mm`, `y_mm`, `u_x_mm`, `u_y_mm`,
            `u_aim_mm`), `theta40_deg`, `u_theta40_deg`, `rms_deg`; `counter_shown`, absent in runs of early versions.
    """
    return section("search", "Reflector search", [block for search in searches for block in _search(search)])


def _search(search: Mapping[str, Any]) -> list[Block]:
    places = search["reflectors"]
    u_mm = max(max(place["u_x_mm"], place["u_y_mm"]) for place in places)
    expanded = f"{number(EXPANDED * u_mm, fixed(2))} mm"
    count = counted(len(places), "reflector")
    verdict = Statement(
        Sign.GOOD,
        f"{count} found by turning J4: U = {expanded} or less (k = 2).",
        f"U ≤ {expanded} (k = 2)",
        f"{count}, U ≤ {expanded}",
    )
    form = fixed(2)
    table = Table(
        "search",
        "Places found by turning J4 (U: k = 2)",
        (
            Column("name", "reflector"),
            Column("x_mm", "x", "mm", form),
            Column("u_x_mm", "U", "mm", form, standard=True),
            Column("y_mm", "y", "mm", form),
            Column("u_y_mm", "U", "mm", form, standard=True),
            Column("u_aim_mm", "U of the aim", "mm", form, standard=True),
        ),
        tuple(
            (
                str(place["name"]),
                *(place[key] for key in ("x_mm", "u_x_mm", "y_mm", "u_y_mm", "u_aim_mm")),
            )
            for place in places
        ),
    )
    theta40, rms = (number(search[key], fixed(4)) for key in ("theta40_deg", "rms_deg"))
    expanded = number(EXPANDED * search["u_theta40_deg"], fixed(4))
    text = (
        f"Beam direction at J4 = 0: θ40 = {theta40}° (U = {expanded}°, k = 2); rms of the sightings {rms}°."
    )
    shown = search.get("counter_shown")
    if shown is not None:
        text += (
            f" The counter has {'' if shown else 'not '}shown its sign and scale on a way with the beam kept."
        )
    return [verdict, Statement(Sign.NEUTRAL, text), table]
