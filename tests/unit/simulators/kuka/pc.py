"""A PC in front of the emulated controller, on bench time."""

from catseye.simulators.config import Option
from catseye.simulators.kuka.controller import KukaController
from catseye.simulators.kuka.program import CYCLE_S, Result
from tests.unit.simulators.kuka.benches import kuka_bench


class Pc:
    """Writes and reads variables at once, and lets bench time pass."""

    def __init__(self, **options: Option) -> None:
        self.emulation = kuka_bench(options=options)
        self.bench = self.emulation.bench
        self.controller: KukaController = self.emulation.controller
        self.number = 0

    def read(self, name: str) -> str:
        return self.controller.variables.read(name)

    def write(self, **values: str) -> None:
        for name, text in values.items():
            self.controller.variables.write(name, text)

    def begin(self, **values: str) -> None:
        """Give an order and let the program take it."""
        self.number += 1
        self.write(**values, CATS_FOR=str(self.number), CATS_SEQ=str(self.number))
        self.bench.advance(2 * CYCLE_S)

    def begin_long_move(self) -> None:
        self.write(CATS_CMD="1", CATS_GOAL="{A1 90,A2 -90,A3 90,A4 0,A5 30,A6 0}")
        self.controller.variables.write("$OV_PRO", "10")
        self.begin()

    def live(self, seconds: float) -> None:
        """Let bench time pass with a heartbeat."""
        end_s = self.bench.time_s + seconds
        while self.bench.time_s < end_s:
            self.write(CATS_BEAT="TRUE")
            self.bench.advance(min(0.1, end_s - self.bench.time_s))

    @property
    def result(self) -> tuple[int, Result]:
        return int(self.read("CATS_DONE")), Result(int(self.read("CATS_RESULT")))
