"""A screen that looks at files again and again while it is shown."""

from abc import abstractmethod
from typing import ClassVar

from textual.timer import Timer

from catseye.app.tui.screens.working import WorkScreen
from catseye.app.tui.session import Session


class LookingScreen(WorkScreen):
    """A screen that rests while nobody sees it.

    Attributes:
        look_s: between two looks.
        looking: a look is under way.
    """

    look_s: ClassVar[float]

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.looking = False
        self._timer: Timer | None = None

    @abstractmethod
    async def look_once(self) -> None:
        """Look; set `looking` back when the files are read."""

    def on_mount(self) -> None:
        """Look again and again."""
        self._timer = self.set_interval(self.look_s, self._look)

    def on_screen_resume(self) -> None:
        """Look at once."""
        if self._timer is not None:
            self._timer.resume()
        self._look()

    def on_screen_suspend(self) -> None:
        """Do not look while nobody sees it."""
        if self._timer is not None:
            self._timer.pause()

    def _look(self) -> None:
        if not self.looking:
            self.looking = True
            self.spawn(self.look_once, "look")
