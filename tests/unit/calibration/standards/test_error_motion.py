"""Radial error motion: what readings of indicators show of it, against motions that are put into them."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from catseye.calibration.core.errors import ArgumentError, InsufficientPointsError
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.standards.error_motion import (
    Gauging,
    RunOut,
    eccentricity_of,
    error_motion,
)

ARC = np.deg2rad(np.arange(-140.0, 141.0, 20.0))
TURN = np.deg2rad(np.arange(0.0, 360.0, 15.0))
NONE = Gauging(0.0)

Plane = NDArray[np.complex128]
Motion = Callable[[Floats], Plane]
"""Displacement by the angle, x + i y, µm."""


@dataclass(frozen=True)
class Bench:
    """An artefact that runs about an axis, and what reads it.

    Attributes:
        off_um: place of the artefact's centre, in the turning frame.
        form: of the artefact, by the angle on it, µm.
        hysteresis_um: half of what the two sides differ by, in x.
        scatter_um: of a reading.
        step_um: of a reading.
    """

    motion: Motion
    angles: Floats = field(default_factory=TURN.copy)
    off_um: complex = 15.0 + 7.0j
    form: Motion | None = None
    hysteresis_um: float = 0.0
    scatter_um: float = 0.0
    step_um: float = 0.0
    directions: tuple[float, ...] = (0.0, 0.5 * math.pi)
    cycles: int = 3
    mountings: tuple[bool, ...] = (False,)

    def read(self, seed: int = 0) -> RunOut:
        """Return the readings, place by place as an operator writes them down."""
        rng, rows, zero = np.random.default_rng(seed), [], 0
        for turned in self.mountings:
            off = self.off_um * np.exp(1j * (2.0 if turned else 0.0))
            for cycle in range(self.cycles):
                zero += 1
                zeros = rng.normal(0.0, 30.0, len(self.directions))
                for approach in (1, -1):
                    for angle in self.angles[::approach]:
                        for number, across in enumerate(self.directions):
                            value = self._at(angle, across, approach, off, turned=turned) + zeros[number]
                            value += rng.normal(0.0, self.scatter_um)
                            value = round(value / self.step_um) * self.step_um if self.step_um else value
                            rows.append((angle, across, value, approach, cycle, zero, turned))
        angles, directions, readings, *counts, sides = np.array(rows, dtype=np.float64).T
        approaches, cycles, numbers = (count.astype(np.int64) for count in counts)
        return RunOut(angles, directions, readings, approaches, cycles, numbers, sides > 0.0)

    def _at(self, angle: float, across: float, approach: int, off: complex, *, turned: bool) -> float:
        axis = complex(self.motion(np.array([angle]))[0]) + approach * self.hysteresis_um
        place = (axis + off * np.exp(1j * angle)) * np.exp(-1j * across) * (-1.0 if turned else 1.0)
        form = 0.0 if self.form is None else float(self.form(np.array([across - angle]))[0].real)
        return float(place.real) + form


def oval(angle: Floats) -> Plane:
    """Return 3 µm in the second harmonic along x, 2 µm in the third along y."""
    return np.asarray(3.0 * np.cos(2.0 * angle) + 2.0j * np.sin(3.0 * angle), dtype=np.complex128)


def about_the_circle(motion: Plane, angles: Floats) -> Plane:
    """Return a motion about the least-squares circle, worked out in the complex plane."""
    design = np.stack([np.ones(angles.size), np.exp(1j * angles)], axis=1)
    return np.asarray(motion - design @ np.linalg.lstsq(design, motion, rcond=None)[0], dtype=np.complex128)


def smooth(seed: int) -> Motion:
    """Return harmonics up to the fifth of a size that falls with the order."""
    rng = np.random.default_rng(seed)
    sizes = 2.0 * (rng.standard_normal(11) + 1j * rng.standard_normal(11)) / (1.0 + np.abs(np.arange(-5, 6)))

    def motion(angle: Floats) -> Plane:
        return np.asarray(np.exp(1j * np.outer(angle, np.arange(-5, 6))) @ sizes, dtype=np.complex128)

    return motion


def test_known_harmonics_are_found_as_they_are() -> None:
    found = error_motion(Bench(oval).read(), NONE)
    x, y = found.values
    assert (x.average_um, y.average_um) == pytest.approx((6.0, 4.0))
    assert (x.total_um, y.total_um) == pytest.approx((6.0, 4.0))
    assert (x.asynchronous_um, x.reversal_um) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert found.rms_um == pytest.approx(math.sqrt((3.0**2 + 2.0**2) / 4.0))
    assert found.motion_um[0, 1] == pytest.approx(3.0 * np.cos(2.0 * TURN))
    assert found.eccentricity[0].size_um == pytest.approx(abs(15.0 + 7.0j))


def test_over_an_arc_the_motion_is_about_its_circle() -> None:
    motion = smooth(3)
    found = error_motion(Bench(motion, ARC).read(), NONE)
    wanted = about_the_circle(motion(ARC), ARC)
    assert found.motion_um[0, 0] == pytest.approx(wanted.real)
    assert found.motion_um[1, 0] == pytest.approx(wanted.imag)
    assert found.rms_um == pytest.approx(math.sqrt(np.mean(np.abs(wanted) ** 2) / 2.0))


def test_with_two_directions_an_oval_first_harmonic_is_motion() -> None:
    def first(angle: Floats) -> Plane:
        return np.asarray(4.0 * np.cos(angle) + 0.0j, dtype=np.complex128)

    both = error_motion(Bench(first).read(), NONE)
    # Half of it turns with the joint, as an eccentricity does; the other half turns against it.
    assert both.rms_um == pytest.approx(2.0 / math.sqrt(2.0))
    alone = error_motion(Bench(first, directions=(0.0,)).read(), NONE)
    assert alone.rms_um == pytest.approx(0.0, abs=1e-9)


def test_a_difference_between_the_sides_is_a_reversal() -> None:
    found = error_motion(Bench(oval, hysteresis_um=0.7).read(), NONE)
    assert [each.reversal_um for each in found.values] == pytest.approx([1.4, 0.0], abs=1e-9)
    # The mean of both sides is what a function of the angle is.
    assert found.rms_um == pytest.approx(math.sqrt((3.0**2 + 2.0**2) / 4.0))


def test_form_passes_for_motion_until_the_artefact_is_reversed() -> None:
    def form(angle: Floats) -> Plane:
        return np.asarray(1.5 * np.cos(4.0 * angle) + 0.0j, dtype=np.complex128)

    spoilt = error_motion(Bench(oval, form=form).read(), NONE)
    assert spoilt.rms_um**2 > (3.0**2 + 2.0**2) / 4.0 + 0.5
    found = error_motion(Bench(oval, form=form, mountings=(False, True)).read(), NONE)
    assert found.rms_um == pytest.approx(math.sqrt((3.0**2 + 2.0**2) / 4.0))
    assert found.form_um is not None
    assert found.form_um[0] == pytest.approx(1.5 * np.cos(4.0 * TURN), abs=1e-9)
    assert [each.total_um for each in found.values] == pytest.approx([6.0, 4.0])
    assert len(found.eccentricity) == 2


def test_a_new_zero_within_a_cycle_changes_nothing() -> None:
    read = Bench(oval).read()
    late = read.cycle == 1
    late[: late.argmax() + 20] = False
    moved = replace(
        read,
        reading_um=np.where(late, read.reading_um + 40.0, read.reading_um),
        zero=np.where(late, 9, read.zero),
    )
    assert error_motion(moved, NONE).rms_um == pytest.approx(error_motion(read, NONE).rms_um)


@pytest.mark.parametrize(("scatter_um", "step_um"), [(0.3, 1.0), (1.0, 1.0), (2.0, 0.1), (0.5, 0.0)])
def test_intervals_of_two_u_hold_the_motion(scatter_um: float, step_um: float) -> None:
    inside = []
    for seed in range(150):
        motion = smooth(seed)
        bench = Bench(motion, ARC, scatter_um=scatter_um, step_um=step_um)
        found = error_motion(bench.read(seed), Gauging(step_um))
        true_um = math.sqrt(np.mean(np.abs(about_the_circle(motion(ARC), ARC)) ** 2) / 2.0)
        inside.append(abs(found.rms_um - true_um) <= 2.0 * found.u_rms_um)
    # 95 % within four standard deviations of a share of 150.
    assert np.mean(inside) == pytest.approx(0.954, abs=4.0 * math.sqrt(0.954 * 0.046 / 150.0))


@pytest.mark.parametrize("size_um", [0.0, 2.0, 5.0])
@pytest.mark.parametrize(
    ("scatter_um", "step_um", "cycles", "mountings"),
    [(1.0, 0.0, 3, (False,)), (1.0, 1.0, 2, (False,)), (0.2, 1.0, 3, (False,)), (1.0, 0.0, 2, (False, True))],
)
def test_u_of_the_average_value_covers_the_true_range(
    size_um: float, scatter_um: float, step_um: float, cycles: int, mountings: tuple[bool, ...]
) -> None:
    def motion(angle: Floats) -> Plane:
        return np.asarray(size_um * np.cos(2.0 * angle) + 0.0j, dtype=np.complex128)

    read = Bench(motion, cycles=cycles, mountings=mountings).read()
    true_um = float(np.ptp(size_um * np.cos(2.0 * TURN)))
    inside = []
    for seed in range(200):
        found = error_motion(scattered(read, seed, scatter_um, step_um), Gauging(step_um))
        inside.append(abs(found.values[0].average_um - true_um) <= found.expanded_average_um)
    # 95 % or more, less three standard deviations of a share of 200.
    assert np.mean(inside) >= 0.95 - 3.0 * math.sqrt(0.95 * 0.05 / 200.0)


def test_rms_and_u_bound_a_motion_that_is_not_resolved() -> None:
    def motion(angle: Floats) -> Plane:
        return np.asarray(0.5 * np.cos(2.0 * angle) + 0.0j, dtype=np.complex128)

    read = Bench(motion).read()
    unresolved = [
        found
        for found in (error_motion(scattered(read, seed, 1.0), NONE) for seed in range(200))
        if found.rms_um <= 2.0 * found.u_rms_um
    ]
    assert len(unresolved) > 50
    assert np.mean([found.rms_um + 2.0 * found.u_rms_um >= 0.25 for found in unresolved]) >= 0.95
    # U by itself is no limit: the motion is above it more often than not.
    assert np.mean([2.0 * found.u_rms_um >= 0.25 for found in unresolved]) < 0.7


def test_more_zeros_than_repeats_are_refused() -> None:
    read = Bench(oval, scatter_um=1.0, cycles=2).read()
    # A new zero for every reading leaves no two that can be compared.
    with pytest.raises(InsufficientPointsError, match="zeros"):
        error_motion(replace(read, zero=np.arange(read.angle_rad.size)), NONE)


def test_scatter_alone_is_no_motion() -> None:
    squares = []
    for seed in range(60):
        found = error_motion(
            Bench(lambda angle: np.zeros(angle.size, dtype=np.complex128), scatter_um=1.0).read(seed), NONE
        )
        squares.append(found.rms_um**2)
        assert found.rms_um <= 3.0 * found.u_rms_um
        assert found.scatter_um == pytest.approx(1.0, abs=0.3)
    # Of 6 readings each, their mean scatters by 0.17 µm² if it is not taken out.
    assert np.mean(squares) < 0.03


def test_certificates_count_in_u_and_say_so() -> None:
    read = Bench(oval).read()
    found = error_motion(read, Gauging(0.0, u_indicator_um=0.4, form_um=0.6))
    assert found.u_rms_um == pytest.approx(math.hypot(0.4, 0.3 / math.sqrt(3.0)))
    wanted = 2.0 * math.sqrt(2.0 * 0.4**2 + (0.6 / math.sqrt(3.0)) ** 2)
    assert found.expanded_average_um == pytest.approx(wanted)
    assert found.budget_dof == pytest.approx(0.5 * (found.rms_um / found.u_rms_um) ** 2)
    assert error_motion(read, NONE).budget_dof > 1e6


def test_eccentricity_points_to_the_angle_of_the_largest_reading() -> None:
    angles = np.deg2rad([-120.0, -40.0, 30.0, 100.0])
    off = 25.0 * np.exp(1j * math.radians(-50.0))
    found = eccentricity_of(angles, np.zeros(4), (off * np.exp(1j * angles)).real + 12.0)
    assert (found.size_um, math.degrees(found.nearest_rad)) == pytest.approx((25.0, 50.0))
    assert found.mean_um == pytest.approx((12.0,))


def test_readings_that_show_no_motion_are_refused() -> None:
    read = Bench(oval).read()
    for fewer, text in (
        (read.cycle == 0, "two cycles or more"),
        (read.approach == 1, "either side"),
        (read.angle_rad < TURN[5], "7 places or more"),
        (np.arange(read.angle_rad.size) != 7, "once in every cycle"),
    ):
        with pytest.raises(InsufficientPointsError, match=text):
            error_motion(only(read, np.asarray(fewer)), NONE)
    with pytest.raises(InsufficientPointsError, match="three angles"):
        eccentricity_of(np.zeros(4), np.zeros(4), np.zeros(4))
    with pytest.raises(ArgumentError, match="zero or positive"):
        Gauging(-1.0)


def scattered(read: RunOut, seed: int, scatter_um: float, step_um: float = 0.0) -> RunOut:
    """Return readings that scatter, with the step in which they are read."""
    rng = np.random.default_rng(seed)
    reading_um = read.reading_um + rng.uniform() + rng.normal(0.0, scatter_um, read.reading_um.size)
    return replace(read, reading_um=np.round(reading_um / step_um) * step_um if step_um else reading_um)


def only(read: RunOut, kept: Bools) -> RunOut:
    """Return some of the readings."""
    return RunOut(*(getattr(read, name)[kept] for name in RunOut.__dataclass_fields__))
