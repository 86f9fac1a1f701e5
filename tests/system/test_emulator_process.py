"""The emulators as a process of its own, by the fixture of the pytest plugin."""

import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from catseye.app.testing.bench import RunningBench
from catseye.app.testing.process import bench_in_process
from catseye.simulators.control_port.messages import Identify
from tests.patience import HANG_S


def test_a_process_serves_the_template_on_free_ports(catseye_process: Callable[..., RunningBench]) -> None:
    bench = catseye_process(speed=50.0, seed=2)
    assert list(bench.endpoints) == ["environment", "interferometer", "robot"]
    assert bench.ask(Identify()).speed == 50.0
    host, _, port = bench.endpoint("robot").removeprefix("tcp://").rpartition(":")
    with socket.create_connection((host, int(port)), timeout=HANG_S) as robot:
        robot.sendall(b"1;1;OPEN=TEST\r")
        assert b"EMULATOR" in robot.recv(4096)
    assert bench.journal("robot")[-1].text == "1;1;OPEN=TEST"


def test_the_process_ends_with_its_context_even_on_failure() -> None:
    controls: list[str] = []

    def use_it_and_fail() -> None:
        with bench_in_process() as bench:
            controls.append(bench.control)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        use_it_and_fail()
    host, _, port = controls[0].removeprefix("tcp://").rpartition(":")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection((host, int(port)), timeout=HANG_S)


def test_a_cell_file_that_cannot_be_used_is_reported(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text("name = 7" + os.linesep, encoding="utf-8")
    with pytest.raises(RuntimeError, match=r"cell\.toml"), bench_in_process(cell):
        pass
