"""What a cell file may set of an ABB controller; user and password stand in the environment."""

import os
from collections.abc import Mapping
from typing import Final

from pydantic import Field

from catseye.drivers.abb.digest import Login
from catseye.drivers.links.driver import DeviceSettings

USER_VARIABLE: Final = "CATSEYE_ABB_USER"
PASSWORD_VARIABLE: Final = "CATSEYE_ABB_PASSWORD"
FACTORY: Final = Login("Default User", "robotics")
"""What every IRC5 leaves the factory with."""


class AbbSettings(DeviceSettings):
    """Settings of the driver. Times are real seconds, except `poll_s`."""

    expected_model: str = Field(
        default="", description="beginning of the system's name; empty accepts every controller."
    )
    task: str = Field(
        default="T_ROB1", pattern=r"^\w+$", description="RAPID task in which CATSABB is loaded."
    )
    mechanical_unit: str = Field(default="ROB_1", pattern=r"^\w+$", description="of the arm.")
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    answer_timeout_s: float = Field(
        default=1.0,
        gt=0,
        description="for one answer; an arm that moves is stopped where nothing is seen of it for this and 1 s more.",
    )
    taken_timeout_s: float = Field(
        default=5.0,
        gt=0,
        description="for CATSABB to take an order; then the order is taken back. A program that stands is found at "
        "once.",
    )
    start_timeout_s: float = Field(default=5.0, gt=0, description="for CATSABB to run after its start.")
    servo_timeout_s: float = Field(default=10.0, gt=0, description="for the motors to be switched.")
    move_timeout_s: float = Field(default=600.0, gt=0, description="for a whole motion.")
    stop_timeout_s: float = Field(default=5.0, gt=0, description="for the standstill after STOP.")
    heartbeat_s: float = Field(
        default=0.1,
        gt=0,
        le=0.2,
        description="between two heartbeats; CATSABB stops the arm 0.4 to 0.5 s after the last.",
    )
    renewal_s: float = Field(
        default=2.0,
        gt=0,
        le=30.0,
        description="how often the proof with which STOP is encoded is renewed while the arm moves.",
    )
    poll_s: float = Field(
        default=0.02, gt=0, description="pause between two looks at a motion, on the driver's clock."
    )
    tolerance_deg: float = Field(
        default=0.1,
        gt=0,
        description="how far a joint may be read back from the target of a motion; controllers of arms that stand "
        "read back up to 0.05 beside it.",
    )


def login_of(environment: Mapping[str, str] = os.environ) -> Login:
    """Return user and password: the environment's, and the factory's where it has none."""
    return Login(
        environment.get(USER_VARIABLE, FACTORY.user), environment.get(PASSWORD_VARIABLE, FACTORY.password)
    )


def is_factory(login: Login) -> bool:
    """Return whether everybody knows this password."""
    return (login.user, login.password) == (FACTORY.user, FACTORY.password)
