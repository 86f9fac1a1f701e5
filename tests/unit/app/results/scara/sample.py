"""Content for reports: a result made by hand, and a whole measurement made from geometry."""

import math
import tomllib
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.render.page import page_html
from catseye.app.results.model import Origin, Report
from catseye.app.results.provenance import Provenance
from catseye.app.results.runs.records import (
    DeviceRecord,
    EnvironmentSummary,
    Measurement,
    RunRecord,
    Sources,
    Spread,
)
from catseye.app.results.scara.arm_report import arm_report
from catseye.app.results.scara.findings import Findings
from catseye.app.results.scara.result import (
    DeadPath,
    Estimate,
    Fit,
    LackOfFitPart,
    MapTable,
    Nominal,
    Place,
    Residuals,
    Result,
)
from catseye.app.results.scara.result_of import result_of
from catseye.app.results.scara.truth_tables import TruthMap, TruthTables
from catseye.app.results.scara.validation import PathMeasurement, PathValidation, validate_on_path
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.compensation import compensate
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.planar import forward, inverse
from catseye.calibration.scara.points import Commands, Points
from tests.unit.calibration.scara.paper import (
    MDEG,
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    Truth,
    paper_points,
    sequence,
)
from tests.unit.calibration.scara.samples import identified

SEARCH: dict[str, Any] = {
    "reflectors": [
        {"name": "P1", "x_mm": 651.234, "y_mm": -401.567, "u_x_mm": 0.21, "u_y_mm": 0.18, "u_aim_mm": 0.15},
        {"name": "P2", "x_mm": 680.42, "y_mm": 1.77, "u_x_mm": 0.25, "u_y_mm": 0.12, "u_aim_mm": 0.14},
    ],
    "theta40_deg": 0.34217,
    "u_theta40_deg": 0.0112,
    "rms_deg": 0.0087,
}


def cell() -> Cell:
    """Return the cell of the template."""
    return Cell.model_validate(tomllib.loads(TEMPLATE))


def fit(lack: LackOfFitPart | None = None, chi2: tuple[float, float] | None = (1.0213, 0.3)) -> Fit:
    """Return statistics with figures that a test can look for."""
    return Fit(
        n_points=1056,
        n_parameters=48,
        dof=1008,
        rms_um=15.4072,
        sigma0_um=15.7652,
        iterations=4,
        rejected=["segment 2 of reflector P1 dropped: 2 distance(s), fewer than 3"],
        null_directions=[],
        chi2_reduced=None if chi2 is None else chi2[0],
        chi2_probability=None if chi2 is None else chi2[1],
        variance_ratio=1.0 if lack is None else 6.25,
        lack_of_fit=lack,
    )


LACK = LackOfFitPart(
    systematic_um=21.34,
    pure_um=9.87,
    ratio=17.82,
    probability=1e-9,
    significant=True,
    explained=False,
)
"""A model that misses its repeats, with nothing stated to account for it."""


def table(shift_mdeg: float = 0.0) -> MapTable:
    """Return a map with three nodes."""
    return MapTable(
        node_deg=[-20.0, 0.0, 20.0],
        positive_mdeg=[-11.234 + shift_mdeg, 3.456 + shift_mdeg, 7.778 + shift_mdeg],
        negative_mdeg=[-21.111, -6.543, -2.222],
        u_positive_mdeg=[0.61, 0.62, 0.63],
        u_negative_mdeg=[0.64, 0.65, 0.66],
    )


def hand_made(name: str = "P1", the_fit: Fit | None = None) -> Result:
    """Return an error map whose every number is known."""
    return Result(
        model="error-map",
        gauge="mean of theta1 map = 0",
        link1_mm=Estimate(value=324.964123, u=0.00234),
        link2_mm=Estimate(value=224.998456, u=0.00219),
        theta1_map=table(),
        theta2_map=table(1.0),
        reflectors=[
            Place(name=name, x_mm=Estimate(value=651.23456, u=0.0123), y_mm=Estimate(value=-401.5, u=0.0234))
        ],
        dead_paths=[DeadPath(reflector=name, segment=0, length_mm=Estimate(value=812.3456, u=0.0171))],
        fit=the_fit or fit(),
        nominal=Nominal(link1_mm=325.0, link2_mm=225.0),
        residuals=Residuals(
            reflector=[name] * 8,
            segment=[0] * 8,
            theta1_deg=[-20.0, -20.0, 0.0, 0.0, 20.0, 20.0, 20.0, -20.0],
            theta2_deg=[-20.0, -20.0, 0.0, 0.0, 20.0, 20.0, 0.0, 20.0],
            direction1=[1, -1] * 4,
            direction2=[1, 1, -1, -1] * 2,
            residual_um=[12.0, -9.0, 3.0, -15.0, 20.0, -4.0, 1.0, -7.0],
        ),
        provenance=Provenance(runs=["points.csv"], software="catseye 0.1.0", created="2026-01-02T03:04:05Z"),
    )


