"""Repeatability of poses along the beams and in the plane, from a run of repeatability."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.figures import Axis, Figure, Line, Mark, Panel, Points
from catseye.app.results.model import Block, Cell, Column, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import counted, fixed, probability_text
from catseye.app.results.scara.figures.arrivals import Seen, arrivals_from_above
from catseye.app.results.scara.identify import aimed_bench
from catseye.app.store.reader import RunReader
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.pointing import beam_direction
from catseye.procedures.kit.expanded import expanded_text
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import integer, number_of, rows_of
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.records import Repeat
from catseye.procedures.scara.repeats.repeatability import Repeatability

_UM = fixed(1)
_BEAM_COLUMNS = (
    Column("pose", "pose"),
    Column("reflector", "beam to"),
    Column("theta1_deg", "θ1", "deg", fixed(2)),
    Column("theta2_deg", "θ2", "deg", fixed(2)),
    Column("s_um", "S", "µm", _UM),
    Column("s_low_um", "95 % from", "µm", _UM),
    Column("s_high_um", "to", "µm", _UM),
    Column("rp_um", "RP", "µm", _UM),
    Column("drift_um", "drift", "µm", fixed(1, signed=True)),
    Column("drift_probability", "p without drift"),
    Column("arrivals", "arrivals"),
)
_PLANE_COLUMNS = (
    Column("pose", "pose"),
    Column("sx_um", "S in x", "µm", _UM),
    Column("sy_um", "S in y", "µm", _UM),
    Column("rp_um", "RP", "µm", _UM),
    Column("u_rp_um", "U of RP", "µm", _UM, standard=True),
    Column("note", "note"),
)


def repeatability_section(reader: RunReader) -> Section:
    """Return the spread of each pose with its interval and the test of drift; nothing of another run."""
    if reader.meta.get("procedure") != Repeatability.name:
        return section("repeatability", "Repeatability", [])
    arrivals = reader.records(Repeat.kind)
    found = reader.result("analyse")
    positions = [] if found is None else rows_of(found, "positions")
    pictures = [_from_above(reader, arrivals, positions), _arrivals_figure(arrivals)] if arrivals else []
    blocks = [*_blocks(found), *pictures]
    return section("repeatability", "Repeatability", blocks, brief=True)


def _blocks(found: Row | None) -> list[Block | None]:
    if found is None:
        text = "The run ended before its cycles were complete: no repeatability is stated."
        return [Statement(Sign.ATTENTION, text)]
    beams, positions = rows_of(found, "beams"), rows_of(found, "positions")
    known = [row for row in beams if "refused" not in row]
    planes = (
        Table("positions", "In the plane, from several beams", _PLANE_COLUMNS, tuple(map(_plane, positions)))
        if positions
        else None
    )
    return [
        _along_verdict(known),
        _plane_verdict(positions),
        Table(
            "beams",
            "Along the beams: S with its 95 % interval, RP = 3 S",
            _BEAM_COLUMNS,
            tuple(map(_beam, beams)),
        ),
        planes,
        _figure(known) if known else None,
    ]


def _along_verdict(known: Sequence[Row]) -> Statement:
    if not known:
        return Statement(
            Sign.BAD, "No pose was attained twice with one dead path: no repeatability is stated."
        )
    worst = max(known, key=lambda row: number_of(row, "s_um"))
    text = (
        f"Along the beams RP is ±{number_of(worst, 'rp_um'):.1f} µm or less: at pose {worst['pose']} S = "
        f"{number_of(worst, 's_um'):.1f} µm towards {worst['reflector']} (95 % "
        f"{number_of(worst, 's_low_um'):.1f} … {number_of(worst, 's_high_um'):.1f} µm, {worst['arrivals']} arrivals)"
    )
    drifting = sum(map(_drifts, known))
    if drifting:
        return Statement(
            Sign.ATTENTION,
            f"{text}. {drifting} of {len(known)} series drift, which their S holds too: warm the arm up first.",
        )
    judged = sum(row["drift_um"] is not None for row in known)
    if not judged:
        return Statement(Sign.NEUTRAL, f"{text}. The drift is not known: measure more cycles.")
    known_so_far = "" if judged == len(known) else f", as far as that is known ({judged} of {len(known)})"
    return Statement(Sign.NEUTRAL, f"{text}. No series drifts{known_so_far}.")


def _drifts(row: Row) -> bool:
    return row["drift_um"] is not None and number_of(row, "drift_probability") < SIGNIFICANCE


def _plane_verdict(positions: Sequence[Row]) -> Statement | None:
    if not positions:
        return None
    known = [row for row in positions if "refused" not in row]
    if not known:
        return Statement(Sign.ATTENTION, "In the plane nothing can be stated: the table says why.")
    worst = max(known, key=lambda row: number_of(row, "rp_um"))
    radius = expanded_text(number_of(worst, "rp_um"), number_of(worst, "u_rp_um"), 1)
    text = f"In the plane RP is {radius} µm (k = 2) or less: at pose {worst['pose']}"
    if left := len(positions) - len(known):
        return Statement(Sign.ATTENTION, f"{text}; {counted(left, 'pose')} without one.")
    return Statement(Sign.NEUTRAL, f"{text}.")


def _beam(row: Row) -> tuple[Cell, ...]:
    place = (
        f"{row['pose']}",
        str(row["reflector"]),
        number_of(row, "theta1_deg"),
        number_of(row, "theta2_deg"),
    )
    if "refused" in row:
        return (*place, None, None, None, None, None, str(row["refused"]), None)
    figures = (number_of(row, key) for key in ("s_um", "s_low_um", "s_high_um", "rp_um"))
    if row["drift_um"] is None:
        return (*place, *figures, None, None, f"{row['arrivals']}")
    drift, p = number_of(row, "drift_um"), number_of(row, "drift_probability")
    return (*place, *figures, drift, probability_text(p), f"{row['arrivals']}")


def _plane(row: Row) -> tuple[Cell, ...]:
    if "refused" in row:
        return (f"{row['pose']}", None, None, None, None, str(row["refused"]))
    figures = (number_of(row, key) for key in ("sx_um", "sy_um", "rp_um", "u_rp_um"))
    return (f"{row['pose']}", *figures, str(row["assumption"]) or None)


def _figure(known: Sequence[Row]) -> Figure:
    names = list(dict.fromkeys(str(row["reflector"]) for row in known))
    marks: list[Mark] = []
    for place, name in enumerate(names):
        own = [row for row in known if row["reflector"] == name]
        # Beside one another, so that their intervals do not cover each other.
        pose = np.array([integer(row["pose"]) for row in own]) + 0.12 * (place - 0.5 * (len(names) - 1))
        s_um, low_um, high_um = (
            np.array([number_of(row, key) for row in own]) for key in ("s_um", "s_low_um", "s_high_um")
        )
        gap = np.full(len(own), np.nan)
        ends = np.stack([low_um, high_um, gap], axis=1).ravel()
        marks += [Line(np.repeat(pose, 3), ends, place), Points(pose, s_um, place, f"to {name}")]
    panel = Panel("S", Axis("pose"), Axis("S / µm", low=0.0), tuple(marks))
    caption = "Standard deviation S of the arrivals along each beam, with its 95 % interval."
    return Figure("repeatability", "Repeatability along the beams", caption, ((panel,),))


def _from_above(reader: RunReader, arrivals: Sequence[Row], positions: Sequence[Row]) -> Figure | None:
    """Return the arrivals in the plane; None of one beam, which sees nothing across."""
    if len({row["reflector"] for row in arrivals}) < 2:
        return None
    bench = aimed_bench(reader, reader.path.parent)
    covariance = {
        integer(row["pose"]): np.array(
            [
                [number_of(row, "sx_um") ** 2, number_of(row, "covariance_xy_um2")],
                [number_of(row, "covariance_xy_um2"), number_of(row, "sy_um") ** 2],
            ]
        )
        for row in positions
        if "refused" not in row
    }
    keys = dict.fromkeys((integer(row["pose"]), str(row["reflector"])) for row in arrivals)
    seen = [
        _seen(bench, [row for row in arrivals if (integer(row["pose"]), row["reflector"]) == key])
        for key in keys
    ]
    return arrivals_from_above(seen, covariance)


def _seen(bench: ScaraBench, own: Sequence[Row]) -> Seen:
    """Return the arrivals at one pose along one beam."""
    first = own[0]
    (reflector,) = bench.chosen((str(first["reflector"]),))
    one, two = (np.deg2rad(number_of(first, key)) for key in ("theta1_deg", "theta2_deg"))
    place = forward(one, two, bench.link1_mm, bench.link2_mm)
    direction = float(beam_direction(place, reflector.xy_mm))
    return Seen(integer(first["pose"]), reflector.name, direction, _from_mean_um(own))


def _from_mean_um(own: Sequence[Row]) -> Floats:
    """Return distances less the mean of their segment, µm: a new zero of the beam has a dead path of its own."""
    segment = np.array([integer(row["segment"]) for row in own])
    from_mean_um = 1e3 * np.array([number_of(row, "displacement_mm") for row in own])
    for each in np.unique(segment):
        from_mean_um[segment == each] -= from_mean_um[segment == each].mean()
    return from_mean_um


def _arrivals_figure(arrivals: Sequence[Row]) -> Figure:
    names = list(dict.fromkeys(str(row["reflector"]) for row in arrivals))
    panels = tuple(
        (_arrivals_panel(name, [row for row in arrivals if row["reflector"] == name]),) for name in names
    )
    caption = (
        "Distance at each arrival less the mean of its pose, by cycle: a series that climbs or falls drifts."
    )
    return Figure("arrivals", "Arrivals, cycle by cycle", caption, panels, aspect=0.3 + 0.2 * len(names))


def _arrivals_panel(name: str, arrivals: Sequence[Row]) -> Panel:
    marks: list[Points] = []
    for pose in sorted({integer(row["pose"]) for row in arrivals}):
        own = [row for row in arrivals if row["pose"] == pose]
        cycle = np.array([float(integer(row["cycle"])) for row in own])
        marks.append(Points(cycle, _from_mean_um(own), pose - 1, f"pose {pose}", joined=True, size=3.0))
    return Panel(f"to {name}", Axis("cycle"), Axis("from its mean / µm"), tuple(marks))
