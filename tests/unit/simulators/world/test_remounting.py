"""The interferometer taken off the flange of J4 and mounted turned: what changes, and what J4 does to its beam."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.simulators.config import EmulationConfig, ErrorBudget, Remounting
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.mount import Mount
from tests.unit.simulators.benches import P2, QUIET, axis_mm, go, quiet_bench

EXACT = replace(QUIET, remounting=Remounting(0.0, 0.0, 0.0, 0.0, 0.0))
RADIAL = replace(EXACT, budget=replace(ErrorBudget.none(), radial_um=(0.0, 0.0, 10.0)))


def sights() -> list[tuple[float, float, float]]:
    """Return J1, J2 and the direction of P2 from there: the beam's angle against link 2 goes once around."""
    found = []
    for one, two in ((0.0, 0.0), (-60.0, 120.0), (60.0, -120.0), (20.0, 60.0), (-20.0, -80.0), (40.0, 90.0)):
        way = complex(P2.x_mm, P2.y_mm) - axis_mm(one, two)
        found.append((one, two, math.degrees(math.atan2(way.imag, way.real))))
    return found


def lengths_mm(bench: Bench, turned_deg: float) -> np.ndarray:
    """Return the true length along each line of sight, J4 brought there with a mount that is turned so far."""
    found = []
    for one, two, world in sights():
        go(bench, (one, two, 0.0, world - one - two - turned_deg))
        assert bench.true_state().reflector == "P2"
        found.append(bench.true_state().length_mm)
    return np.array(found)


def halves(config: EmulationConfig) -> tuple[np.ndarray, np.ndarray]:
    """Return the errors of the lengths, mm, before and after a half turn."""
    nominal = np.array([abs(complex(P2.x_mm, P2.y_mm) - axis_mm(one, two)) for one, two, _ in sights()])
    bench = quiet_bench(config)
    before = lengths_mm(bench, 0.0) - nominal
    bench.beam.remount(180.0)
    return before, lengths_mm(bench, 180.0) - nominal


def orders(seed: int, parity: int) -> np.ndarray:
    """Return what harmonics 1, 3, 5 (parity 1) or 2, 4 (parity 0) of J4's drawn motion do to the lengths, mm.

    From the same seed as the bench, harmonics taken out of the drawn curve by a Fourier transform: the beam sees the
    shift of the axis, in the frame of link 2 at J4's own angle, along its line of sight.
    """
    bench = quiet_bench(replace(RADIAL, seed=seed))
    turn = np.arange(0.0, 360.0, 7.5)
    curve = []
    for four in turn:
        go(bench, (0.0, 0.0, 0.0, float(four)))
        x_mm, y_mm = bench.true_state().axis_mm
        curve.append(complex(x_mm - 550.0, y_mm))
    spectrum = np.fft.fft(np.array(curve)) / turn.size
    number = np.rint(np.fft.fftfreq(turn.size) * turn.size)
    kept = np.where(np.abs(number) % 2 == parity, spectrum, 0.0)
    found = []
    for one, two, world in sights():
        j4 = math.radians(world - one - two)
        shift = np.sum(kept * np.exp(1j * number * j4)) * np.exp(1j * math.radians(one + two))
        found.append(-float((shift * np.exp(-1j * math.radians(world))).real))
    return np.array(found)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_odd_orders_of_j4_change_sign_and_even_ones_stay(seed: int) -> None:
    before, after = halves(replace(RADIAL, seed=seed))
    assert np.abs(before).max() > 0.003
    # The drawn curve is interpolated between 0.5°: of order 5 that leaves 0.1 % of 10 µm; a turned axis sees the
    # reflector from 10 µm aside, which changes the length by less than 1 nm.
    assert (before - after) / 2.0 == pytest.approx(orders(seed, 1), abs=3e-5)
    assert (before + after) / 2.0 == pytest.approx(orders(seed, 0), abs=3e-5)


def test_without_radial_motion_both_mountings_see_the_same() -> None:
    before, after = halves(EXACT)
    assert after == pytest.approx(before, abs=1e-9)


def test_the_beam_is_lost_while_the_interferometer_is_in_hand() -> None:
    bench = quiet_bench(EXACT)
    assert bench.beam.zero()
    bench.beam.remount(180.0)
    assert not bench.beam.read().returns
    bench.beam.remount(0.0)
    reading = bench.beam.read()
    assert (reading.returns, reading.beam_lost) == (True, True)


def test_what_stands_in_the_beam_stands_there_afterwards() -> None:
    bench = quiet_bench(EXACT)
    bench.beam.block(None)
    bench.beam.remount(0.0)
    assert not bench.beam.read().returns
    bench.beam.unblock()
    assert bench.beam.read().returns


def test_a_hand_repeats_a_mounting_as_stated() -> None:
    mounts = [Mount(replace(QUIET, seed=seed), 0.0) for seed in range(600)]
    for mount in mounts:
        mount.remount(180.0)
    # 600 draws: a standard deviation is known to 3 %.
    assert np.std([math.degrees(mount.turn_rad) - 180.0 for mount in mounts]) == pytest.approx(1.0, rel=0.12)
    assert np.std([mount.offset_mm for mount in mounts]) == pytest.approx(0.5, rel=0.12)
    assert np.std([1e3 * mount.pitch_rad for mount in mounts]) == pytest.approx(0.8, rel=0.12)
    assert np.std([mount.height_mm for mount in mounts]) == pytest.approx(0.9, rel=0.12)
    assert np.std([mount.ahead_mm for mount in mounts]) == pytest.approx(0.5, rel=0.12)


def test_the_length_begins_elsewhere_after_a_mounting() -> None:
    bench = quiet_bench(replace(EXACT, remounting=Remounting(0.0, 0.0, 0.0, 0.0, 0.5), seed=4))
    before_mm = bench.true_state().length_mm
    bench.beam.remount(0.0)
    assert bench.true_state().length_mm == pytest.approx(before_mm - bench.beam.mount.ahead_mm)
    assert bench.beam.mount.ahead_mm != 0.0


def test_each_mounting_is_another_one_and_the_screws_act_on() -> None:
    bench = quiet_bench(replace(QUIET, seed=5))
    turns = []
    for asked_deg in (180.0, 0.0, 180.0):
        bench.beam.remount(asked_deg)
        turns.append(math.degrees(bench.beam.mount.turn_rad))
    assert turns == pytest.approx([180.0, 0.0, 180.0], abs=4.0)
    assert len(set(turns)) == 3
    offset_mm = bench.beam.mount.offset_mm
    bench.beam.turn_screw("stage", 2.0)
    # Set to 0.02 turns of 0.5 mm: four standard deviations.
    assert bench.beam.mount.offset_mm == pytest.approx(offset_mm + 1.0, abs=0.04)
