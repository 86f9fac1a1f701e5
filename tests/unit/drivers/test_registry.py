"""Drivers by name."""

from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest

from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.roles import registry

ENTRIES = metadata.EntryPoints(
    [
        metadata.EntryPoint("melfa-r3", "catseye.drivers.melfa.robot:MelfaR3", registry.GROUP),
        metadata.EntryPoint("line-counter", "catseye.drivers.counter.counter:LineCounter", registry.GROUP),
        metadata.EntryPoint("modbus-air", "catseye.drivers.air.modbus_air:ModbusAir", registry.GROUP),
        metadata.EntryPoint("no-driver", "collections:OrderedDict", registry.GROUP),
        metadata.EntryPoint("other", "elsewhere:Thing", "other.group"),
    ]
)


@pytest.fixture(autouse=True)
def forgotten() -> Iterator[None]:
    """Have each test look for what is installed, and none leave what it found."""
    registry.installed.cache_clear()
    registry._all_drivers.cache_clear()  # noqa: SLF001  # kept for the life of a process
    yield
    registry.installed.cache_clear()
    registry._all_drivers.cache_clear()  # noqa: SLF001  # kept for the life of a process


def installed(entries: metadata.EntryPoints, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have these entry points installed."""

    def entry_points(**params: Any) -> metadata.EntryPoints:
        return entries.select(**params)

    monkeypatch.setattr(metadata, "entry_points", entry_points)


def test_built_in_drivers_are_found_and_described(monkeypatch: pytest.MonkeyPatch) -> None:
    installed(ENTRIES, monkeypatch)
    assert registry.driver_names() == ("line-counter", "melfa-r3", "modbus-air", "no-driver")
    assert registry.load_driver("melfa-r3") is MelfaR3
    for name in ("line-counter", "melfa-r3", "modbus-air"):
        assert registry.load_driver(name).Settings.model_fields


def test_a_driver_of_another_role_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    installed(ENTRIES, monkeypatch)
    assert registry.load_driver("melfa-r3", "robot") is MelfaR3
    with pytest.raises(LookupError, match="'line-counter' is a driver of role interferometer, not robot"):
        registry.load_driver("line-counter", "robot")


def test_what_declares_no_role_is_no_driver(monkeypatch: pytest.MonkeyPatch) -> None:
    installed(ENTRIES, monkeypatch)
    with pytest.raises(LookupError, match="has no attribute 'role'; a driver subclasses its role"):
        registry.load_driver("no-driver")


@pytest.mark.parametrize("raises", ["ImportError('no acme_dll')", "OSError(2, 'no acme_dll')", "1 / 0"])
def test_a_broken_driver_harms_no_other(raises: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    text = raises if raises == "1 / 0" else f"raise {raises}"
    (tmp_path / "acme_odd.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    odd = metadata.EntryPoint("acme-odd", "acme_odd:Driver", registry.GROUP)
    good = [entry for entry in ENTRIES if entry.name != "no-driver"]
    installed(metadata.EntryPoints([odd, *good]), monkeypatch)
    assert set(registry.working_drivers()) == {"line-counter", "melfa-r3", "modbus-air"}
    ((name, said),) = registry.broken_drivers().items()
    assert name == "acme-odd"
    assert said.startswith("driver acme-odd of acme_odd cannot be loaded: ")
    assert said.endswith("; install acme_odd again, or remove it")
    with pytest.raises(LookupError, match="acme-odd of acme_odd cannot be loaded"):
        registry.load_driver("acme-odd")


def test_an_unknown_driver_names_the_nearest_one(monkeypatch: pytest.MonkeyPatch) -> None:
    installed(ENTRIES, monkeypatch)
    with pytest.raises(LookupError, match=r"no driver 'melfa-r4' .* did you mean 'melfa-r3'"):
        registry.load_driver("melfa-r4")


def test_an_unknown_driver_names_those_of_its_role_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    installed(ENTRIES, monkeypatch)
    with pytest.raises(LookupError, match="installed are line-counter; did you mean 'line-counter'"):
        registry.load_driver("line-countr", "interferometer")


def test_missing_entry_points_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    installed(metadata.EntryPoints([]), monkeypatch)
    with pytest.raises(LookupError, match="installed are none: reinstall the program"):
        registry.load_driver("melfa-r3")
