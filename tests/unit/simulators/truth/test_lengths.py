"""Interferometers count what their light meets: no reading is a true length."""

import json
from collections.abc import Callable

import numpy as np
import pytest

from catseye.simulators.context import EmulationContext
from catseye.simulators.ports.session import Session
from tests.unit.simulators.benches import aimed, go
from tests.unit.simulators.truth.worlds import BUDGET, assert_unsure, heard, said, session_of, world

UM = 1e3
SEEDS = range(14)
SPACE = "com.attocube.ids."


def ask(context: EmulationContext, session: Session, method: str, *params: object) -> list[float]:
    request = json.dumps({"method": method, "id": 1, "params": params}).encode()
    found: list[float] = json.loads(said(context, session, request))["result"]
    return found


class Reader:
    """Zeroes an instrument and reads it, mm, by its own protocol."""

    def __init__(self, context: EmulationContext, protocol: str, **options: str | bool | float) -> None:
        self.context = context
        # A slow display, so that a motion is no long stream.
        options |= {"rate_hz": 100.0} if protocol == "umd" else {}
        self.session = session_of(context, protocol, protocol, **options)
        calls: dict[str, tuple[Callable[[], object], Callable[[], float]]] = {
            "line-counter": (lambda: self.say(b"Z\r"), self.line),
            "heidenhain-nd": (lambda: self.say(b"\x1bT0000\r\x1bT0104\r"), self.display),
            "lasertex-hpi": (lambda: self.say(bytes.fromhex("AAB0480000000062")), self.distance),
            "attocube-ids": (self.start, self.displacement),
            "umd": (lambda: None, self.sample),
        }
        self.zero, self.read = calls[protocol]

    def say(self, data: bytes) -> bytes:
        return said(self.context, self.session, data)

    def line(self) -> float:
        return float(self.say(b"R\r").split()[0])

    def display(self) -> float:
        return float(self.say(b"\x1bA0100\r").strip(b"\x02\r\n"))

    def distance(self) -> float:
        self.say(bytes.fromhex("AAB032000000008E"))
        frame = heard(self.context, self.session, 0.05)[:16]
        return 1e-7 * int.from_bytes(frame[3:10], "big", signed=True)

    def start(self) -> None:
        ask(self.context, self.session, SPACE + "system.startMeasurement")
        self.context.bench.advance(5.0)

    def displacement(self) -> float:
        return 1e-9 * ask(self.context, self.session, SPACE + "displacement.getAxisDisplacement", 0)[1]

    def sample(self) -> float:
        _, _, whole, _, phase, *_ = heard(self.context, self.session, 0.011).splitlines()[-1].split()
        return (int(whole) + int(phase) / 256.0) * 632.9908e-6 / 2.0


STEP_UM = {"heidenhain-nd": 0.1}
PROTOCOLS = ("line-counter", "heidenhain-nd", "lasertex-hpi", "attocube-ids", "umd")


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_readings_at_rest_scatter_as_a_counter_does(protocol: str) -> None:
    reader = Reader(world(), protocol)
    reader.zero()
    values = np.array([reader.read() for _ in range(40)])
    spread_um = UM * float(values.std(ddof=1))
    most = float(np.hypot(1.5 * BUDGET.counter_noise_um, STEP_UM.get(protocol, 0.0) / 3.0))
    assert 0.6 * BUDGET.counter_noise_um < spread_um < most + BUDGET.environment_um


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_displacement_in_vacuum_wavelengths_is_not_the_true_one(protocol: str) -> None:
    off_ppm = []
    for seed in range(5):
        context = world(seed)
        options: dict[str, str | bool | float] = {"compensated": "none"} if protocol == "line-counter" else {}
        reader = Reader(context, protocol, **options)
        reader.zero()
        before, first_mm = reader.read(), context.beam_bench.true_state().length_mm
        go(context.beam_bench, aimed(22.0, 33.0))
        context.bench.advance(5.0)
        assert context.beam_bench.true_state().reflector == "P2"
        way_mm = context.beam_bench.true_state().length_mm - first_mm
        off_ppm.append(1e6 * (abs((reader.read() - before) / way_mm) - 1.0))
    # The air's index is 1.00027; the rest is noise of a way of some millimetres.
    assert 150.0 < float(np.median(off_ppm)) < 400.0
    assert float(np.std(off_ppm)) > 1.0


def started(seed: int, times: int = 1, **options: str | bool) -> list[float]:
    """Start an IDS's measurement some times; return by how much its absolute lengths are wrong, mm."""
    context = world(seed)
    session = session_of(context, "attocube-ids", "ids", **options)
    errors = []
    for _ in range(times):
        assert ask(context, session, SPACE + "system.startMeasurement") == [0]
        context.bench.advance(5.0)
        (_, length_pm) = ask(context, session, SPACE + "displacement.getAbsolutePosition", 0)
        index = 1.0 if options.get("ecu_enabled") else context.bench.air_index()
        errors.append(1e-9 * length_pm - index * context.beam_bench.true_state().length_mm)
        assert ask(context, session, SPACE + "system.stopMeasurement") == [0]
    return errors


@pytest.mark.parametrize("ecu_enabled", [True, False])
def test_an_absolute_length_is_found_within_its_uncertainty(ecu_enabled: bool) -> None:
    assert_unsure([started(seed, ecu_enabled=ecu_enabled)[0] for seed in SEEDS], 0.02)


def test_many_starts_do_not_find_the_true_length() -> None:
    means = [float(np.mean(started(seed, times=16))) for seed in SEEDS]
    assert_unsure(means, 0.02 / np.sqrt(2.0), 0.017)


@pytest.mark.parametrize("name", ["getAbsolutePosition", "getReferencePosition", "getAxisDisplacement"])
def test_without_a_beam_a_start_finds_no_length(name: str) -> None:
    context = world()
    context.bench.block_beam(None)
    session = session_of(context, "attocube-ids", "ids")
    assert ask(context, session, SPACE + "system.startMeasurement") == [0]
    context.bench.advance(5.0)
    assert ask(context, session, f"{SPACE}displacement.{name}", 0)[0] != 0


def test_levels_of_the_signal_scatter() -> None:
    context = world()
    ids = session_of(context, "attocube-ids", "ids")
    ask(context, ids, SPACE + "system.startMeasurement")
    context.bench.advance(5.0)
    levels = [ask(context, ids, SPACE + "adjustment.getContrastInPermille", 0)[1] for _ in range(40)]
    assert len(set(levels)) > 3
