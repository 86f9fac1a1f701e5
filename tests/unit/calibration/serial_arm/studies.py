"""Figures of the identification over many emulated calibrations, for the campaign and the suite's short form."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.base_drift import find_drift
from catseye.calibration.serial_arm.choice import choose
from catseye.calibration.serial_arm.design.candidates import Rules, draw_candidates
from catseye.calibration.serial_arm.design.exchange import select
from catseye.calibration.serial_arm.design.pose_rows import pose_rows
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import Calibration, ModelName, identify_arm
from catseye.calibration.serial_arm.measurements import MeasuredPoints, Measurements
from tests.unit.calibration.serial_arm.nominal import NOISE_MM, irb120, validation
from tests.unit.calibration.serial_arm.true_arm import (
    BASE,
    COMPLIANCE,
    FOUND,
    HIGH,
    LOW,
    NESTS,
    NOMINAL,
    TrueArm,
    random_poses,
)

COUNT = 38
DISTURBED_POSES = 100


@dataclass(frozen=True)
class Accuracy:
    """Draws of one way to choose poses.

    Attributes:
        mean_mm: of the errors at 1000 poses, shape (draws,).
        max_mm: shape (draws,).
        z: rms of errors over their standard uncertainties, shape (draws,).
    """

    mean_mm: Floats
    max_mm: Floats
    z: Floats


@dataclass(frozen=True)
class Disturbed:
    """Sets with read-back joints that are off, wrong poses, and a base that drifts.

    Attributes:
        clean_mm: mean error at unseen poses from the undisturbed set, shape (sets,).
        disturbed_mm: the same from the disturbed one.
        wrong: wrong poses, and how many were named.
        good: good poses of the disturbed sets, and how many were named.
        commanded: sets whose commanded joints were taken.
    """

    clean_mm: Floats
    disturbed_mm: Floats
    wrong: tuple[int, int]
    good: tuple[int, int]
    commanded: int


@dataclass(frozen=True)
class Plant:
    """An arm whose model is to be found.

    Attributes:
        right: the model that it is made of.
        taken: the model that cross-validation took.
        ratio: error at unseen poses over that of the right model.
    """

    right: ModelName
    taken: ModelName
    ratio: float


def chosen_poses(candidates: int = 5000, starts: int = 3) -> tuple[Floats, Ints]:
    """Return 38 poses, and the nest of each, chosen by exchange within the ranges of the paper."""
    found = draw_candidates(irb120(), Rules(low=LOW, high=HIGH), candidates, 1)
    rows = pose_rows(irb120(), found.joints, found.targets, "geometric+compliance").rows
    chosen = select(rows, COUNT, "O1", starts).chosen
    return found.joints[chosen], found.targets[chosen, 0]


def measured_at(poses: Floats, nest: Ints, seed: int, true: TrueArm | None = None) -> Measurements:
    """Measure one nest a pose with the noise of the paper."""
    places = (true or TrueArm()).nests(poses, nest)
    places = places + NOISE_MM * np.random.default_rng([seed, 7]).standard_normal(places.shape)
    points = MeasuredPoints(np.arange(len(nest)), nest, places, _white(len(nest)))
    return Measurements(Commands.of(irb120(), poses), _names(len(nest)), points)


def accuracy(choice: "tuple[Floats, Ints] | None", draws: int) -> Accuracy:
    """Identify from noisy places; without a choice every draw has random poses of its own."""
    unseen, places = validation(1000)
    at = Commands.of(irb120(), unseen)
    found = []
    for seed in range(draws):
        poses, nest = choice or (random_poses(COUNT, 500 + seed), np.arange(COUNT) % len(NESTS))
        one = identify_arm(irb120(), measured_at(poses, nest, seed), "geometric+compliance")
        missed = one.places_mm(at, 0) - places
        size = np.linalg.norm(missed, axis=1)
        square = np.einsum(
            "ni,ni->n",
            missed,
            np.linalg.solve(one.covariance_of_places(at, 0), missed[:, :, None])[:, :, 0],
        )
        found.append((size.mean(), size.max(), np.sqrt(square.mean() / 3.0)))
    mean, largest, z = np.array(found).T
    return Accuracy(mean, largest, z)


def lacks_of_fit(choice: tuple[Floats, Ints], draws: int, name: ModelName) -> float:
    """Return the share of draws in which a model without, or with, compliance is said not to fit."""
    found = [
        identify_arm(irb120(), measured_at(*choice, seed), name).estimate.fit.chi2_probability
        for seed in range(draws)
    ]
    return float(np.mean([one is not None and one < SIGNIFICANCE for one in found]))


def disturbed(sets: int, first: int = 0) -> Disturbed:
    """Calibrate with three nests at 100 poses, clean and disturbed."""
    clean, bad, commanded = [], [], 0
    wrong, good = [0, 0], [0, 0]
    for seed in range(first, first + sets):
        rng = np.random.default_rng([seed, 11])
        poses = random_poses(DISTURBED_POSES, seed)
        signs = rng.choice([-1.0, 1.0], poses.shape)
        read = poses + signs * rng.uniform(0.02, 0.05, poses.shape)
        moved, spoiled = _moved(rng)
        clean.append(_unseen_mm(choose(irb120(), _of_all_nests(poses, seed)).calibration))
        found = choose(irb120(), _of_all_nests(poses, seed, moved), read)
        bad.append(_unseen_mm(found.calibration))
        commanded += found.joints == "commanded"
        named = {one.pose for one in found.rejected}
        wrong = [wrong[0] + len(spoiled), wrong[1] + len(named & spoiled)]
        good = [good[0] + DISTURBED_POSES - len(spoiled), good[1] + len(named - spoiled)]
    return Disturbed(np.array(clean), np.array(bad), (wrong[0], wrong[1]), (good[0], good[1]), commanded)


def plants(count: int, first: int = 0) -> list[Plant]:
    """Let cross-validation choose the model of rigid and elastic arms, and of arms whose joints err periodically."""
    found = []
    kinds: tuple[ModelName, ...] = ("geometric", "geometric+compliance", "maps")
    for seed in range(first, first + count):
        right, rng = kinds[seed % 3], np.random.default_rng([seed, 13])
        true = TrueArm(
            NOMINAL + (FOUND - NOMINAL) * rng.uniform(0.3, 1.7, NOMINAL.shape),
            0.0 * COMPLIANCE if right == "geometric" else COMPLIANCE * rng.uniform(0.5, 1.5, 6),
            BASE,
            rng.uniform(0.01, 0.05, 6) if right == "maps" else np.zeros(6),
        )
        poses = random_poses(80, seed)
        rows = measured_at(poses, np.arange(80) % len(NESTS), seed, true)
        taken = choose(irb120(), rows).calibration
        wanted = choose(irb120(), rows, name=right).calibration
        ratio = _unseen_mm(taken, true) / _unseen_mm(wanted, true)
        found.append(Plant(right, taken.name, ratio))
    return found


def drifts(sets: int, name: ModelName, size_mm: float = 0.0, first: int = 0) -> int:
    """Return in how many sets of 45 poses a drift of the base is reported, of points that are known unevenly.

    Args:
        size_mm: by which the base moves along a line from the first pose to the last.
    """
    return sum(
        find_drift(identify_arm(irb120(), _known_unevenly(seed, size_mm), name)) is not None
        for seed in range(first, first + sets)
    )


def _known_unevenly(seed: int, drift_mm: float) -> Measurements:
    """Measure a nest a pose, each place with a covariance of its own: of 8, 30 and 60 µm or so, along any axes."""
    poses, rng = random_poses(45, seed), np.random.default_rng([seed, 17])
    axes = np.linalg.qr(rng.standard_normal((45, 3, 3)))[0]
    u_mm = np.array([0.008, 0.03, 0.06]) * rng.uniform(0.7, 1.4, (45, 3))
    off = np.einsum("nij,nj->ni", axes, u_mm * rng.standard_normal((45, 3)))
    along = rng.standard_normal(3)
    off += np.linspace(-0.5, 0.5, 45)[:, None] * (drift_mm * along / np.linalg.norm(along))
    one = measured_at(poses, np.arange(45) % len(NESTS), seed)
    places = TrueArm().nests(poses, one.points.target) + off
    covariance = np.einsum("nij,nj,nkj->nik", axes, u_mm**2, axes)
    return replace(one, points=replace(one.points, place_mm=places, covariance_mm2=covariance))


def _moved(rng: np.random.Generator) -> tuple[Floats, set[int]]:
    """Return by what each pose's places are off: a drift of 0.1 mm, and half a millimetre or more at three poses."""
    along = rng.standard_normal(3)
    drift = np.linspace(-0.5, 0.5, DISTURBED_POSES)[:, None] * (0.1 * along / np.linalg.norm(along))
    spoiled = rng.choice(DISTURBED_POSES, 3, replace=False)
    for pose in spoiled:
        aside = rng.standard_normal(3)
        drift[pose] += aside / np.linalg.norm(aside) * rng.uniform(0.5, 3.0)
    return drift, set(spoiled.tolist())


def _of_all_nests(poses: Floats, seed: int, moved_mm: Floats | None = None) -> Measurements:
    nest, pose = np.tile(np.arange(3), len(poses)), np.repeat(np.arange(len(poses)), 3)
    one = measured_at(poses[pose], nest, seed)
    places = one.points.place_mm + (0.0 if moved_mm is None else moved_mm[pose])
    points = replace(one.points, pose=pose, place_mm=places)
    return Measurements(Commands.of(irb120(), poses), _names(len(poses)), points)


def _unseen_mm(found: Calibration, true: TrueArm | None = None) -> float:
    poses = random_poses(500, 9000)
    places = (true or TrueArm()).nests(poses, np.zeros(500, dtype=np.int64))
    missed = found.places_mm(Commands.of(irb120(), poses), 0) - places
    return float(np.linalg.norm(missed, axis=1).mean())


def _white(rows: int) -> Floats:
    return np.tile(NOISE_MM**2 * np.eye(3), (rows, 1, 1))


def _names(count: int) -> tuple[str, ...]:
    return tuple(f"pose {k + 1}" for k in range(count))
