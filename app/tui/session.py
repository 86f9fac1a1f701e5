"""What every screen needs: the engine, commands, and where things are."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from catseye.app.service.command_process import Work
from catseye.app.tui.link import Link
from catseye.app.tui.login import Login
from catseye.app.tui.pictures import Painter, PaintingProcess

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import Rehearsal

DEMO_FOLDER: Final = Path("catseye-demo")
"""Where the demo writes, in the present folder."""

EMULATED_BENCH: Final = "emulated-bench"
EMULATED_ARM: Final = "emulated-arm"
EMULATED_TRACKER: Final = "emulated-tracker"
"""Name of a cell that was written for emulators of this program, and of its file."""


@dataclass
class Session:
    """The surroundings of the screens.

    Attributes:
        link: to the engine.
        work: runs commands of `catseye`.
        root: folder of all runs.
        cell: cell file; None until there is one.
        now_s: monotonic time, s.
        own_speed: bench seconds in one real second that this program was started for; above 1 for emulators only.
        wanted: result that the screen Results shows when it comes up next.
        painter: draws the pictures of runs.
        campaign: file whose stages are the day's; None for the whole way of the cell.
        job: of that campaign; empty: any run of the cell counts.
        begun: rehearsal of the run that this client has begun, for the screen that shows it; None where it has none.
        login: asks for what a controller wants before an engine is started.
        rehearse_after_s: what is chosen is rehearsed after so long without another choice; None: only when asked for.
        under_way: titles of the commands that work; quitting ends them.
    """

    link: Link
    work: Work
    root: Path
    cell: Path | None
    now_s: Callable[[], float]
    own_speed: float = 1.0
    rehearse_after_s: float | None = 0.8
    under_way: list[str] = field(default_factory=list)
    wanted: Path | None = None
    painter: Painter = field(default_factory=PaintingProcess)
    login: Login = field(default_factory=Login)
    campaign: Path | None = None
    job: str = ""
    begun: "Rehearsal | None" = None

    @property
    def speed(self) -> float:
        """Bench seconds in one real second: that of the engine's own emulators, where it has some."""
        emulated = self.link.engine.emulated_speed
        return self.own_speed if emulated is None else emulated

    @contextmanager
    def at_work(self, title: str) -> Iterator[None]:
        """Know of a command that works meanwhile."""
        self.under_way.append(title)
        try:
            yield
        finally:
            self.under_way.remove(title)

    async def take_free_control(self) -> None:
        """Take control unless somebody has it.

        Raises:
            RefusedError: somebody was faster.
            ServiceError: there is no connection.
        """
        from catseye.app.protocol.requests import Control

        if self.link.engine.control is None:
            await self.link.request(Control())
