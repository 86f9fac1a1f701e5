"""User and password of a controller, asked for before an engine is started that needs them; nothing keeps them.

They stand in the environment of this process, which the engine inherits: in no file, record, log or screenshot.
"""

import asyncio
import os
from collections.abc import Awaitable, Callable, MutableMapping
from pathlib import Path
from typing import Final

from catseye.app.errors import ConfigError, UsageError
from catseye.app.tui.dialogs.form_dialog import Answers, Field, FormDialog

USER: Final = "user"
PASSWORD: Final = "password"

Show = Callable[[FormDialog], Awaitable[Answers | None]]
"""Shows a dialog and returns its answers."""


class Login:
    """Asks once for what the cell's controller wants and the environment does not have.

    Args:
        environment: of this process.

    Attributes:
        show: shows the dialog; nobody is asked without it.
    """

    def __init__(self, environment: MutableMapping[str, str] = os.environ) -> None:
        self.show: Show | None = None
        self._environment = environment
        self._asked: set[Path] = set()

    async def before_engine(self, cell: Path) -> None:
        """Ask, if an engine of this cell would lack user and password; going back leaves those of the factory."""
        if self.show is None or cell in self._asked:
            return
        found = await asyncio.to_thread(_wanted, cell)
        if found is None:
            return
        driver, endpoint, user_variable, password_variable, factory_user = found
        if password_variable in self._environment:
            return
        self._asked.add(cell)
        known = self._environment.get(user_variable, factory_user)
        answers = await self.show(_dialog(driver, endpoint, known))
        if answers is None:
            return
        user = answers[USER] or known
        # An empty password would stand before that of the factory, which the driver knows.
        if answers[PASSWORD] or user != known:
            self._environment[user_variable] = user
            self._environment[password_variable] = answers[PASSWORD]

    async def forget(self, cell: Path) -> None:
        """Have the next engine of this cell ask again: user and password were wrong."""
        self._asked.discard(cell)
        found = await asyncio.to_thread(_wanted, cell)
        for variable in () if found is None else found[2:4]:
            self._environment.pop(variable, None)


def _dialog(driver: str, endpoint: str, user: str) -> FormDialog:
    return FormDialog(
        "Log in to the controller",
        [Field(USER, "User", user), Field(PASSWORD, "Password", "", secret=True)],
        f"{driver} at {endpoint} asks for user and password. They are kept for this session only, in no file; "
        "Escape goes on with those of the factory.",
    )


def _wanted(cell: Path) -> tuple[str, str, str, str, str] | None:
    """Return driver, endpoint, variables and the factory's user of a controller that asks; None where none does.

    Emulators take the factory's, so nobody is asked for them.
    """
    from catseye.app.cell.hands import robot_is_emulated
    from catseye.app.cell.load import load_cell
    from catseye.drivers.roles.registry import load_driver

    try:
        known = load_cell(cell).cell
        robot, emulated = known.robot, robot_is_emulated(known)
        variables = load_driver(robot.driver).login_variables
    except (ConfigError, UsageError, LookupError):
        # The engine says what is wrong.
        return None
    if variables is None or emulated:
        return None
    return robot.driver, robot.endpoint, variables.user, variables.password, variables.factory_user
