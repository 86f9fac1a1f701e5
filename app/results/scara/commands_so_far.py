"""How far a measurement with open-loop tracking is: each command, and what its distance says beyond those before."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from catseye.app.results.scara.identify import aimed_bench
from catseye.app.results.scara.layout import sees
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.live_map import LiveMap, MapsSoFar
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.points import Commands
from catseye.procedures.kit.records import Json, Row
from catseye.procedures.kit.stored import integer, number_of
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.approach import Command
from catseye.procedures.scara.open_loop.live_knowledge import new_map
from catseye.procedures.scara.open_loop.off_node import measuring_sequence, usual_count
from catseye.procedures.scara.open_loop.open_loop import OpenLoop, OpenLoopParams
from catseye.procedures.scara.records import Distance
from catseye.procedures.scara.texts import MAP_KNOWN

Status = Literal["planned", "hidden", "left out", "under way", "measured"]

_TURNED: Final = "turned/"


@dataclass(frozen=True)
class Part:
    """The commands of one reflector.

    Attributes:
        reflector: what is aimed at.
        turned: the interferometer is turned on the flange of J4.
        status: of each command, in order.
        share: its innovation in units of its standard uncertainty, NaN where nothing was predicted, shape (n,).
    """

    reflector: Reflector
    turned: bool
    status: tuple[Status, ...]
    share: Floats

    @property
    def title(self) -> str:
        """Its name."""
        return f"turned, {self.reflector.name}" if self.turned else self.reflector.name

    @property
    def begun(self) -> bool:
        """Something of it was done."""
        return bool({"measured", "left out"}.intersection(self.status))

    def are(self, status: Status) -> Bools:
        """Return which commands have a status, shape (n,)."""
        return np.array([one == status for one in self.status], dtype=np.bool_)


@dataclass(frozen=True)
class MapsKnown:
    """How well the maps were known as commands were measured.

    Attributes:
        distances: measured until then, shape (k,).
        u_mdeg: largest standard uncertainty of either map, NaN while it is not determined, shape (k, 2).
    """

    distances: Floats
    u_mdeg: Floats


@dataclass(frozen=True)
class MeasurementSoFar:
    """A measurement as far as it has come.

    Attributes:
        bench: what it is planned with.
        commands: of each reflector, in order.
        parts: one a reflector, in measuring order.
        now: the part that is under way, or was the last.
        maps: as far as they are determined.
        known: how they came to be.
        stop_at_mdeg: standard uncertainty at which it stops early; 0 never.
        foreseen_mdeg: of either map for the whole plan; None where the plan does not determine it.
        u_um: median standard uncertainty of an innovation; None while there is none.
    """

    bench: ScaraBench
    commands: tuple[Command, ...]
    parts: tuple[Part, ...]
    now: Part
    maps: MapsSoFar
    known: MapsKnown
    stop_at_mdeg: float
    foreseen_mdeg: tuple[float | None, float | None]
    u_um: float | None

    @property
    def theta_deg(self) -> Floats:
        """Angles of the commands, shape (n, 2)."""
        return np.array([(one.theta1_deg, one.theta2_deg) for one in self.commands])

    @property
    def direction(self) -> Floats:
        """States of approach of the commands, 1 or -1, shape (n, 2)."""
        return np.array([(one.direction1, one.direction2) for one in self.commands], dtype=np.float64)


def measures_commands(reader: RunReader) -> bool:
    """Return whether a run is a measurement with open-loop tracking."""
    return reader.meta.get("procedure") == OpenLoop.name


class Progress:
    """Follows a measurement: what was computed of earlier distances is kept from look to look.

    Args:
        reader: of the run.
    """

    def __init__(self, reader: RunReader) -> None:
        params = OpenLoopParams.model_validate(reader.meta.get("params", {}))
        self._bench = aimed_bench(reader, reader.path.parent)
        count = usual_count(self._bench.nodes1_deg) if params.off_node is None else params.off_node
        self._commands = measuring_sequence(self._bench.nodes1_deg, self._bench.nodes2_deg, count)
        self._reflectors = self._bench.chosen(tuple(params.reflectors))
        self._turns = (False, True) if params.j4_reversal else (False,)
        self._stop_at_mdeg = params.stop_at_mdeg
        self._seen = {one.name: self._sees(one) for one in self._reflectors}
        self._map = self._new_map()
        self._foreseen_mdeg = self._foresee()
        self._share: dict[str, float] = {}
        self._u_um: list[float] = []
        self._taken = 0

    def look(self, reader: RunReader) -> MeasurementSoFar:
        """Return what the run holds by now."""
        rows = reader.placed_rows(Distance.table)
        for number, (_, row) in enumerate(rows[self._taken :], self._taken):
            self._take(number, row)
        self._taken = len(rows)
        done = {step.step_id: bool(step.result.get("measured")) for step in reader.steps()}
        running = reader.status == "running"
        parts = [
            self._part(reflector, turned, done, running=running)
            for turned in self._turns
            for reflector in self._reflectors
        ]
        now = next((part for part in reversed(parts) if part.begun), parts[0])
        return MeasurementSoFar(
            self._bench,
            self._commands,
            tuple(parts),
            now,
            self._map.maps(),
            _known(reader, [place for place, _ in rows]),
            self._stop_at_mdeg,
            self._foreseen_mdeg,
            float(np.median(self._u_um)) if self._u_um else None,
        )

    def _part(self, reflector: Reflector, turned: bool, done: Mapping[str, bool], *, running: bool) -> Part:
        prefix = f"{_TURNED if turned else ''}{reflector.name}/"
        ids = [f"{prefix}{command.index:04d}" for command in self._commands]
        last = max((place for place, one in enumerate(ids) if one in done), default=-1)
        status: list[Status] = []
        for place, (one, seen) in enumerate(zip(ids, self._seen[reflector.name], strict=True)):
            if one in done:
                status.append("measured" if done[one] else "left out")
            else:
                # What was passed without a step was not planned: the beam cannot get there.
                status.append("planned" if seen and place > last else "hidden")
        following = next((place for place in range(last + 1, len(ids)) if status[place] == "planned"), None)
        if running and last >= 0 and following is not None:
            status[following] = "under way"
        share = np.array([self._share.get(one, np.nan) for one in ids])
        return Part(reflector, turned, tuple(status), share)

    def _take(self, number: int, row: Row) -> None:
        """Take a distance in; between the nodes lies what the maps do not hold."""
        theta1_deg, theta2_deg = number_of(row, "theta1_deg"), number_of(row, "theta2_deg")
        if theta1_deg not in self._bench.nodes1_deg or theta2_deg not in self._bench.nodes2_deg:
            return
        mount_deg: Json = row.get("mount_deg")
        found = self._map.add(
            float(np.deg2rad(theta1_deg)),
            float(np.deg2rad(theta2_deg)),
            integer(row["direction1"]),
            integer(row["direction2"]),
            str(row["reflector"]),
            integer(row["segment"]),
            number_of(row, "displacement_mm"),
            float(np.deg2rad(mount_deg)) if isinstance(mount_deg, int | float) else 0.0,
            number,
        )
        if found is not None:
            self._share[str(row["step_id"])] = found.normalised
            self._u_um.append(1e3 * found.u_mm)

    def _sees(self, reflector: Reflector) -> list[bool]:
        theta = np.deg2rad([(one.theta1_deg, one.theta2_deg) for one in self._commands])
        place = forward(theta[:, 0], theta[:, 1], self._bench.link1_mm, self._bench.link2_mm)
        return [bool(one) for one in sees(self._bench, reflector, place)]

    def _new_map(self) -> LiveMap:
        distances = len(self._commands) * len(self._reflectors) * len(self._turns)
        return new_map(self._bench, self._reflectors, distances)

    def _foresee(self) -> tuple[float | None, float | None]:
        """Return how well both maps will be known when every command that sees its reflector is measured once."""
        whole = self._new_map()
        nodes = set(self._bench.nodes1_deg), set(self._bench.nodes2_deg)
        for reflector in self._reflectors:
            seen = zip(self._commands, self._seen[reflector.name], strict=True)
            own = [
                one
                for one, sees in seen
                if sees and one.theta1_deg in nodes[0] and one.theta2_deg in nodes[1]
            ]
            if own:
                whole.foresee(_as_commands(own), reflector.name)
        known = whole.known()
        first, second = (
            None if u is None else 1e3 * float(np.rad2deg(u)) for u in (known.u1_rad, known.u2_rad)
        )
        return first, second


def _as_commands(commands: Sequence[Command]) -> Commands:
    theta = np.deg2rad([(one.theta1_deg, one.theta2_deg) for one in commands])
    direction = np.array([(one.direction1, one.direction2) for one in commands], dtype=np.int64)
    return Commands(theta[:, 0], theta[:, 1], direction[:, 0], direction[:, 1])


def _known(reader: RunReader, places: Sequence[int]) -> MapsKnown:
    """Return what the run itself has said of the maps, over the distances measured until then."""
    said = [event for event in reader.events() if event.kind == MAP_KNOWN]
    stated = [[event.data.get(key) for key in ("u_theta1_mdeg", "u_theta2_mdeg")] for event in said]
    u_mdeg = np.array(stated, dtype=np.float64).reshape(-1, 2)
    until = np.searchsorted(places, [event.place or 0 for event in said])
    return MapsKnown(until.astype(np.float64), u_mdeg)
