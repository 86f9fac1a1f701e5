"""A robot controller without sockets for tests: clients talk to sessions, bench time passes on demand."""

from dataclasses import replace

from catseye.simulators.config import EmulationConfig
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.r_protocol import MelfaSession
from catseye.simulators.ports.session import Pending
from catseye.simulators.world.scara.arm import scara_bench
from tests.unit.simulators.benches import QUIET, perfect_arm, without_j4_play


class Desk:
    """A controller with any number of clients."""

    def __init__(self, config: EmulationConfig = QUIET, choices: Choices | None = None) -> None:
        config = without_j4_play(config)
        self.bench = scara_bench(perfect_arm(config), config)
        self.controller = Controller(self.bench, config, lambda: None, choices)
        self.heard: list[str] = []

    def client(self, suffix: str = "", *, segments: bool = True) -> "Talker":
        return Talker(self, MelfaSession(self.controller, suffix, self.heard.append, segments=segments))


class Talker:
    """One client."""

    def __init__(self, desk: Desk, session: MelfaSession) -> None:
        self.desk = desk
        self.session = session

    def send(self, data: bytes) -> list[bytes | Pending]:
        self.session.feed(data)
        return self.answers()

    def answers(self) -> list[bytes | Pending]:
        said: list[bytes | Pending] = []
        while (answer := self.session.answer()) is not None:
            said.append(answer)
        return said

    def ask(self, command: str) -> str:
        """Send a command and wait in bench time for its answer."""
        (answer,) = self.send(f"1;1;{command}\r".encode("latin-1"))
        return self.finish(answer)

    def do(self, *commands: str) -> None:
        """Send commands that have to be accepted."""
        for command in commands:
            answer = self.ask(command)
            assert answer.lower().startswith("qok"), f"{command}: {answer}"

    def finish(self, answer: bytes | Pending) -> str:
        if isinstance(answer, Pending):
            while (due_s := answer.due()) is not None:
                self.desk.bench.advance_to(due_s)
            answer = answer.reply()
        return answer.decode()

    def ready(self) -> "Talker":
        """Take the right, switch the servo on and wait for it."""
        assert self.ask("CNTLON") == "QoK"
        assert self.ask("SRVON") == "QoK"
        self.desk.bench.advance(1.0)
        return self


def with_axes(axes: int) -> EmulationConfig:
    """Return a bench whose controller reports that many axes."""
    return replace(QUIET, axis_pattern=axes)
