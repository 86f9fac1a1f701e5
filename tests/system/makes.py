"""Robots of two makes with serial arms, and what tests of their stops have to know of each."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

from catseye.drivers.abb import robot as abb
from catseye.drivers.abb.robot import AbbRws
from catseye.drivers.abb.settings import AbbSettings
from catseye.drivers.kuka import robot as kuka
from catseye.drivers.kuka.robot import KukaVarproxy
from catseye.drivers.kuka.settings import KukaSettings
from catseye.drivers.roles.clock import SystemClock
from catseye.simulators.config import Joints
from catseye.simulators.emulated_bench import EmulatedAbbBench, EmulatedSerialBench
from tests.unit.simulators.abb.benches import BENT, abb_bench
from tests.unit.simulators.kuka.benches import UPRIGHT, kuka_bench

EXAMPLES: Final = Path(__file__).parents[2] / "docs" / "examples"

AnyBench = EmulatedAbbBench | EmulatedSerialBench


@dataclass(frozen=True)
class Make:
    """A robot with its controller.

    Attributes:
        example: cell file.
        driver: class of the driver.
        uses: what its connections are for, in their order.
        impatient: settings with which nothing is waited for long.
        bench: makes its emulated bench.
        pose: joints away from limits and singularities, deg.
        order: beginning of what the journal says of an order, which has a number.
        stop: what it says of a STOP.
        flood: bytes of which no answer begins.
    """

    example: Path
    driver: Any
    uses: tuple[str, ...]
    impatient: Any
    bench: Callable[[], AnyBench]
    pose: Joints
    order: str
    stop: str
    flood: bytes

    def behind(self, *transports: Any) -> Any:
        """Return a driver on connections of its own."""
        return self.driver(transports, SystemClock(), self.impatient)


MAKES: Final = {
    "kuka": Make(
        EXAMPLES / "kuka.toml",
        KukaVarproxy,
        kuka.USES,
        KukaSettings(answer_timeout_s=0.3, stop_timeout_s=3.0),
        kuka_bench,
        UPRIGHT,
        "write CATS_SEQ",
        "write CATS_STOP = TRUE",
        b"\0\0",
    ),
    "abb": Make(
        EXAMPLES / "abb.toml",
        AbbRws,
        abb.USES,
        AbbSettings(answer_timeout_s=0.5, stop_timeout_s=5.0),
        # A session whose end a fault swallows stays for minutes: a campaign leaves more than the usual 70.
        partial(abb_bench, options={"sessions": 1000}),
        BENT,
        "POST /rw/rapid/symbol/data/RAPID/T_ROB1/CATSABB/cats_seq",
        "POST /rw/rapid/execution?action=stop&json=1 stopmode=stop",
        b"\0\0",
    ),
}
