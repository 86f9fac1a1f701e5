"""User and password of controllers that ask for them, typed before a command begins; nothing keeps them."""

import getpass
import os
import sys
from collections.abc import Callable, MutableMapping

from catseye.app.errors import UsageError
from catseye.drivers.roles.device import LoginVariables
from catseye.drivers.roles.registry import working_drivers

Ask = Callable[[str], str]


def logins() -> dict[str, LoginVariables]:
    """Return where the installed drivers look for user and password, by their names."""
    declared = {name: driver.login_variables for name, driver in working_drivers().items()}
    return {name: found for name, found in declared.items() if found is not None}


def ask_logins(
    environment: MutableMapping[str, str] = os.environ,
    ask_user: Ask = input,
    ask_password: Ask = getpass.getpass,
    *,
    at_terminal: bool | None = None,
) -> None:
    """Ask for user and password, and keep them where drivers look for them, for this process and those it starts.

    Return alone keeps the user that is known, and the password of that user.

    Args:
        environment: of this process.
        ask_user: shows what is typed.
        ask_password: does not.
        at_terminal: somebody is there; by default what stdin is.

    Raises:
        UsageError: nobody is there.
    """
    wanted = logins()
    if not (sys.stdin.isatty() if at_terminal is None else at_terminal):
        variables = ", ".join(name for one in wanted.values() for name in (one.user, one.password))
        raise UsageError(f"--login asks at a terminal, and there is none: set {variables} instead")
    for driver, variables_of in wanted.items():
        known = environment.get(variables_of.user, variables_of.factory_user)
        user = environment[variables_of.user] = ask_user(f"{driver}, user [{known}]: ").strip() or known
        hint = " [unchanged]" if user == known else ""
        typed = ask_password(f"{driver}, password of {user}{hint}: ")
        if typed or user != known:
            environment[variables_of.password] = typed
