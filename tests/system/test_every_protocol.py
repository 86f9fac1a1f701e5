"""The cell file with every protocol: its emulators and the doctor, as two processes."""

import json
from pathlib import Path

import pytest

from catseye.drivers.roles.registry import driver_names
from catseye.simulators.emulator import emulator_names
from tests.system.command import catseye, emulated

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
EXAMPLE = EXAMPLES / "every-protocol.toml"
OTHER_MAKES = ("kuka.toml", "abb.toml", "trackers.toml")
"""A robot of another make stands on a bench of its own, and so do trackers that look at a serial arm."""


def every_protocol(folder: Path) -> str:
    """Return the example with its serial lines in a folder of the test's own."""
    return EXAMPLE.read_text(encoding="utf-8").replace("/tmp/catseye-", f"{folder}/")


def test_examples_have_every_driver_and_every_emulator() -> None:
    text = "".join((EXAMPLES / name).read_text(encoding="utf-8") for name in (EXAMPLE.name, *OTHER_MAKES))
    # Real-time control is a door of the controller that the data link's cell file opens too.
    for name in {*driver_names(), *emulator_names()} - {"melfa-mxt"}:
        assert f'driver = "{name}"' in text, name
    assert "mxt_endpoint" in text


def test_the_doctor_finds_every_device_of_every_protocol(tmp_path: Path) -> None:
    with emulated(tmp_path, "--speed", "1", text=every_protocol(tmp_path)) as bench:
        found = catseye("doctor", bench.cell, "--json", cwd=tmp_path)
    devices = {row["device"]: row for row in json.loads(found.stdout)["devices"]}
    bad = {name: row["advice"] for name, row in devices.items() if not row["ok"]}
    assert not bad
    assert found.returncode == 0, found.stderr
    assert len(devices) == 12
    assert all(row["simulated"] for row in devices.values()), devices
    assert all(row["identity"] for row in devices.values())


@pytest.mark.parametrize("name", OTHER_MAKES)
def test_the_doctor_finds_robots_with_benches_of_their_own(tmp_path: Path, name: str) -> None:
    text = (EXAMPLES / name).read_text(encoding="utf-8")
    with emulated(tmp_path, "--speed", "1", text=text) as bench:
        found = catseye("doctor", bench.cell, "--json", cwd=tmp_path)
    devices = {row["device"]: row for row in json.loads(found.stdout)["devices"]}
    assert not {name: row["advice"] for name, row in devices.items() if not row["ok"]}
    assert devices["robot"]["simulated"]
