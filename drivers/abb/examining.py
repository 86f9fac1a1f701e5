"""What an ABB controller says beyond its state, for `catseye doctor`."""

from typing import Final

from catseye.drivers.abb import names
from catseye.drivers.abb.digest import Login
from catseye.drivers.abb.orders import START, Orders
from catseye.drivers.abb.service import Service
from catseye.drivers.abb.settings import PASSWORD_VARIABLE, USER_VARIABLE, AbbSettings, is_factory
from catseye.drivers.abb.values import number_of, states_of
from catseye.drivers.roles.device import Examination
from catseye.drivers.roles.errors import ProtocolError, RefusedError

UNKNOWN: Final = (
    "not known for certain, see docs/abb.md: whether joints are measured or commanded ones, how long proofs and "
    "sessions last, how many requests a connection takes"
)


async def system_of(service: Service) -> tuple[str, str]:
    """Return name and version of the system; empty where the controller does not say.

    Raises:
        LinkError: lost or silent.
    """
    try:
        states = states_of(await service.ask(names.SYSTEM))
    except (RefusedError, ProtocolError):
        return "", ""
    fields = {key: value for state in reversed(states) for key, value in state.items()}
    return str(fields.get("name", "")), str(fields.get("rwversion", ""))


async def examination_of(
    service: Service, orders: Orders, settings: AbbSettings, login: Login
) -> Examination:
    """Return facts and advice about a connected controller.

    Raises:
        LinkError: lost or silent.
        ProtocolError: garbage came.
    """
    facts, advice = [UNKNOWN], []
    try:
        version = await service.value(names.data(settings.task, names.VERSION), "value")
    except RefusedError:
        advice.append(f"CATSABB is not loaded in {settings.task}: load CATSABB.mod there, see docs/abb.md")
    else:
        facts.append(f"CATSABB: version {version}")
        if number_of(version) != names.MODULE_VERSION:
            advice.append(f"CATSABB has version {version}, expected {names.MODULE_VERSION}: load it again")
        elif not await orders.main_is_ours():
            advice.append(
                f"the controller does not say that main is that of CATSABB: no motion starts it; {START}"
            )
    if number_of(await service.value(names.SPEED_RATIO, "speedratio")) == 0:
        advice.append("the speed ratio is 0: a motion would not end; raise it at the pendant")
    if is_factory(login):
        facts.append(
            "user and password are those of the factory, which everybody knows: better give catseye a user "
            f"of its own ({USER_VARIABLE}, {PASSWORD_VARIABLE})"
        )
    return Examination(tuple(facts), tuple(advice))
