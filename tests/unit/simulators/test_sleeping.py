"""Signs of life that come while an emulator does not run: a real controller would have heard them."""

from collections.abc import Callable
from functools import partial

import pytest

from catseye.simulators.abb.program import Result as AbbResult
from catseye.simulators.emulated_bench import EmulatedAbbBench, EmulatedSerialBench
from catseye.simulators.kuka.program import Result as KukaResult
from catseye.simulators.world.timekeeper import TimeKeeper
from tests.patience import until
from tests.unit.simulators.abb.benches import BENT, abb_bench
from tests.unit.simulators.kuka.benches import kuka_bench

STEP_S = 0.05
SLEPT_S = 0.8
"""Far more than either program waits for a sign of life."""


class Wall:
    """A wall clock."""

    time_s = 1000.0

    def __call__(self) -> float:
        return self.time_s


class Pc:
    """Has an arm move, and gives signs of life at once."""

    def __init__(self, bench: EmulatedAbbBench | EmulatedSerialBench) -> None:
        self.served = bench
        self.bench = bench.bench
        self.beats = 0

    def begin(self) -> None:
        if isinstance(self.served, EmulatedAbbBench):
            self.served.controller.control.set_override(2)
            goal = ",".join(map(str, (100.0, *BENT[1:])))
            self._write(cats_goal=f"[[{goal}],[9E9,9E9,9E9,9E9,9E9,9E9]]", cats_for="1", cats_seq="1")
        else:
            self.served.controller.control.set_override(2)
            goal = "{A1 90,A2 -90,A3 90,A4 0,A5 30,A6 0}"
            self._write(CATS_CMD="1", CATS_GOAL=goal, CATS_FOR="1", CATS_SEQ="1")

    def beat(self) -> None:
        self.beats += 1
        if isinstance(self.served, EmulatedAbbBench):
            self._write(cats_beat=str(self.beats))
        else:
            self._write(CATS_BEAT="TRUE")

    @property
    def lost(self) -> bool:
        """The program has missed the signs of life."""
        if isinstance(self.served, EmulatedAbbBench):
            return self.served.controller.program.data["cats_result"] == AbbResult.NO_HEARTBEAT
        return self.served.controller.program.variables["CATS_RESULT"] == KukaResult.NO_HEARTBEAT

    def braked_s(self) -> float:
        """Return when the arm began to brake."""
        entries = self.served.journal.entries("robot")
        return next(entry.time_s for entry in entries if entry.text.startswith("stop towards"))

    def _write(self, **values: str) -> None:
        for name, text in values.items():
            if isinstance(self.served, EmulatedAbbBench):
                self.served.controller.symbols.write(f"RAPID/T_ROB1/{name}", text)
            else:
                self.served.controller.variables.write(name, text)


MAKES = pytest.mark.parametrize("make", [kuka_bench, abb_bench])
Make = Callable[[], EmulatedAbbBench | EmulatedSerialBench]


class Emulator:
    """Runs by hand on a wall clock."""

    def __init__(self, make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
        self.wall = Wall()
        monkeypatch.setattr(
            "catseye.simulators.emulated_bench.TimeKeeper", partial(TimeKeeper, clock=self.wall)
        )
        self.pc = Pc(make())

    def run(self, real_s: float, *, beats: bool) -> None:
        for _ in range(round(real_s / STEP_S)):
            self.wall.time_s += STEP_S
            self.pc.served.keeper.sync()
            if beats:
                self.pc.beat()


@MAKES
async def test_signs_that_came_during_a_sleep_are_heard(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    emulator = Emulator(make, monkeypatch)
    emulator.pc.begin()
    # The first sleep is over the moment at which the order is taken.
    for _ in range(3):
        emulator.wall.time_s += SLEPT_S
        # A request is answered: then what came on other connections is read.
        emulator.pc.served.keeper.sync()
        emulator.run(1.0, beats=True)
        assert emulator.pc.bench.moving
        assert not emulator.pc.lost


@MAKES
async def test_a_silent_pc_has_its_stop_after_a_sleep(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    emulator = Emulator(make, monkeypatch)
    emulator.pc.begin()
    emulator.run(1.0, beats=True)
    silent_s = emulator.pc.bench.time_s
    emulator.run(0.2, beats=False)
    emulator.wall.time_s += SLEPT_S
    emulator.run(1.0, beats=False)
    assert emulator.pc.lost
    assert 0.4 <= emulator.pc.braked_s() - silent_s <= 0.52


@MAKES
async def test_an_arm_stops_though_nobody_asks(make: Make) -> None:
    pc = Pc(make())
    pc.begin()
    await until(lambda: pc.lost)
    assert not pc.bench.moving
