"""Door interlock and stack light of a cell."""

import asyncio
from collections.abc import Callable
from typing import Final

from catseye.app.engine.waiting import cancel
from catseye.app.protocol.run_events import PromptAnswered, PromptAsked, RunEvent, StateChanged
from catseye.app.protocol.state import ControlState
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.io import Io, Light

_LIGHTS: dict[ControlState, Light] = {
    ControlState.EXECUTE: "green",
    ControlState.UNHOLDING: "green",
    ControlState.HOLDING: "amber",
    ControlState.HELD: "amber",
    ControlState.SUSPENDED: "amber",
    ControlState.SUSPENDING: "amber",
    ControlState.UNSUSPENDING: "amber",
    ControlState.STOPPING: "red",
    ControlState.ABORTING: "red",
    ControlState.ABORTED: "red",
    ControlState.CLEARING: "red",
    ControlState.STOPPED: "red",
}
"""States that do not stand here show nothing."""


NO_DOOR: Final = (
    "no door is watched: the cell file has no [io], so nothing stops the arm when somebody comes near it; wire the "
    "door into the controller's own safety circuit, and add [io]"
)


class StackLight:
    """Shows a run's state; always behind it, never in its way.

    Args:
        on_trouble: called once when the block stops taking orders.
    """

    def __init__(self, io: Io, on_trouble: Callable[[str], None]) -> None:
        self._io = io
        self._on_trouble = on_trouble
        self._state: Light = "off"
        self._asking = False
        self._changed = asyncio.Event()
        self._failed = False
        self._ending = False
        self._task = asyncio.get_running_loop().create_task(self._follow())

    def take(self, event: RunEvent) -> None:
        """Take note of an event of the run."""
        match event:
            case StateChanged(state=state):
                self._state = _LIGHTS.get(state, "off")
            case PromptAsked():
                self._asking = True
            case PromptAnswered():
                self._asking = False
            case _:
                return
        self._changed.set()

    async def end(self) -> None:
        """Put all lamps out and let go of the block."""
        self._ending = True
        await cancel(self._task)
        await self._show("off")

    async def _follow(self) -> None:
        # A cancellation that comes together with an answer may be lost on its way through a library.
        while not self._ending:
            await self._changed.wait()
            self._changed.clear()
            waiting = self._asking and self._state == "green"
            await self._show("amber" if waiting else self._state)

    async def _show(self, light: Light) -> None:
        try:
            await self._io.show(light)
        except DeviceError as error:
            if not self._failed:
                self._failed = True
                self._on_trouble(f"the stack light does not take orders: {error}")
        else:
            self._failed = False
