"""What a cell file may set of a MELFA controller."""

from typing import Literal

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings
from catseye.drivers.roles.pose import SAME_PLACE


class MelfaSettings(DeviceSettings):
    """Settings of the R-protocol driver. Times are real seconds, except `poll_s`."""

    expected_model: str = Field(
        default="RH-3FRH5515",
        description="beginning of the robot type that OPEN has to answer; empty accepts every MELFA arm.",
    )
    motion: Literal["exec2", "exec"] = Field(
        default="exec2",
        description="`exec2` waits for the answer at the end of a motion; `exec` starts it and polls STATE, for "
        "controllers that do not know EXEC2 (sheet 1.9: CRn-500).",
    )
    robot_number: int = Field(default=1, ge=0, le=3, description="robot in the header of each request.")
    slot: int = Field(default=1, ge=-1, le=33, description="slot in the header of each request.")
    client_name: str = Field(
        default="CATSEYE", pattern=r"^[A-Z0-9]{1,16}$", description="what OPEN says who we are."
    )
    terminator: Literal["", "\r", "\r\n"] = Field(
        default="\r", description="end of a request; controllers take CR, CR LF and on TCP nothing at all."
    )
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    answer_timeout_s: float = Field(default=2.0, gt=0, description="for the answer to anything but a motion.")
    move_timeout_s: float = Field(default=120.0, gt=0, description="for a whole motion.")
    servo_timeout_s: float = Field(default=10.0, gt=0, description="for the servo to come on.")
    stop_timeout_s: float = Field(default=5.0, gt=0, description="for the standstill after STOP.")
    poll_s: float = Field(
        default=0.02, gt=0, description="pause between two polls of STATE, on the driver's clock."
    )
    quiet_s: float = Field(default=0.02, gt=0, description="silence that ends an answer without terminator.")
    tolerance_deg: float = Field(
        default=0.02,
        gt=0,
        le=SAME_PLACE,
        description="how far J1, J2, J4 may be reported from the target; the protocol resolves 0.01. From "
        f"{SAME_PLACE:g} on, an arm counts as moved by somebody else.",
    )
    tolerance_mm: float = Field(default=0.02, gt=0, le=SAME_PLACE, description="the same for J3.")
