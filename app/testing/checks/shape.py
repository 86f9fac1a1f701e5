"""What can be seen of a driver without any device."""

import inspect
import re
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from catseye.app.testing.checks.check import Check
from catseye.app.testing.trial import Trial, expect
from catseye.drivers.roles.air import AirSensor
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.device import Role
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.interferometer import Interferometer
from catseye.drivers.roles.io import Io
from catseye.drivers.roles.robot import Robot
from catseye.drivers.roles.tracker import Tracker

_PROTOCOLS: Final[dict[Role, type[Any]]] = {
    "robot": Robot,
    "interferometer": Interferometer,
    "environment": AirSensor,
    "tracker": Tracker,
    "io": Io,
}

_UNITS = "s|ms|us|mm|um|nm|pm|m|deg|mdeg|rad|mm_s|deg_s|mm_s2|deg_s2|hz|khz|c|k|hpa|pa|kpa|percent|permille|ppm|v|a|w"
_WITH_UNIT = re.compile(rf"(?:^|_)(?:{_UNITS})$")
_WITHOUT_UNIT = re.compile(
    r"scale|factor|ratio|sign|index|gain|weight|count|coefficient|full_scale|smoothing"
)
"""Names of numbers that have no unit."""


async def at_makes_a_driver_and_opens_nothing(trial: Trial) -> None:
    """`at(endpoint, clock, sink=None, **settings)` is a classmethod and does not touch the device."""
    made_by = inspect.getattr_static(trial.candidate.driver, "at", None)
    expect(isinstance(made_by, classmethod), "the class has no classmethod `at`")
    first = list(inspect.signature(trial.candidate.driver.at).parameters)[:3]
    expect(
        first == ["endpoint", "clock", "sink"], f"at() begins with {first}, not with endpoint, clock, sink"
    )
    driver = trial.new_driver()
    expect(isinstance(driver, trial.candidate.driver), f"at() returned {driver!r}")
    expect(trial.connections == 0, "at() has opened a link: open it in connect()")


async def the_class_is_one_of_its_role(trial: Trial) -> None:
    """The class subclasses its role, implements all that the role requires, and has a summary for the wizard."""
    driver, role = trial.candidate.driver, _PROTOCOLS[trial.candidate.role]
    expect(role in driver.__mro__, f"the class does not subclass {role.__module__}.{role.__name__}")
    missing = sorted(driver.__abstractmethods__)
    expect(not missing, f"the role {trial.candidate.role} requires {', '.join(missing)} too")
    expect(
        isinstance(driver.summary, str) and bool(driver.summary), "summary has to say maker, model and link"
    )


async def settings_are_a_strict_closed_model(trial: Trial) -> None:
    """`Settings` is a pydantic model that takes no unknown key and converts no type."""
    model: object = trial.candidate.driver.Settings
    expect(
        isinstance(model, type) and issubclass(model, BaseModel), "the class has no pydantic model `Settings`"
    )
    config = _settings(trial).model_config
    expect(config.get("extra") == "forbid", 'Settings accepts unknown keys: set extra="forbid"')
    expect(bool(config.get("strict")), "Settings converts types, so that '1' is taken for 1: set strict=True")


async def settings_are_described_with_units(trial: Trial) -> None:
    """Each setting has a description for the wizard; the name of a quantity ends in its unit."""
    for name, field in _settings(trial).model_fields.items():
        expect(bool(field.description), f"setting {name!r}: describe it with Field(description=…)")
        expect(
            field.annotation is not float or _has_unit(name), f"setting {name!r}: end the name in its unit"
        )


async def an_unknown_setting_is_refused(trial: Trial) -> None:
    """`at` refuses a setting that it does not know, so that a slip of the pen shows."""
    at = trial.candidate.driver.at
    try:
        at("tcp://127.0.0.1:9", SystemClock(), **_doors(trial), no_such_setting=1)
    except (TypeError, ValidationError, DeviceError):
        return
    expect(False, "at(..., no_such_setting=1) was accepted: hand the settings to Settings(**settings)")


async def a_wrong_endpoint_is_reported(trial: Trial) -> None:
    """`at` answers an endpoint that is none with a DeviceError that shows it."""
    try:
        trial.new_driver("carrier-pigeon://loft")
    except DeviceError as error:
        expect("carrier-pigeon" in str(error), f"the text does not show the endpoint: {error}")
        return
    expect(False, "at('carrier-pigeon://loft', ...) was accepted")


async def methods_are_coroutines_with_docstrings(trial: Trial) -> None:
    """The methods of the role are coroutines and, as all public ones, say what they do."""
    driver, role = trial.candidate.driver, _PROTOCOLS[trial.candidate.role]
    for name, member in inspect.getmembers(driver, inspect.isroutine):
        if inspect.iscoroutinefunction(vars(role).get(name)):
            expect(inspect.iscoroutinefunction(member), f"{name} has to be a coroutine method (async def)")
        if name.startswith("_"):
            continue
        line = (inspect.getdoc(member) or "").split("\n")[0]
        expect(line.endswith("."), f"{name}: begin its docstring with a sentence that ends in a full stop")


async def arguments_carry_units(trial: Trial) -> None:
    """The name of an argument that is a quantity ends in its unit."""
    for name, member in inspect.getmembers(trial.candidate.driver, inspect.isroutine):
        if name.startswith("_"):
            continue
        # A role has its own reasons: the unit of an increment is that of its axis.
        of_role = getattr(_PROTOCOLS[trial.candidate.role], name, None)
        named = set() if of_role is None else set(inspect.signature(of_role).parameters)
        for argument in inspect.signature(member).parameters.values():
            plain = argument.annotation not in {float, "float"} or argument.name in named
            expect(plain or _has_unit(argument.name), f"{name}({argument.name}): end the name in its unit")


def _settings(trial: Trial) -> type[BaseModel]:
    model: Any = trial.candidate.driver.Settings
    checked: type[BaseModel] = model
    return checked


def _doors(trial: Trial) -> dict[str, str]:
    return {name: value for name, value in trial.endpoints.items() if name != "endpoint"}


def _has_unit(name: str) -> bool:
    return bool(_WITH_UNIT.search(name) or _WITHOUT_UNIT.search(name))


CHECKS = (
    Check(the_class_is_one_of_its_role),
    Check(at_makes_a_driver_and_opens_nothing),
    Check(settings_are_a_strict_closed_model),
    Check(settings_are_described_with_units),
    Check(an_unknown_setting_is_refused),
    Check(a_wrong_endpoint_is_reported),
    Check(methods_are_coroutines_with_docstrings),
    Check(arguments_carry_units),
)
