"""What whoever works by hand sees of the bench: nothing of devices that are not connected now."""

from pathlib import Path
from typing import cast

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.devices import Devices
from catseye.app.protocol.engine_events import JogChanged
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.engine_bench import EngineBench
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.device_loan import ManualBench
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import LinkError
from tests.unit.app.engine.fakes import ManualClock

ROBOT = Identity("emulated", "1.0", "7", True)


class Known:
    """A bench whose devices are connected, as far as a test wants."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.cell = folder / "cell.toml"
        self.write()
        clock = ManualClock()
        self.registry = ClientRegistry(clock)
        self.bench = EngineBench(self.registry, clock, self.cell, folder / "runs")
        self.bench.telemetry.describe(self.bench.facts())
        self.bench.telemetry.latest.connected("robot", ROBOT)
        self.awake: Devices | None = cast(Devices, object())
        monkeypatch.setattr(self.bench.idle, "devices", lambda: self.awake)

    @property
    def hands(self) -> ManualBench:
        return self.bench.for_hands()

    def write(self, **edit: str) -> None:
        text = TEMPLATE
        for old, new in edit.items():
            assert old in text
            text = text.replace(old, new)
        self.cell.write_text(text, encoding="utf-8")


@pytest.fixture
def known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Known:
    (tmp_path / "runs").mkdir()
    return Known(tmp_path, monkeypatch)


async def test_limits_are_those_of_the_cell_file_now(known: Known) -> None:
    known.write(**{"j1 = [-170.0, 170.0]": "j1 = [-20.0, 30.0]"})
    assert (await known.hands.facts()).bench.arm.axes[0].range == (-20.0, 30.0)


@pytest.mark.parametrize(
    ("old", "new"),
    [("tcp://127.0.0.1:10001", "tcp://192.168.0.20:10001"), ('name = "lab-1"', 'name = "lab-2"')],
)
async def test_other_devices_than_those_connected_are_refused(known: Known, old: str, new: str) -> None:
    """Who answers at the old place says nothing about the new one, be it a real robot."""
    known.write(**{old: new})
    with pytest.raises(RefusedError, match="other devices by now than those that are connected"):
        await known.hands.facts()
    # Asleep, the bench takes the file as it is when it wakes.
    known.awake = None
    assert (await known.hands.facts()).cell in {"lab-1", "lab-2"}


def test_of_links_that_are_not_held_nothing_is_known(known: Known) -> None:
    assert known.hands.identities() == {"robot": ROBOT}
    known.bench.telemetry.latest.lost("robot", str(LinkError("gone")))
    assert known.hands.identities() == {}
    known.bench.telemetry.latest.connected("robot", ROBOT)
    known.awake = None
    assert known.hands.identities() == {}


def test_the_snapshot_has_the_jog_that_is_under_way(known: Known) -> None:
    jog = JogChanged(on=True, by="Ada (test-1)", client="test-1", percent=5.0, moving=None)
    known.hands.announce(jog)
    snapshot = known.registry.snapshot().json_object()
    fields = {"on": True, "by": "Ada (test-1)", "client": "test-1", "percent": 5.0, "moving": None}
    assert snapshot["jog"] == fields
    known.hands.announce(jog.model_copy(update={"on": False}))
    assert known.registry.snapshot().jog is None
