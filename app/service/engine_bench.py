"""The bench of an engine: watched during runs and between them, worked on by hand between them."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from pathlib import Path

from catseye.app.cell.bench import bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.engine.devices import DeviceBuilder
from catseye.app.errors import CatseyeError, StorageError, UsageError
from catseye.app.protocol.engine_events import JogChanged, OverrideLeft
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.procedures import bases
from catseye.app.protocol.run_events import WarningIssued
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.device_loan import ManualBench
from catseye.app.service.running import PlannedRun
from catseye.app.service.watching.bench_facts import BenchFacts, facts_of
from catseye.app.service.watching.cell_devices import cell_devices
from catseye.app.service.watching.device_pool import CellDevices, DevicePool
from catseye.app.service.watching.telemetry import Telemetry
from catseye.app.store.basis import find_basis
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.io import Io


class EngineBench:
    """Knows the cell file of an engine.

    Args:
        clock: real time.
        cell: cell file of the bench; read anew whenever its devices are made.

    Attributes:
        telemetry: for the clients that watch.
        idle: the devices between runs.
    """

    def __init__(self, registry: ClientRegistry, clock: Clock, cell: Path, root: Path) -> None:
        self.telemetry = Telemetry(registry, clock, root)
        self.telemetry.prepare = self._prepare
        self.idle = DevicePool(
            self._make, self.telemetry.latest, clock, lambda text: registry.announce(WarningIssued(text=text))
        )
        self.telemetry.on_watched = self.idle.watched
        self._registry = registry
        self._clock = clock
        self._cell = cell
        self._root = root

    def facts(self) -> BenchFacts:
        """Return what cell file and last search say of the bench; reads files.

        Raises:
            ConfigError: the cell file is wrong.
        """
        return self._aimed(load_cell(self._cell).cell)

    def observe(self, planned: PlannedRun, build: DeviceBuilder) -> DeviceBuilder:
        """Return a builder of a run's devices that are seen by those who watch."""
        return self.telemetry.observe(facts_of(planned.loaded.cell, planned.bench), build)

    def for_hands(self) -> ManualBench:
        """Return the bench for whoever works on it by hand between runs."""
        return ManualBench(
            self.idle,
            self._find_facts,
            self._identities,
            self.telemetry.traffic.record,
            self._announce,
            self._clock,
            self._root,
            self._door,
            self.owned,
        )

    @asynccontextmanager
    async def owned(self, what: str) -> AsyncIterator[None]:
        """Be the owner of the connected arm meanwhile.

        Args:
            what: is done to it, for whoever wants it meanwhile.

        Raises:
            ArmInUseError: another program owns it.
        """
        devices = self.idle.devices()
        guard = None if devices is None else devices.guard
        if guard is None:
            yield
            return
        identity = self._identities().get("robot")
        simulated = identity is not None and identity.simulated
        try:
            for text in await guard.hold(what, self._root, simulated=simulated):
                self._registry.announce(WarningIssued(text=text))
            yield
        finally:
            await guard.let_go()

    async def end(self) -> None:
        """Publish no more, and let every link go."""
        await self.telemetry.end()
        await self.idle.end()

    async def _find_facts(self) -> BenchFacts:
        """Return what cell file and last search say now, for the devices that are connected.

        Raises:
            RefusedError: the cell file has other devices by now: what is known of these says nothing about those.
            ConfigError: the cell file is wrong.
        """
        facts, connected = await asyncio.to_thread(self.facts), self.telemetry.facts
        if self.idle.devices() is None or connected is None:
            return facts
        if (facts.cell, facts.devices) != (connected.cell, connected.devices):
            raise RefusedError(
                f"{self._cell} names other devices by now than those that are connected: end every program that "
                "watches this engine, so that it takes the cell file again"
            )
        return facts

    def _door(self) -> Io | None:
        """Return the block with the door's interlock, while the devices are made."""
        devices = self.idle.devices()
        return None if devices is None else devices.io

    def _identities(self) -> dict[str, Identity]:
        """Return who answers now: of a link that is not held nothing is known."""
        if self.idle.devices() is None:
            return {}
        links = self.telemetry.latest.links.items()
        return {name: link.identity for name, link in links if link.identity and link.state == "ok"}

    def _announce(self, event: AnyEvent) -> None:
        """Send every client what is done by hand; a jog, and the override that it leaves, stand in snapshots too."""
        if isinstance(event, JogChanged):
            self._registry.facts = replace(self._registry.facts, jog=event if event.on else None)
        if isinstance(event, OverrideLeft):
            self._registry.facts = replace(self._registry.facts, override_left=event.left)
        self._registry.announce(event)

    def _prepare(self) -> None:
        """See to it that a client that begins to watch learns what the cell file says.

        Raises:
            RefusedError: the cell file is wrong.
        """
        in_use = self._registry.run is not None or self._registry.beginning or self.idle.devices() is not None
        if in_use and self.telemetry.facts is not None:
            return
        try:
            cell = load_cell(self._cell).cell
            self.telemetry.describe(facts_of(cell, bench_of(cell)))
        except CatseyeError as error:
            raise RefusedError(str(error), error.exit_code) from error

    async def _make(self) -> CellDevices:
        """Make the devices as the cell file has them now.

        Raises:
            ConfigError: the cell file is wrong, a driver is not installed or a setting is wrong.
        """
        cell = await asyncio.to_thread(lambda: load_cell(self._cell).cell)
        self.telemetry.describe(await asyncio.to_thread(self._aimed, cell))
        return cell_devices(cell, self.telemetry.latest, self._clock, self.telemetry.traffic.record)

    def _aimed(self, cell: Cell) -> BenchFacts:
        """Return the facts of a cell with the places that the last search found, if they still hold."""
        bench = bench_of(cell)
        # Where the beam was moved after the search, or its record was changed, the cell file's places are as good
        # as any.
        with suppress(UsageError, StorageError):
            for basis in bases(bench):
                bench = find_basis(basis, bench, self._root).bench
        return facts_of(cell, bench)
