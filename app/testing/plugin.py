"""The pytest plugin of catseye: emulators as fixtures, and the door to the conformance suite.

It is loaded in every project in whose environment catseye is installed, so it imports nothing but pytest and adds no
option and no marker.

    def test_reads_a_length(catseye_bench):
        bench = catseye_bench("line-counter")
        driver = MyDriver(bench.endpoint("line-counter"))
        bench.fault("block_beam")
        assert driver.status().beam_lost
"""

import contextlib
from collections.abc import Callable, Iterator
from contextlib import AbstractAsyncContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from catseye.app.testing.bench import AsyncBench, RunningBench
    from catseye.simulators.config import EmulatedDevice

_SUITE = "catseye.app.testing.conformance"
_SUITE_OPTIONS = "catseye.app.testing.conformance_options"


def pytest_load_initial_conftests(early_config: pytest.Config, args: list[str]) -> None:
    """Let the conformance suite add its options when it is asked for by name, and only then."""
    if any(argument.split("::")[0] == _SUITE for argument in args):
        early_config.pluginmanager.import_plugin(_SUITE_OPTIONS)


@pytest.fixture
def catseye_bench() -> Iterator[Callable[..., "RunningBench"]]:
    """Start emulators in a background thread of this process; they end with the test.

    The fixture is a function. Its arguments are those of `catseye.app.testing.bench.bench_config`: protocols by
    name or `EmulatedDevice`s, `speed`, `seed`, `budget`. Works in plain and in coroutine tests.

        def test_sees_a_lost_beam(catseye_bench):
            bench = catseye_bench("line-counter", seed=7)
            endpoint = bench.endpoint("line-counter")     # tcp://127.0.0.1:40123
            bench.fault("block_beam", duration_s=1.0)     # by the control port
            bench.state().beam.length_mm                  # the truth
            bench.journal("line-counter")[-1].text        # what came over the wire
    """
    from catseye.app.testing.bench import bench_config, bench_in_thread

    with contextlib.ExitStack() as benches:

        def start(*devices: "str | EmulatedDevice", **choices: Any) -> "RunningBench":
            return benches.enter_context(bench_in_thread(bench_config(*devices, **choices)))

        yield start


@pytest.fixture
def catseye_async_bench() -> Callable[..., AbstractAsyncContextManager["AsyncBench"]]:
    """Run emulators on the event loop of a coroutine test, whichever plugin runs it.

    The fixture is a function that returns an asynchronous context; its arguments are those of `catseye_bench`.

        async def test_air(catseye_async_bench):
            async with catseye_async_bench("modbus-air") as bench:
                await bench.fault("air", temperature_k=5.0)
                sample = await MySensor(bench.endpoint("modbus-air")).sample()
    """
    from catseye.app.testing.bench import bench_config, bench_on_loop

    def bench(*devices: "str | EmulatedDevice", **choices: Any) -> AbstractAsyncContextManager["AsyncBench"]:
        return bench_on_loop(bench_config(*devices, **choices))

    return bench


@pytest.fixture
def catseye_process() -> Iterator[Callable[..., "RunningBench"]]:
    """Run `catseye emulate CELL` in a process of its own; it is killed at the end of the test, whatever happens.

    The fixture is a function: cell file (None: the template of `catseye init` on free ports), `speed`, `seed`.

        def test_command_line(catseye_process):
            bench = catseye_process(Path("cell.toml"), speed=50)
            subprocess.run(["my-tool", bench.endpoint("robot")], check=True)
    """
    from catseye.app.testing.process import bench_in_process

    with contextlib.ExitStack() as benches:

        def start(cell: Path | None = None, *, speed: float = 1.0, seed: int = 0) -> "RunningBench":
            return benches.enter_context(bench_in_process(cell, speed=speed, seed=seed))

        yield start
