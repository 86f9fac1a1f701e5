"""What a cell file may set of a MELFA controller."""

from typing import Literal

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings


class MelfaSettings(DeviceSettings):
    """Settings of the R-protocol driver. Times are real seconds, except `poll_s`.

    Attributes:
        expected_model: beginning of the robot type that OPEN has to answer; empty accepts every MELFA arm.
        motion: `exec2` waits for the answer at the end of a motion; `exec` starts it and polls STATE, for
            controllers that do not know EXEC2 (sheet 1.9: CRn-500).
        robot_number: robot in the header of each request.
        slot: slot in the header of each request.
        client_name: what OPEN says who we are.
        terminator: end of a request; controllers take CR, CR LF and on TCP nothing at all.
        connect_timeout_s: for connecting.
        answer_timeout_s: for the answer to anything but a motion.
        move_timeout_s: for a whole motion.
        servo_timeout_s: for the servo to come on.
        stop_timeout_s: for the standstill after STOP.
        poll_s: pause between two polls of STATE, on the driver's clock.
        quiet_s: silence that ends an answer without terminator.
        tolerance_deg: how far J1, J2, J4 may be reported from the target; the protocol resolves 0.01.
        tolerance_mm: the same for J3.
    """

    expected_model: str = "RH-3FRH5515"
    motion: Literal["exec2", "exec"] = "exec2"
    robot_number: int = Field(default=1, ge=0, le=3)
    slot: int = Field(default=1, ge=-1, le=33)
    client_name: str = Field(default="CATSEYE", pattern=r"^[A-Z0-9]{1,16}$")
    terminator: Literal["", "\r", "\r\n"] = "\r"
    connect_timeout_s: float = Field(default=5.0, gt=0)
    answer_timeout_s: float = Field(default=2.0, gt=0)
    move_timeout_s: float = Field(default=120.0, gt=0)
    servo_timeout_s: float = Field(default=10.0, gt=0)
    stop_timeout_s: float = Field(default=5.0, gt=0)
    poll_s: float = Field(default=0.02, gt=0)
    quiet_s: float = Field(default=0.02, gt=0)
    tolerance_deg: float = Field(default=0.02, gt=0)
    tolerance_mm: float = Field(default=0.02, gt=0)