def smooth_truth() -> Truth:
    """Return a belt-driven arm: a slow wave in each joint, a nearly constant reversal error."""
    one, two = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    first = MDEG * (14.0 * np.sin(1.4 * one + 0.6) + 6.0 * np.cos(4.1 * one))
    second = MDEG * (-6.0 + 11.0 * np.sin(1.8 * two + 0.2) + 4.0 * np.cos(5.0 * two))
    first -= first.mean()
    return Truth(
        324.964,
        224.998,
        {1: (first + 4.5 * MDEG).tolist(), -1: (first - 4.5 * MDEG).tolist()},
        {1: (second + 6.0 * MDEG).tolist(), -1: (second - 6.0 * MDEG).tolist()},
        NOMINAL_REFLECTORS + np.array([[1.2, -1.6], [0.4, 1.8], [-0.9, 0.7]]),
    )


@cache
def measurement(systematic_um: float = 0.0) -> tuple[Points, tuple[Identification, Identification]]:
    """Return the paper's distances with white noise and, if wanted, an error that repeats at every pose."""
    rng = np.random.default_rng(11)
    rows = np.array(sequence() * 3)
    wave = np.sin(0.9 * rows[:, 0] * rows[:, 1] + np.repeat([0.0, 1.0, 2.0], len(rows) // 3))
    noise_mm = rng.normal(0.0, 0.0156, len(rows)) + 1e-3 * systematic_um * wave
    points = paper_points(smooth_truth(), noise_mm=noise_mm, sigma_mm=0.0156)
    return points, (identified(points, "conventional"), identified(points))


def results(systematic_um: float = 0.0) -> list[Result]:
    """Return both models as results."""
    _, models = measurement(systematic_um)
    runs = ["20260102T030405Z_open-loop_ab12cd"]
    return [result_of(one, (325.0, 225.0), runs, "catseye 0.1.0", "2026-01-02T03:04:05Z") for one in models]


def truth_tables() -> TruthTables:
    """Return the truth behind the measurement."""
    truth = smooth_truth()

    def tables(nodes_deg: list[float], both: dict[int, list[float]]) -> TruthMap:
        return TruthMap(nodes_deg, [v / MDEG for v in both[1]], [v / MDEG for v in both[-1]])

    places = {f"P{i + 1}": (float(x), float(y)) for i, (x, y) in enumerate(truth.reflectors)}
    return TruthTables(
        truth.link1_mm, truth.link2_mm, tables(NODES1_DEG, truth.map1), tables(NODES2_DEG, truth.map2), places
    )


def path(along: str = "y") -> PathMeasurement:
    """Return the paper's path (X = 200 mm), or one along X, or a diagonal, in the frame of a tracker."""
    way = np.concatenate([np.linspace(-500.0, 500.0, 41), np.linspace(500.0, -500.0, 41)])
    if along == "y":
        xy = np.column_stack([np.full(way.size, 200.0), way])
    elif along == "x":
        xy = np.column_stack([250.0 + 0.2 * way, np.full(way.size, -250.0)])
    else:
        xy = np.column_stack([250.0 + 0.2 * way, -250.0 + 0.2 * way])
    theta1, theta2 = inverse(xy, 325.0, 225.0)
    direction = [np.append(np.sign(np.diff(t))[:1], np.sign(np.diff(t))) for t in (theta1, theta2)]
    states = [np.where(d == 0, 1, d).astype(np.int64) for d in direction]
    commands = Commands(theta1, theta2, *states)
    noise = np.random.default_rng(3).normal(0.0, 0.012, xy.shape)
    travel = np.where(np.arange(way.size) < way.size // 2, 1, -1)
    seen, u_mm = _seen(commands) + noise, np.full(way.size, 0.0085)
    return PathMeasurement(commands, xy, travel, seen, u_mm, np.ones(way.size, dtype=np.bool_))


def corrected_path() -> PathMeasurement:
    """Return a path along X that was driven with commands which the error map corrects."""
    wished = path("x")
    arm = measurement()[1][1].arm
    commands = compensate(arm, wished.commands, wished.command_mm).commands
    noise = np.random.default_rng(4).normal(0.0, 0.012, wished.command_mm.shape)
    return replace(wished, commands=commands, measured_mm=_seen(commands) + noise)


def _seen(commands: Commands) -> Floats:
    truth = smooth_truth()
    deviations = []
    for theta, state, nodes, both in (
        (commands.theta1_rad, commands.direction1, NODES1_DEG, truth.map1),
        (commands.theta2_rad, commands.direction2, NODES2_DEG, truth.map2),
    ):
        up, down = (np.interp(np.rad2deg(theta), nodes, both[s]) for s in (1, -1))
        deviations.append(np.where(state > 0, up, down))
    arm = forward(
        commands.theta1_rad + deviations[0],
        commands.theta2_rad + deviations[1],
        truth.link1_mm,
        truth.link2_mm,
    )
    turn = math.radians(0.031)
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    return np.asarray(arm @ rotation.T + np.array([0.42, -0.17]))


def validation(along: str = "y") -> PathValidation:
    """Return both models on a path."""
    return validate_on_path(path(along), [one.arm for one in measurement()[1]], (325.0, 225.0))


@dataclass(frozen=True)
class Sheet:
    """What a page shows."""

    title: str
    origin: Origin
    findings: Findings
    measurement: Measurement = field(default_factory=Measurement)
    sources: Sources = field(default_factory=Sources)

    def found(self, **changes: Any) -> "Sheet":
        """Return a page with other findings."""
        return replace(self, findings=replace(self.findings, **changes))

    def measured(self, **changes: Any) -> "Sheet":
        """Return a page of another measurement."""
        return replace(self, measurement=replace(self.measurement, **changes))

    @property
    def report(self) -> Report:
        """The report."""
        return arm_report(self.title, self.origin, self.findings, self.measurement, self.sources)


MADE = Origin("catseye 0.1.0", "2026-01-02T03:04:05Z")


def whole(systematic_um: float = 0.0) -> Sheet:
    """Return a report with every part."""
    the_cell = cell()
    measurement = Measurement(
        cell=the_cell,
        searches=[SEARCH],
        warnings=["reflector P1: 12 commands are blind and left out, the first at θ1 = 60°, θ2 = 140°"],
        incidents=["03:12:44 beam lost at θ1 = −20°, θ2 = 40°; a new segment began"],
        devices=[
            DeviceRecord("robot", "RH-3FRH5515", "S7", "EMULATOR-1", "tcp://127.0.0.1:10001", True),
            DeviceRecord(
                "interferometer", "LINE-COUNTER", "1.0", "EMULATOR-2", "tcp://127.0.0.1:10002", True
            ),
        ],
        environment=EnvironmentSummary(
            Spread(20.11, 20.23, 20.41), Spread(1012.9, 1013.2, 1013.6), Spread(43.1, 44.0, 45.2)
        ),
        runs=[
            RunRecord(
                "20260102T020000Z_reflector-search_0a1b2c",
                "reflector-search",
                "complete",
                "2026-01-02T02:00:00Z",
                183.0,
                21,
            ),
            RunRecord(
                "20260102T030405Z_open-loop_ab12cd",
                "open-loop",
                "complete",
                "2026-01-02T03:04:05Z",
                5025.0,
                1056,
            ),
        ],
    )
    return Sheet(
        "Open-loop measurement lab-1",
        replace(MADE, simulated=True),
        Findings(results(systematic_um), scara_bench_of(the_cell), truth_tables(), validation()),
        measurement,
    )


def bare(result: Result) -> Sheet:
    """Return a report of a result file alone."""
    return Sheet("Result", MADE, Findings([result]))


def page(sheet: Sheet) -> str:
    """Return the page of a report."""
    return page_html(sheet.report)


@cache
def whole_page() -> str:
    """Return the page of a report with every part."""
    return page(whole())


@cache
def bare_page() -> str:
    """Return the page of a report of the result made by hand alone."""
    return page(bare(hand_made()))
