"""What the contributors of a budget do to distances or coordinates: errors of their own, and shared ones."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.budget import (
    Shared,
    White,
    harmonic_of_source,
    harmonics,
    per_angle,
    per_group,
    stacked,
)
from catseye.calibration.core.errors import BudgetError
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.between_nodes import MeasuredPlaces, Places, ripple_between_nodes
from catseye.calibration.scara.budget import Axis, Budget, Contributor
from catseye.calibration.scara.drift_process import courses, octaves
from catseye.calibration.scara.extension import Term, term_values
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Commands, Points
from catseye.calibration.scara.radial import axis_frame


@dataclass(frozen=True)
class Geometry:
    """How rows answer to the arm: distances along beams, or coordinates along the axes of the base.

    Attributes:
        points: where the arm was sent, n rows.
        unit: unit vectors from the reflector to the arm, or of the coordinate, shape (n, 2).
        length_mm: lengths of the beam, shape (n,); zeros for coordinates.
        turn_mm: derivatives of the row by θ1 and θ2, mm/rad, shape (n, 2).
        theta4_rad: angle of the tool against link 2, rad, shape (n,); J4 itself stands at that less the mounting.
        layout: of the arm: nodes, and functions beyond the maps that are identified with it.
        growth_mm: what the rows grow by when both links grow by the same share, mm for a share of 1, shape (n,).
        elapsed: share of the measurement that had passed, less a half, shape (n,).
        later: the rows belong to another time than those that the arm was identified from.
        places: where the joints stand between their nodes in all rows that are estimated from together; None where
            these rows are judged alone.
        alone: what rows of different commands have in common does not matter.
    """

    points: Points
    unit: Floats
    length_mm: Floats
    turn_mm: Floats
    theta4_rad: Floats
    layout: Layout
    growth_mm: Floats
    elapsed: Floats
    later: bool = False
    places: MeasuredPlaces | None = None
    alone: bool = False

    @property
    def j4_rad(self) -> Floats:
        """Angle of J4 itself, rad, shape (n,)."""
        mount = self.points.mount_rad
        return self.theta4_rad if mount is None else self.theta4_rad - mount


def seen_along(
    points: Points, position_mm: Floats, beam: tuple[Floats, Floats], turn_mm: Floats, layout: Layout
) -> Geometry:
    """Return how distances answer to the arm; its J4 axis, at positions of shape (n, 2), carries the beam."""
    commands, (unit, length_mm) = points.commands, beam
    theta4 = np.arctan2(-unit[:, 1], -unit[:, 0]) - commands.theta1_rad - commands.theta2_rad
    growth = np.einsum("ni,ni->n", unit, position_mm)
    return Geometry(points, unit, length_mm, turn_mm, theta4, layout, growth, points.elapsed_share)


def white_mm(contributor: Contributor, geometry: Geometry) -> Floats:
    """Return the standard uncertainty that a white contributor gives each distance, mm, shape (n,)."""
    columns = _columns(contributor, geometry)
    if contributor.kind == "position":
        # Independent in x and y: along any beam it is the same.
        return np.full(len(geometry.points), contributor.u)
    return np.abs(columns[:, 0]) * contributor.u


def combined_white_mm(budget: Budget, geometry: Geometry) -> Floats:
    """Return the standard uncertainty of each distance from all white contributors, mm, shape (n,)."""
    squares = [white_mm(one, geometry) ** 2 for one in budget.white]
    return np.sqrt(np.sum(squares, axis=0)) if squares else np.zeros(len(geometry.points))


def stated_sigma_mm(budget: Budget, geometry: Geometry) -> Floats | None:
    """Return the standard uncertainty that the budget alone gives each distance, mm, shape (n,).

    Returns:
        None where it states no error at all: then the scatter of the fit says how good a distance is.

    Raises:
        BudgetError: it states shared errors only, or leaves some distances without an error of their own.
    """
    if not any(one.u > 0.0 for one in budget.white):
        _require_nothing_shared(budget)
        return None
    sigma = combined_white_mm(budget, geometry)
    if not sigma.all():
        raise BudgetError(
            f"{', '.join(one.name for one in budget.white)}: what differs from reading to reading leaves some "
            "distances without an uncertainty: add a contributor of kind length or position"
        )
    return sigma


def _require_nothing_shared(budget: Budget) -> None:
    shared = [one.name for one in budget.systematic if one.u > 0.0]
    if shared:
        raise BudgetError(
            f"the budget states {', '.join(shared)}, which several distances share, but nothing that differs from "
            'reading to reading: add a contributor with correlation = "reading", as the repeatability of the robot, '
            "or state sigma_mm with the points"
        )


def effects(contributor: Contributor, geometry: Geometry) -> Floats:
    """Return what independent unit-variance sources of a systematic contributor do to the distances.

    What J4 does at its angle is a Fourier series of that angle. Orders that are identified as terms (a J4 map) are
    left out: there the map says what J4 did, and is no longer uncertain by how much J4 might do.

    Returns:
        Effects, mm, shape (n, m); the covariance that they give the distances is E Eᵀ.
    """
    columns = contributor.u * _columns(contributor, geometry)
    match contributor.correlation:
        case "common":
            return columns
        case "pose":
            return per_group(columns, geometry.points.commands.poses())
        case "segment":
            return per_group(columns, geometry.points.dead_path, len(geometry.points.dead_paths))
        case "time":
            return _over_time(contributor, columns, geometry)
        case _ if contributor.kind == "between-nodes":
            shown = math.sqrt(contributor.spectrum[0]) if contributor.spectrum else 1.0
            return shown * columns * _between_nodes(contributor.axis, geometry)
        case _:
            repeated = per_angle(columns, _angle(contributor.axis, geometry), contributor.shares)
            known = _describing(contributor, geometry)
            if not known:
                return repeated
            values = term_values(
                known, {"theta4": geometry.theta4_rad}, len(repeated), geometry.points.mount_rad
            )
            return repeated - values @ described(contributor, known)


def _over_time(contributor: Contributor, columns: Floats, geometry: Geometry) -> Floats:
    sizes = np.sqrt(contributor.shares)
    if geometry.later and contributor.kind == "links":
        # As warm as at any time of the measurement, and all the same throughout.
        return columns * np.linalg.norm(sizes)
    return np.asarray(columns * sizes * courses(geometry.elapsed, contributor.orders), dtype=np.float64)


def _describing(contributor: Contributor, geometry: Geometry) -> tuple[Term, ...]:
    """Return the terms that say what a contributor did: a J4 map, for what its axis does.

    What J4 adds to the length itself has no other side: in another mounting the map does not describe it.
    """
    mount = geometry.points.mount_rad
    turned = mount is not None and bool(mount.any())
    if contributor.axis != "j4" or (contributor.kind == "length" and turned):
        return ()
    return tuple(term for term in geometry.layout.terms if (term.target, term.source) == ("length", "theta4"))


def described(contributor: Contributor, known: tuple[Term, ...]) -> Floats:
    """Return how much of each source of a J4 contributor terms describe, shape (terms, sources).

    They are Fourier coefficients, exact from values around the whole circle.
    """
    values = 4 * (contributor.orders + max(term.order for term in known))
    angle = 2.0 * np.pi * np.arange(values) / values
    # In the first mounting the beam's angle against link 2 is θ4 itself, and the unit vectors point the other way.
    beam = np.ones((values, 1)) if contributor.kind == "length" else -harmonics(angle, 1)
    sources = per_angle(contributor.u * beam, angle, contributor.shares)
    return np.asarray(2.0 / values * term_values(known, {"theta4": angle}, values).T @ sources)


def white_errors(budget: Budget, geometry: Geometry, share: Floats) -> tuple[White, ...]:
    """Return the white contributors as errors of the distances.

    Args:
        share: of each contributor's uncertainty that counts, shape (n,).
    """
    return tuple(
        White(
            one.name,
            share * white_mm(one, geometry),
            one.distribution,
            one.dof,
            one.u if one.kind == "direction" and one.u > 0.0 else None,
        )
        for one in budget.white
    )


def shared_errors(budget: Budget | None, geometry: Geometry) -> tuple[Shared, ...]:
    """Return the systematic contributors as errors that distances have in common."""
    systematic = () if budget is None else budget.systematic
    return tuple(_shared(one, effects(one, geometry)) for one in systematic)


def _shared(contributor: Contributor, effects_mm: Floats) -> Shared:
    part = None
    if contributor.open and effects_mm.shape[1]:
        part = _part_of_source(contributor, effects_mm.shape[1])
    return Shared(
        contributor.name, effects_mm, contributor.distribution, contributor.dof, part, contributor.assumed
    )


def _part_of_source(contributor: Contributor, sources: int) -> Ints:
    if contributor.kind == "between-nodes":
        return np.zeros(sources, np.int64)
    if contributor.correlation == "time":
        return octaves(contributor.orders)
    return harmonic_of_source(sources // (2 * contributor.orders), contributor.orders)


def shared_rms_mm(shared: tuple[Shared, ...]) -> float:
    """Return the root mean square of what all errors in common do to a distance, mm."""
    return math.sqrt(sum(float(np.sum(one.effects_mm**2)) / len(one.effects_mm) for one in shared))


def systematic_effects(budget: Budget | None, geometry: Geometry) -> Floats:
    """Return the effects of all systematic contributors, mm, shape (n, m)."""
    return stacked(shared_errors(budget, geometry), len(geometry.points))


def _columns(contributor: Contributor, geometry: Geometry) -> Floats:
    """Return what a unit of the uncertain quantity does to each distance, shape (n, 1) or (n, 2)."""
    match contributor.kind:
        case "length":
            return np.ones((len(geometry.points), 1))
        case "scale":
            return geometry.points.displacement_mm[:, None]
        case "position":
            return geometry.unit
        case "links":
            return geometry.growth_mm[:, None]
        case "reflector":
            return -geometry.unit
        case "angle" | "between-nodes":
            return geometry.turn_mm[:, [0 if contributor.axis == "j1" else 1]]
        case "direction":
            # A cosine error is of second order: L δ²/2 scatters by L u²/√2.
            return (geometry.length_mm * contributor.u / math.sqrt(2.0))[:, None]
        case "radial":
            commands = geometry.points.commands
            frame = {"j1": 0.0 * commands.theta1_rad, "j2": commands.theta1_rad}
            turned = frame.get(str(contributor.axis), commands.theta1_rad + commands.theta2_rad)
            return axis_frame(geometry.unit, turned)


def _angle(axis: Axis | None, geometry: Geometry) -> Floats:
    commands = geometry.points.commands
    if axis == "j1":
        return commands.theta1_rad
    return commands.theta2_rad if axis == "j2" else geometry.j4_rad


def _between_nodes(axis: Axis | None, geometry: Geometry) -> Floats:
    commands, measured = geometry.points.commands, geometry.places
    if measured is not None and measured.average_out:
        return np.zeros((len(commands), 0))
    first = axis == "j1"
    theta_rad = commands.theta1_rad if first else commands.theta2_rad
    if geometry.alone:
        nodes_rad = geometry.layout.nodes1_rad if first else geometry.layout.nodes2_rad
        return ripple_between_nodes(nodes_rad, theta_rad)[:, None]
    places = (measured or measured_places(geometry.layout, commands)).joints[0 if first else 1]
    return places.effects(theta_rad, commands.direction1 if first else commands.direction2)


def measured_places(layout: Layout, commands: Commands) -> MeasuredPlaces:
    """Return where both joints stand between their nodes.

    Raises:
        MapRangeError: a command lies outside the nodes.
    """
    one = Places.of(layout.nodes1_rad, commands.theta1_rad, commands.direction1)
    return MeasuredPlaces((one, Places.of(layout.nodes2_rad, commands.theta2_rad, commands.direction2)))
