"""The temperature of the links goes with each measurement of a cell that has a sensor on them."""

from pathlib import Path

from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.engine.host import run_procedure
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.context import Context
from tests.unit.app.engine.fakes import FakeAir, FakeBench, Script


class WarmBench(FakeBench):
    """A bench with a sensor on the links."""

    sensor: FakeAir

    def build(self, record: WireRecorder) -> Devices:
        devices = super().build(record)
        return Devices(devices.robot, devices.interferometer, devices.environment, material=self.sensor)


async def measured(bench: FakeBench, root: Path) -> list[float | None]:
    found: list[float | None] = []

    async def body(ctx: Context) -> None:
        for _ in range(3):
            found.append((await ctx.measure(0.1, 0.1, 1)).material_c)

    outcome = await run_procedure(
        bench.request(Script(body), root=root), bench.build, bench.clock, bench.publish, bench.install
    )
    assert outcome.status == "complete"
    assert ("material" in str(RunReader(outcome.path).meta["devices"])) is isinstance(bench, WarmBench)
    return found


async def test_the_sensor_is_read_seldom_and_belongs_to_the_run(tmp_path: Path) -> None:
    bench = WarmBench(tmp_path)
    bench.sensor = FakeAir(bench.clock)
    assert await measured(bench, tmp_path) == [21.0, 21.0, 21.0]
    assert bench.sensor.samples == 1


async def test_without_a_sensor_there_is_no_temperature(tmp_path: Path) -> None:
    assert await measured(FakeBench(tmp_path), tmp_path) == [None, None, None]
