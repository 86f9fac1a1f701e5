"""The conformance suite with a device on a bench that runs already, by the bench's control port."""

import math
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from catseye.app.testing.bench import RunningBench, bench_config, bench_in_thread
from catseye.app.testing.candidate import Candidate, candidate_of
from catseye.app.testing.checks.catalogue import ALL, applicable, not_applicable
from catseye.app.testing.checks.check import run_check
from catseye.app.testing.trial import NotConformingError
from catseye.simulators.control_port.messages import TurnScrew
from tests.patience import HANG_S
from tests.system.quick import short_timeouts
from tests.system.test_conformance_finds_faults import Forgetful

Candidates = Callable[[str], Candidate]

CHECKS = {check.name: check for check in ALL}


@pytest.fixture
def bench() -> Iterator[RunningBench]:
    with bench_in_thread(bench_config()) as running:
        yield running


@pytest.fixture
def on_bench(bench: RunningBench, tmp_path: Path) -> Candidates:
    """Return drivers in front of devices of the bench."""
    devices = {"melfa-r3": "robot", "line-counter": "interferometer", "modbus-air": "environment"}

    def found(name: str) -> Candidate:
        driver = candidate_of(
            name, endpoint=bench.endpoint(devices[name]), control=bench.control, allow_motion=True
        )
        return replace(driver, settings=short_timeouts(driver, tmp_path))

    return found


@pytest.mark.parametrize("name", ["line-counter", "modbus-air", "melfa-r3"])
def test_checks_leave_the_bench_as_it_was(name: str, on_bench: Candidates, bench: RunningBench) -> None:
    driver, before = on_bench(name), bench.state().beam
    assert set(not_applicable(driver)) == {"a_device_left_streaming_is_connected"}
    for check in 2 * [check for check in applicable(driver) if "bench" in check.needs]:
        run_check(check, driver)
    if name != "melfa-r3":
        assert bench.state().beam.length_mm == pytest.approx(before.length_mm, abs=1e-6)


def test_a_fault_is_found_by_the_control_port(on_bench: Candidates) -> None:
    faulty = replace(on_bench("line-counter"), driver=Forgetful)
    with pytest.raises(NotConformingError, match="revived the count"):
        run_check(CHECKS["a_lost_beam_is_latched_until_the_next_zero"], faulty)


def push_aside(bench: RunningBench, by_mm: float) -> None:
    beam = bench.state().beam
    way_rad = math.radians(beam.direction_deg)
    way = {"dx_mm": -by_mm * math.sin(way_rad), "dy_mm": by_mm * math.cos(way_rad)}
    bench.fault("move_reflector", reflector=beam.nearest, **way)


@pytest.mark.parametrize("by_mm", [80.0, -80.0])
def test_a_reflector_that_is_missed_is_lent(by_mm: float, on_bench: Candidates, bench: RunningBench) -> None:
    push_aside(bench, by_mm)
    before = bench.state().beam
    assert not before.returns
    run_check(CHECKS["a_zero_makes_the_count_zero"], on_bench("line-counter"))
    assert bench.state().beam.miss_mm == pytest.approx(before.miss_mm, abs=1e-6)


def test_a_beam_that_hits_nothing_is_named() -> None:
    with bench_in_thread(bench_config(acceptance_mm=1.0)) as bench:
        bench.ask(TurnScrew(screw="level", turns=20.0))
        driver = candidate_of(
            "line-counter", endpoint=bench.endpoint("interferometer"), control=bench.control
        )
        with pytest.raises(RuntimeError, match="move its arm"):
            run_check(CHECKS["a_zero_makes_the_count_zero"], driver)


def test_a_control_port_that_is_none_is_named(on_bench: Candidates) -> None:
    driver = replace(on_bench("line-counter"), control="tcp://127.0.0.1:9")
    with pytest.raises(RuntimeError, match="start the bench first"):
        run_check(CHECKS["a_zero_makes_the_count_zero"], driver)


def test_the_option_is_that_of_the_command_line(bench: RunningBench, tmp_path: Path) -> None:
    chosen = [
        "--driver",
        "modbus-air",
        "--endpoint",
        bench.endpoint("environment"),
        "--control",
        bench.control,
    ]
    done = suite(tmp_path, *chosen, "--setting", "timeout_s=0.3")
    assert done.returncode == 0, done.stdout
    assert "needs the truth" not in done.stdout
    assert (
        "not applicable: another_serial_number_is_noticed: the device gives no serial number" in done.stdout
    )


def test_a_control_port_needs_an_endpoint(bench: RunningBench, tmp_path: Path) -> None:
    done = suite(tmp_path, "--driver", "modbus-air", "--control", bench.control)
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert "--control needs --endpoint" in done.stderr


def suite(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    arguments = ["-p", "no:cacheprovider", "--pyargs", "catseye.app.testing.conformance", *options]
    return subprocess.run(
        [sys.executable, "-m", "pytest", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=HANG_S,
        check=False,
    )
