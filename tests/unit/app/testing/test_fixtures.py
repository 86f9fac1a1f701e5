"""The fixtures of the pytest plugin, as a test elsewhere uses them: by plain sockets, without our drivers."""

import socket
import subprocess
import sys
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from typing import Any

import pytest

from catseye.app.testing.bench import AsyncBench, RunningBench
from catseye.simulators.config import EmulatedDevice
from catseye.simulators.control_port.messages import Identify
from tests.patience import HANG_S

StartBench = Callable[..., RunningBench]


def ask(endpoint: str, request: bytes) -> bytes:
    """Put one line to a device and return its answer line."""
    host, _, port = endpoint.removeprefix("tcp://").rpartition(":")
    with socket.create_connection((host, int(port)), timeout=HANG_S) as link, link.makefile("rb") as answers:
        link.sendall(request)
        return answers.readline()


def test_devices_are_chosen_by_their_protocols(catseye_bench: StartBench) -> None:
    bench = catseye_bench("line-counter")
    assert list(bench.endpoints) == ["line-counter"]
    assert b"EMULATOR" in ask(bench.endpoint("line-counter"), b"I\r\n")


def test_without_a_choice_there_are_robot_interferometer_and_environment(catseye_bench: StartBench) -> None:
    assert list(catseye_bench().endpoints) == ["environment", "interferometer", "robot"]


def test_a_device_may_have_its_own_name_and_endpoint(catseye_bench: StartBench) -> None:
    bench = catseye_bench(EmulatedDevice("gauge", "line-counter", "serial:///dev/ptmx?baud=9600"))
    assert bench.endpoint("gauge").startswith("serial:///dev/pts/")


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 5])
def test_the_beam_returns_initially_and_faults_reach_the_wire(catseye_bench: StartBench, seed: int) -> None:
    bench = catseye_bench("line-counter", seed=seed)
    counter = bench.endpoint("line-counter")
    assert bench.state().beam.returns
    assert ask(counter, b"S\r\n") == b"10\r\n"
    bench.fault("block_beam")
    assert ask(counter, b"S\r\n") == b"15\r\n"
    bench.clear_faults()
    assert ask(counter, b"S\r\n") == b"11\r\n"
    assert [entry.text for entry in bench.journal("line-counter")] == ["S", "S", "S"]


def test_the_same_seed_gives_the_same_arm(catseye_bench: StartBench) -> None:
    first, same, other = (catseye_bench("line-counter", seed=seed).truth() for seed in (3, 3, 4))
    assert first == same != other


def test_a_wrong_request_is_reported(catseye_bench: StartBench) -> None:
    bench = catseye_bench("line-counter")
    with pytest.raises(ValueError, match="there is no fault 'earthquake'"):
        bench.fault("earthquake")
    with pytest.raises(LookupError, match="no device 'robot'; it has line-counter"):
        bench.endpoint("robot")


async def test_the_bench_in_a_thread_serves_a_coroutine_test_too(catseye_bench: StartBench) -> None:
    bench = catseye_bench("modbus-air")
    assert bench.state().moving is False


async def test_a_bench_on_the_loop_of_the_test(
    catseye_async_bench: Callable[..., AbstractAsyncContextManager[AsyncBench]],
) -> None:
    async with catseye_async_bench("line-counter", speed=10.0) as bench:
        assert (await bench.ask(Identify())).speed == 10.0
        await bench.fault("block_beam")
        assert not (await bench.state()).beam.returns
        await bench.clear_faults()
        assert (await bench.state()).beam.returns
        assert await bench.journal("line-counter") == []
        assert "link1_mm" in await bench.truth()


def test_the_plugin_loads_nothing_but_pytest() -> None:
    heavy = "{'catseye.drivers', 'catseye.simulators', 'numpy', 'scipy', 'pydantic', 'asyncio'} & set(sys.modules)"
    # pytest itself is loaded before, whatever it needs.
    code = f"import pytest, sys; before = {heavy}; import catseye.app.testing.plugin; print(sorted({heavy} - before))"
    done: Any = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=HANG_S
    )
    assert done.stdout.strip() == "[]"
