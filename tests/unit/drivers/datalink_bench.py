"""A data link driver with a scripted controller and program at its other end."""

from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager
from dataclasses import dataclass

from catseye.drivers.links.guarding import Unguarded
from catseye.drivers.melfa.datalink.robot import DatalinkSettings, MelfaDatalink
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.pose import Pose
from tests.unit.drivers.melfa_bench import Controller
from tests.unit.drivers.peers import Peer, StepClock

WAY: tuple[Pose, ...] = ((1.0, 2.0, 5.0, -3.0), (2.0, 4.0, 5.0, -6.5), (3.0, 6.0, 5.0, -10.0))
QUICK = {"quiet_s": 0.001, "answer_timeout_s": 0.2}


class Program:
    """The data link program: six numbers and a CR both ways (sheet, section 4)."""

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        self.version = "1"
        self.form = "{:.3f}"
        self.points: list[tuple[float, ...]] = []
        self.driven: list[tuple[float, ...]] = []
        self.requests: list[tuple[int, int]] = []
        self.silent: set[int] = set()
        self.moves = True
        self.replies: dict[int, Callable[[int], str]] = {}

    def answer(self, data: bytes) -> Iterable[bytes]:
        """Answer a record."""
        assert data.endswith(b"\r")
        number, command, *values = (float(field) for field in data.split(b","))
        assert len(values) == 4
        self.requests.append((int(number), int(command)))
        usual = self.usual(int(number), int(command), tuple(values))
        if command in self.silent:
            return []
        reply = self.replies.get(int(command))
        return [(reply(int(number)) if reply else usual).encode() + b"\r"]

    def usual(self, number: int, command: int, values: tuple[float, ...]) -> str:
        """Do what the program does."""
        answered: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
        match command:
            case 1:
                self.points.append(values)
                answered = (len(self.points), 0.0, 0.0, 0.0)
            case 2:
                self.driven, self.points = self.points, []
                if self.moves:
                    self.controller.at = self.driven[-1]
                answered = self.controller.at
            case 3:
                answered = self.controller.at
            case 4:
                self.points = []
            case 5:
                return f"{number},5,{self.version},4,0,0"
            case 6:
                answered = values
        return f"{number},{command}," + ",".join(self.form.format(value) for value in answered)


@dataclass
class Linked:
    """A data link driver with what stands at its other end."""

    robot: MelfaDatalink
    controller: Controller
    program: Program
    main: Peer
    aside: Peer
    datalink: Peer


@asynccontextmanager
async def linked(
    flags: str = "E0060", guard: Unguarded | None = None, **settings: object
) -> AsyncIterator[Linked]:
    """Connect a data link driver to a scripted controller and program."""
    controller = Controller()
    controller.flags = flags
    controller.replies["STOP"] = controller.halt
    program = Program(controller)
    async with (
        Peer(controller.answer) as main,
        Peer(controller.answer) as aside,
        Peer(program.answer) as link,
    ):
        checked = DatalinkSettings.model_validate({**QUICK, "move_timeout_s": 0.3, **settings})
        r3 = MelfaR3(main.transport, aside.transport, StepClock(), MelfaSettings.model_validate(QUICK))
        r3._guard = guard or r3._guard  # noqa: SLF001  # a pipe in memory has no descriptor to hand over
        robot = MelfaDatalink(r3, link.transport, checked)
        try:
            await robot.connect()
            yield Linked(robot, controller, program, main, aside, link)
        finally:
            await robot.close()
