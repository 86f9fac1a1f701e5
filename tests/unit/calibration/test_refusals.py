"""Arguments without a meaning are refused in the house's words: what is wrong, where, and what to do."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from catseye.calibration import (
    Budget,
    Commands,
    Contributor,
    Criterion,
    Points,
    Pool,
    Problem,
    Rules,
    SlicedPoints,
    Term,
    Way,
    compare,
    compensate,
    coverage_factor,
    crosstalk,
    draw_estimates,
    exchange,
    greedy_start,
    identify,
    identify_scan,
    inverse,
    j4_map,
    periodic,
    positioning,
    predict,
    reject,
    robust_fit,
    shortest_interval,
    sight_of,
    symmetric_interval,
    systematic_of_map,
)
from catseye.calibration.air import compensated_mm, refractive_index
from catseye.calibration.core.budget import standard_draws
from catseye.calibration.core.coverage import effective_dof, fewest_draws, numerical_tolerance
from catseye.calibration.core.design.information import Information
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.settling import drift_rate, settling
from catseye.calibration.kinematics.bodies import Box, Capsule, Gaps, Scene, Table
from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.sweep import first_contact
from catseye.calibration.scara.alignment import fit_offset, fit_pitch
from catseye.calibration.scara.design.candidates import Floor, grid
from catseye.calibration.scara.design.refinement import refine
from catseye.calibration.scara.diagnostics.folds import cross_validation
from catseye.calibration.scara.diagnostics.projection import projection_of
from catseye.calibration.scara.error_map import BidirectionalMap
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.live_map import LiveMap
from catseye.calibration.scara.radial import RadialBudget
from catseye.calibration.scara.reflector_search import Sightings, locate_reflectors
from catseye.calibration.standards.circular import circular, least_squares_centre
from catseye.calibration.standards.expansion import Material, at_reference
from catseye.calibration.standards.iso9283 import distance, pose
from catseye.calibration.standards.repeatability import along_beam, in_plane
from tests.unit.calibration.scara.paper import NODES1_DEG, NODES2_DEG, NOMINAL_REFLECTORS
from tests.unit.calibration.scara.samples import identified, noisy_points

NODES = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
LINKS = 325.0, 225.0
NAN = math.nan
NOTHING = np.zeros(0)
INDEX = np.zeros(3, dtype=np.int64)
UP = np.ones(3, dtype=np.int64)
ANGLES = np.array([0.1, 0.2, 0.3])

# What a user's typo makes of an argument is no value of its type: typing has to stand back.
typo: Any = str


@cache
def sample() -> Identification:
    return identified(model="conventional")


def contributor(**changes: Any) -> Contributor:
    given: dict[str, Any] = {"name": "laser", "kind": "length", "u": 1e-3}
    return Contributor(**(given | changes))


def points(**changes: Any) -> Points:
    return replace(noisy_points(), **changes)


def sigma(value: float) -> Points:
    stated = np.full(1056, 0.01)
    stated[2] = value
    return points(sigma_mm=stated)


def identify_with(**changes: Any) -> object:
    given: dict[str, Any] = {
        "points": noisy_points(),
        "model": "error-map",
        "nodes1_rad": NODES[0],
        "nodes2_rad": NODES[1],
        "link1_mm": LINKS[0],
        "link2_mm": LINKS[1],
        "reflectors_mm": NOMINAL_REFLECTORS,
    }
    return identify(**(given | changes))


def scan_with(**changes: Any) -> object:
    return identify_scan(
        SlicedPoints(noisy_points()),
        changes.get("model", "error-map"),
        changes.get("nodes1_rad", NODES[0]),
        NODES[1],
        changes.get("link1_mm", LINKS[0]),
        LINKS[1],
        changes.get("reflectors_mm", NOMINAL_REFLECTORS),
    )


def rules(**changes: Any) -> Rules:
    given: dict[str, Any] = {
        "column_radius_mm": 100.0,
        "field_half_angle_rad": 0.5,
        "beam_range_mm": (10.0, 1000.0),
        "j4_limits_rad": (-6.0, 6.0),
        "theta40_rad": 0.0,
        "keep_out_mm": 100.0,
        "apart_mm": 50.0,
        "fewest_seen": 0.5,
        "most_breaks": 3,
    }
    return Rules(**(given | changes))


def pool(count: int) -> Pool:
    brought = [Information(np.eye(2), np.zeros((2, 0)), np.zeros((0, 0)))] * count
    return Pool.of(brought, np.ones((count, count), dtype=np.bool_), systematic=False)


def live(**changes: Any) -> LiveMap:
    given: dict[str, Any] = {
        "nodes1_rad": NODES[0],
        "nodes2_rad": NODES[1],
        "link1_mm": 325.0,
        "link2_mm": 225.0,
    }
    return LiveMap(**(given | {"reflectors_mm": {"P1": (650.0, -400.0)}, "white_mm": 0.01} | changes))


CRITERION = Criterion("A", 2, np.zeros((0, 2)))
SIGHTINGS = Sightings(ANGLES, ANGLES, ANGLES, INDEX)

CASES: dict[str, tuple[Callable[[], object], str]] = {
    "axis": (
        lambda: contributor(kind="radial", correlation="axis-angle", axis=typo("J1")),
        "laser: axis is 'J1', which is unknown: use one of j1, j2, j4",
    ),
    "kind": (lambda: contributor(kind=typo("lenght")), "laser: kind is 'lenght'.*one of length, scale"),
    "correlation": (lambda: contributor(correlation=typo("pos")), "laser: correlation is 'pos'"),
    "distribution": (lambda: contributor(distribution=typo("gauss")), "laser: distribution is 'gauss'"),
    "negative u": (lambda: contributor(u=-1e-3), "laser: u is -0.001: it has to be zero or positive"),
    "u not a number": (lambda: contributor(u=NAN), "laser: u is nan"),
    "orders": (lambda: contributor(orders=2.5), "laser: orders is 2.5: use a whole number from 1 on"),
    "dof": (lambda: contributor(dof=0.0), "laser: dof is 0: it has to be positive"),
    "name of two contributors": (
        lambda: Budget((contributor(), contributor(name="beam"), contributor(kind="scale"))),
        "the budget has more than one contributor named laser: give each a name of its own",
    ),
    "name of what is identified": (
        lambda: Budget((contributor(name="identified parameters"),)),
        "a contributor is named identified parameters.*give it another name",
    ),
    "name of the instrument": (
        lambda: Budget((contributor(name="instrument"),)),
        "a contributor is named instrument.*give it another name",
    ),
    "radial budget": (lambda: RadialBudget(0.005, -0.005, 0.01), "entry 2 of radial error motions is -0.005"),
    "draws of no distribution": (
        lambda: standard_draws(typo("gauss"), np.random.default_rng(1), 3),
        "distribution is 'gauss'.*normal, uniform",
    ),
    "hand": (
        lambda: inverse(np.array([[300.0, 200.0]]), *LINKS, typo("Right")),
        "hand is 'Right', which is unknown: use one of right, left",
    ),
    "link of the inverse": (lambda: inverse(np.array([[300.0, 200.0]]), -325.0, 225.0), "link1_mm is -325"),
    "direction": (
        lambda: Commands(ANGLES, ANGLES, UP, 5 * UP),
        "entry 1 of direction2 is 5: use 1 for upwards and -1 for downwards",
    ),
    "commands of different lengths": (
        lambda: Commands(ANGLES, ANGLES[:2], UP, UP),
        "theta2_rad: 3 numbers are needed, not 2",
    ),
    "negative sigma": (lambda: sigma(-0.01), "entry 3 of sigma_mm is -0.01: it has to be positive"),
    "sigma not a number": (lambda: sigma(NAN), "entry 3 of sigma_mm is nan"),
    "two mountings of a segment": (
        lambda: points(mount_rad=np.arange(1056) % 2.0),
        "segment 0 of reflector P1 has more than one mount_deg",
    ),
    "mounting not a number": (lambda: points(mount_rad=np.full(1056, NAN)), "mount_rad is nan"),
    "distance not a number": (lambda: points(displacement_mm=np.full(1056, NAN)), "displacement_mm is nan"),
    "reflector out of range": (
        lambda: points(reflector=np.full(1056, 3)),
        "entry 1 of reflector is 3: there are 3, counted from 0",
    ),
    "column of another length": (
        lambda: points(dead_path=INDEX),
        "dead_path: 1056 numbers are needed, not 3",
    ),
    "model": (
        lambda: identify_with(model="errormap"),
        "model is 'errormap', which is unknown: use one of conventional, error-map",
    ),
    "nodes out of order": (
        lambda: identify_with(nodes1_rad=NODES[0][::-1]),
        "nodes1_rad.*increase strictly",
    ),
    "nodes not a number": (lambda: identify_with(nodes2_rad=np.array([0.0, NAN])), "nodes2_rad is nan"),
    "no nodes": (lambda: identify_with(nodes1_rad=NOTHING), "nodes1_rad are empty"),
    "nominal link": (lambda: identify_with(link2_mm=0.0), "link2_mm is 0: it has to be positive"),
    "a rough place is missing": (
        lambda: identify_with(reflectors_mm=NOMINAL_REFLECTORS[:2]),
        "reflectors_mm of P1, P2, P3: 3 × 2 numbers are needed, not 2 × 2",
    ),
    "model of a scan": (lambda: scan_with(model="errormap"), "model is 'errormap'"),
    "nodes of a scan": (lambda: scan_with(nodes1_rad=NODES[0][::-1]), "nodes1_rad.*increase strictly"),
    "link of a scan": (lambda: scan_with(link1_mm=NAN), "link1_mm is nan"),
    "places of a scan": (lambda: scan_with(reflectors_mm=NOMINAL_REFLECTORS[:1]), "3 × 2 numbers are needed"),
    "rows of a block": (lambda: SlicedPoints(noisy_points(), 0), "rows of a block is 0"),
    "nodes of a model without": (
        lambda: Layout("conventional", *NODES, (), ()),
        "nodes1_rad of the conventional model: 0 numbers",
    ),
    "target of a term": (lambda: Term(typo("theta3"), "theta1", "cos"), "target of a term is 'theta3'"),
    "source of a term": (lambda: Term("theta1", typo("time"), "cos"), "source of a term is 'time'"),
    "part of a term": (lambda: Term("theta1", "theta2", typo("tan")), "part of a term is 'tan'"),
    "order of a term": (lambda: crosstalk((-1,)), "order of a term is -1"),
    "order of the J4 map": (lambda: j4_map((2, -3)), "order of a term is -3"),
    "joint": (lambda: periodic(typo("3"), (1,)), "joint is '3', which is unknown: use one of 1, 2"),
    "loss": (lambda: robust_fit(sample(), typo("hubert")), "loss is 'hubert'.*one of huber, soft-l1"),
    "limit": (
        lambda: reject(Problem(noisy_points(), "error-map", *NODES, *LINKS, NOMINAL_REFLECTORS), -4.0),
        "limit is -4: it has to be positive",
    ),
    "share to reject": (
        lambda: reject(Problem(noisy_points(), "error-map", *NODES, *LINKS, NOMINAL_REFLECTORS), 4.0, 5.0),
        "most is 5: it has to lie between 0 and 1",
    ),
    "way of folds": (
        lambda: cross_validation(projection_of(sample()), typo("row")),
        "way to leave something out is 'row'.*reflector, segment, sweep",
    ),
    "draws": (lambda: draw_estimates(sample(), 1, 1), "draws is 1: use a whole number from 2 on"),
    "seed": (lambda: draw_estimates(sample(), 10, -1), "seed is -1"),
    "coverage in percent": (
        lambda: coverage_factor(95, 5),
        "coverage is 95: it has to lie between 0 and 1, as 0.95 for 95 %",
    ),
    "dof of a coverage factor": (lambda: coverage_factor(0.95, NAN), "dof is nan: it has to be positive"),
    "coverage of an interval": (lambda: shortest_interval(np.arange(99.0), 95.0), "coverage is 95"),
    "draws not a number": (lambda: symmetric_interval(np.full(99, NAN), 0.95), "entry 1 of draws is nan"),
    "too few draws": (lambda: symmetric_interval(np.arange(5.0), 0.95), "5 draws hold no interval"),
    "fewest draws": (lambda: fewest_draws(1.0), "coverage is 1"),
    "digits": (lambda: numerical_tolerance(0.1, 0), "digits is 0"),
    "dof of parts": (lambda: effective_dof(np.ones(2), np.array([3.0, -1.0])), "entry 2 of dof is -1"),
    "dof of correlated inputs": (
        lambda: effective_dof(np.ones(2), np.array([4.0, 9.0]), np.full((2, 2), 1.0)),
        "correlated inputs have 4, 9 degrees of freedom",
    ),
    "criterion": (
        lambda: Criterion(typo("a"), 2, np.zeros((0, 2))),
        "criterion is 'a', which is unknown: use one of A, D, E, path",
    ),
    "path of no points": (lambda: Criterion("path", 2, np.zeros((0, 2))), "criterion path needs"),
    "pool of nothing": (lambda: pool(0), "candidates is 0"),
    "start out of the pool": (
        lambda: exchange(pool(2), np.array([0, 2]), CRITERION),
        "entry 2 of start is 2",
    ),
    "start with a place twice": (
        lambda: exchange(pool(2), np.array([1, 1]), CRITERION),
        "candidates of the start",
    ),
    "count of a start": (lambda: greedy_start(pool(2), 0, CRITERION), "count is 0"),
    "keep-out radius": (lambda: rules(keep_out_mm=-1.0), "keep_out_mm is -1"),
    "beam range": (lambda: rules(beam_range_mm=(1000.0, 10.0)), "beam_range_mm goes from 1000 to 10"),
    "field": (lambda: rules(field_half_angle_rad=NAN), "field_half_angle_rad is nan"),
    "sample of a way": (lambda: Way(np.zeros((3, 2)), np.zeros((3, 2)), np.array([3])), "command is 3"),
    "place of a sight": (
        lambda: sight_of(np.array([NAN, 0.0]), Way(np.zeros((3, 2)), np.ones((3, 2)), INDEX), rules()),
        "entry 1 of xy_mm is nan",
    ),
    "floor": (lambda: Floor((100.0, -100.0), (0.0, 1.0)), "x_mm goes from 100 to -100"),
    "places on a floor": (lambda: grid(Floor((0.0, 1.0), (0.0, 1.0)), 0.0, 0), "count is 0"),
    "step of a refinement": (lambda: refine(np.zeros((1, 2)), lambda _: 0.0, 0.0), "step_mm is 0"),
    "positions to compare": (
        lambda: compare(np.zeros((3, 2)), np.zeros((3, 2)), np.zeros((2, 2)), np.ones(3, dtype=np.bool_)),
        "measured_mm: 3 × 2 numbers are needed, not 2 × 2",
    ),
    "measured position not a number": (
        lambda: compare(np.zeros((3, 2)), np.zeros((3, 2)), np.full((3, 2), NAN), np.ones(3, dtype=np.bool_)),
        "measured_mm is nan",
    ),
    "wished positions": (
        lambda: compensate(sample().arm, Commands(ANGLES, ANGLES, UP, UP), np.zeros((2, 2))),
        "wished_mm: 3 × 2 numbers are needed, not 2 × 2",
    ),
    "nominal link of a prediction": (
        lambda: predict(sample().arm, Commands(ANGLES, ANGLES, UP, UP), 325.0, -225.0),
        "link2_mm is -225",
    ),
    "map": (
        lambda: BidirectionalMap(ANGLES, ANGLES, ANGLES[:2]),
        "negative_rad: 3 numbers are needed, not 2",
    ),
    "nodes of a map": (lambda: BidirectionalMap(ANGLES[::-1], ANGLES, ANGLES), "increase strictly"),
    "angle not a number": (
        lambda: BidirectionalMap(ANGLES, ANGLES, ANGLES).deviation(np.array([NAN]), UP[:1]),
        "nan° of row 1 is outside the nodes",
    ),
    "direction of a deviation": (
        lambda: BidirectionalMap(ANGLES, ANGLES, ANGLES).deviation(ANGLES, 0 * UP),
        "entry 1 of direction is 0",
    ),
    "drift of a distance": (lambda: drift_rate(ANGLES, ANGLES[:2]), "length_mm: 3 numbers are needed, not 2"),
    "settling": (lambda: settling(ANGLES, np.full(3, NAN)), "entry 1 of length_mm is nan"),
    "place of a live map": (
        lambda: live(reflectors_mm={"P1": (NAN, 0.0)}),
        "entry 1 of reflectors_mm is nan",
    ),
    "white of a live map": (lambda: live(white_mm=-0.01), "white_mm is -0.01"),
    "link of a live map": (lambda: live(link1_mm=0.0), "link1_mm is 0"),
    "direction of a live row": (lambda: live().add(0.0, 0.0, 0, 1, "P1", 0, 1.0), "direction1 is 0"),
    "sightings": (lambda: Sightings(ANGLES, ANGLES, np.full(3, NAN), INDEX), "j4_rad is nan"),
    "reflector of a sighting": (
        lambda: locate_reflectors(replace(SIGHTINGS, reflector=INDEX + 1), *LINKS, np.zeros((1, 2))),
        "entry 1 of reflector is 1",
    ),
    "offset": (lambda: fit_offset(ANGLES, np.full(3, NAN), INDEX, 0.01), "what was measured is nan"),
    "pitch": (lambda: fit_pitch(ANGLES, ANGLES, -0.01), "its standard uncertainty is -0.01"),
    "formula": (lambda: refractive_index(633.0, 20.0, 1013.0, 50.0, formula=typo("edlin")), "'edlin'"),
    "refractive index": (lambda: compensated_mm(1.0, 0.0, 1.00027, 100.0), "n_now is 0"),
    "positioning": (lambda: positioning(np.zeros((3, 5)), np.zeros((4, 5))), "down: 3 × any numbers"),
    "deviation not a number": (lambda: positioning(np.full((3, 5), NAN), np.zeros((3, 5))), "up is nan"),
    "covariance of a map": (lambda: systematic_of_map(np.zeros(4), np.zeros((3, 3))), "covariance: 4 × 4"),
    "circle": (lambda: circular(np.full(5, NAN), np.zeros(5)), "entry 1 of clockwise is nan"),
    "centre of a circle": (lambda: least_squares_centre(np.zeros((2, 2))), "determine no circle"),
    "material": (lambda: Material(20.0, -0.1, 1e-5, 0.0), "entry 1 of u_temperature_k"),
    "length at 20 °C": (lambda: at_reference(100.0, -1.0, Material(20.0, 0.1, 1e-5, 0.0)), "u_mm is -1"),
    "pose": (lambda: pose(np.zeros((5, 2)), np.zeros(3)), "attained: any × 3 numbers are needed"),
    "attained distance": (lambda: distance(np.array([1.0, NAN]), 1.0), "entry 2 of attained is nan"),
    "arrivals": (lambda: along_beam(ANGLES, INDEX[:2], INDEX), "segment: 3 numbers are needed, not 2"),
    "spread along a beam": (lambda: in_plane(ANGLES, -ANGLES, UP), "entry 1 of s_um is -0.1"),
}


@pytest.mark.parametrize("case", CASES)
def test_arguments_without_meaning_are_refused(case: str) -> None:
    call, text = CASES[case]
    with pytest.raises(CalibrationError, match=text):
        call()


def joint(**changes: Any) -> Joint:
    given: dict[str, Any] = {
        "name": "J1",
        "kind": "revolute",
        "alpha_deg": 0.0,
        "a_mm": 0.0,
        "theta_offset_deg": 0.0,
    }
    return Joint(**(given | {"d_mm": 0.0, "sign": 1.0, "low": -170.0, "high": 170.0} | changes))


SCENE = Scene(Chain((joint(),)), ())

BODIES: dict[str, tuple[Callable[[], object], str]] = {
    "kind": (lambda: joint(kind="rotary"), "joint J1: kind 'rotary' is unknown.*revolute, prismatic"),
    "sign": (lambda: joint(sign=2.0), "joint J1: its sign is 2: use 1 or -1"),
    "range": (lambda: joint(low=1.0, high=NAN), "joint J1: its range"),
    "frame": (lambda: Chain((joint(),)).frame_of("J5"), "frame 'J5' is unknown: use one of base, J1"),
    "radius": (lambda: Capsule("quill", 0, (0.0,) * 3, (1.0,) * 3, -5.0), "body quill: its radius is -5 mm"),
    "end of a body": (
        lambda: Capsule("quill", 0, (0.0, NAN, 0.0), (1.0,) * 3, 5.0),
        "body quill: an end is not",
    ),
    "height of a table": (lambda: Table("table", NAN), "table: its height is not finite"),
    "clearance": (lambda: first_contact(Gaps(SCENE), np.zeros((1, 1)), NAN), "clearance_mm is nan"),
    "target": (
        lambda: first_contact(Gaps(SCENE), np.full((1, 1), NAN), 1.0),
        "a target of the way is not finite",
    ),
    "box": (lambda: Box("door", (0.0,) * 3, (-1.0,) * 3), "box door: its smallest corner"),
}


@pytest.mark.parametrize("case", BODIES)
def test_bodies_without_meaning_are_refused(case: str) -> None:
    call, text = BODIES[case]
    with pytest.raises(KinematicsError, match=text):
        call()


def test_a_budget_of_any_sound_contributor_stands() -> None:
    assert Budget((contributor(u=0.0), contributor(name="beam", dof=math.inf))).white
