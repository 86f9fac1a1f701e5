"""The bench of an engine's cell file: read when somebody looks, as it is then."""

from pathlib import Path

import pytest

from catseye.app.cell.model import FurtherDevice, Material
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.engine_bench import EngineBench
from catseye.app.service.errors import RefusedError
from catseye.app.service.watching.cell_devices import cell_devices
from catseye.app.service.watching.latest_values import LatestValues
from catseye.app.service.watching.observed_devices import ObservedAir, ObservedSensor
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.app.service.manual.benches import cell_from_template


def bench_at(cell: Path, registry: ClientRegistry | None = None) -> EngineBench:
    return EngineBench(registry or ClientRegistry(ManualClock()), ManualClock(), cell, cell.parent / "runs")


def test_each_device_is_observed_once_under_its_name() -> None:
    steel, floor = (
        FurtherDevice(name=name, driver="modbus-air", endpoint=f"tcp://127.0.0.1:{port}")
        for name, port in (("steel", 1), ("floor", 2))
    )
    cell = cell_from_template().model_copy(
        update={"device": [steel, floor], "material": Material(sensor="steel", cte_per_k=1e-5)}
    )
    lines: list[tuple[str, str, bytes]] = []
    made = cell_devices(cell, LatestValues(ManualClock()), ManualClock(), lambda *line: lines.append(line))
    assert list(made.kept) == ["robot", "interferometer", "environment", "tracker", "steel", "floor"]
    assert all(name == device.name for name, device in made.kept.items())
    material: object = made.devices.material
    assert made.kept["steel"] is material
    # Only the air of the beam is the air that is published.
    assert [type(made.kept[name]) for name in ("environment", "steel", "floor")] == [
        ObservedAir,
        ObservedSensor,
        ObservedSensor,
    ]
    assert lines == []


def cell_seen(bench: EngineBench) -> str:
    status = bench.telemetry.bench()
    assert status is not None
    return status.cell


def test_an_unusable_cell_file_refuses_watching_until_mended(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    bench = bench_at(cell)
    with pytest.raises(RefusedError, match=r"cell\.toml"):
        bench.telemetry.prepare()
    cell.write_text(TEMPLATE.replace("link1_mm", "link9_mm"), encoding="utf-8")
    with pytest.raises(RefusedError, match="link9_mm"):
        bench.telemetry.prepare()
    cell.write_text(TEMPLATE, encoding="utf-8")
    bench.telemetry.prepare()
    assert cell_seen(bench) == cell_from_template().name
    cell.write_text(TEMPLATE.replace('name = "lab-1"', 'name = "lab-2"'), encoding="utf-8")
    bench.telemetry.prepare()
    assert cell_seen(bench) == bench.facts().cell == "lab-2"


def test_during_a_run_the_file_is_not_looked_at(tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    cell.write_text(TEMPLATE, encoding="utf-8")
    registry = ClientRegistry(ManualClock())
    bench = bench_at(cell, registry)
    bench.telemetry.prepare()
    cell.unlink()
    registry.beginning = True
    bench.telemetry.prepare()
    assert bench.telemetry.facts is not None
