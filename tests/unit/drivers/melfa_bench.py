"""A scripted MELFA controller and the driver in front of it. Bytes come from the protocol sheet, sections given."""

from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager
from typing import Any

import pytest

from catseye.drivers.melfa.motion import VARIABLES
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.errors import LinkTimeoutError
from tests.unit.drivers.peers import Peer, StepClock

# Section 1.8: sixteen fields and a trailing semicolon; patterns 0F of a four-axis RH are inferred there.

OPEN = (
    "QoK0F;0F;7,0;3,5,A,1E,32,46,64;MB5;PRM;RH-3FRH5515-D;CR75x;MELFA;17-10-06;Ver.S7e;ENG;{copyright};1;3;8;"
)
# Section 1.10: A0 operation right and servo, E0 these and running, 80 servo off, 88 TEACH; stop status 60 or 01.
STATE = "QoK;0;20;0;{flags};0;1;;;;;;;;;REP;START;1;0"
# Section 1.11, with the four axes of an RH.
JPOS = "QoKJ1;{:.2f};J2;{:.2f};J3;{:.2f};J4;{:.2f};;****,****;20;0.00;00000000"
TARGET = (10.0, -20.5, 0.0, 30.25)
START = (0.0, 0.0, 0.0, 0.0)
QUICK: dict[str, Any] = {"quiet_s": 0.001, "answer_timeout_s": 0.2}


class Controller:
    """Answers as the sheet's transcripts do; tests replace single answers."""

    def __init__(self) -> None:
        self.at: tuple[float, ...] = START
        self.flags = "A0060"
        self.alarm = ""
        self.override = "20"
        self.copyright = "COPYRIGHT(C) someone"
        self.suffix = ""
        self.mxttout = "70"
        self.arrives = True
        self.owes = False
        self.replies: dict[str, Callable[[], Iterable[str]]] = {}
        self.target = START

    def answer(self, data: bytes) -> Iterable[bytes]:
        command = data.decode().strip().removeprefix("1;1;")
        replies = self.replies.get(command.partition("=")[0], lambda: self.usual(command))()
        return [(reply + self.suffix).encode() for reply in replies]

    def answer_in_order(self, data: bytes) -> Iterable[bytes]:
        """Answer on the first connection, where a STOP waits behind a request that is not answered yet."""
        if data.endswith(b";STOP\r") and self.owes:
            return []
        answers = list(self.answer(data))
        self.owes = not answers
        return answers

    def usual(self, command: str) -> Iterable[str]:
        match command.partition("="):
            case "OPEN", _, _:
                return [OPEN.format(copyright=self.copyright)]
            case "STATE", _, _:
                return [STATE.format(flags=self.flags)]
            case "JPOSF", _, _:
                return [JPOS.format(*self.at)]
            case "ERROR", _, _:
                return [f"Qok{self.alarm};2" if self.alarm else "QoK"]
            case "OVRD", "=", percent:
                self.override = percent
                return [f"QoK{percent}"]
            case "OVRD", _, _:
                return [f"QoK{self.override}"]
            case "EXECJCATSEY1", _, values:
                self.target = tuple(float(v) for v in values.strip("()").split(","))  # type: ignore[assignment]  # four numbers
            case "PNRMXTTOUT", _, _:
                return [f"QoKMXTTOUT;{self.mxttout};1"]
            case "EXEC2", _, _:
                self.arrive()
            case "EXECMOV JCATSEY1", _, _:
                self.arrive()
            case word, _, _ if word.startswith("RUN"):
                self.flags = "E0060"
        return ["Qok" if self.alarm else "QoK"]

    def hung_up(self) -> None:
        """Forget what the lost connection owes."""
        self.owes = False

    def halt(self) -> Iterable[str]:
        self.flags = "A0060"
        return ["QoK"]

    def arrive(self) -> None:
        if self.arrives:
            self.at = self.target


class Bench:
    """A driver with its two connections."""

    def __init__(self, controller: Controller, main: Peer, aside: Peer, **settings: Any) -> None:
        self.controller, self.main, self.aside = controller, main, aside
        self.clock = StepClock()
        self.robot = MelfaR3(
            main.transport,
            aside.transport,
            self.clock,
            MelfaSettings(**{**QUICK, **settings}),
            variable=VARIABLES[0],
        )

    @property
    def said(self) -> list[str]:
        """Commands on the first connection."""
        return [data.decode().strip().removeprefix("1;1;") for data in self.main.requests]

    @property
    def said_aside(self) -> list[str]:
        """Commands on the stop connection."""
        return [data.decode().strip().removeprefix("1;1;") for data in self.aside.requests]


async def lose_an_answer(bench: Bench) -> None:
    """Have the controller leave a request unanswered: the link heals before it is used again."""
    bench.controller.replies["RSTALRM"] = list
    with pytest.raises(LinkTimeoutError):
        await bench.robot.reset_alarm()


@asynccontextmanager
async def bench(
    controller: Controller | None = None, *, connect: bool = True, **settings: Any
) -> AsyncIterator[Bench]:
    """Run a controller with two connections, connect, close at the end."""
    controller = controller or Controller()
    async with (
        Peer(controller.answer_in_order, endpoint="memory://robot", on_hang_up=controller.hung_up) as main,
        Peer(controller.answer, endpoint="memory://stop") as aside,
    ):
        made = Bench(controller, main, aside, **settings)
        if connect:
            await made.robot.connect()
        yield made
        await made.robot.close()
