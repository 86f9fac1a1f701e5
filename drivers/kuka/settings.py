"""What a cell file may set of a KUKA controller."""

from typing import Literal

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings

_NAME = r"^(\$?[A-Z_][A-Z0-9_]*(\[\])?)?$"


class KukaSettings(DeviceSettings):
    """Settings of the KUKAVARPROXY driver. Times are real seconds, except `poll_s`."""

    expected_model: str = Field(
        default="",
        description="beginning of $MODEL_NAME[], without its #; empty accepts every robot.",
    )
    encoding: Literal["ascii", "utf-16"] = Field(
        default="ascii",
        description="of single variables: every proxy knows ascii (types 0 and 1), C3 Bridge utf-16 too (4 and 5).",
    )
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    answer_timeout_s: float = Field(
        default=0.5,
        gt=0,
        description="for one answer of the proxy; 5 to 15 ms are typical. An arm that moves is stopped where nothing "
        "is seen of it for this and 1 s more.",
    )
    taken_timeout_s: float = Field(
        default=5.0,
        gt=0,
        description="for CATSKUKA to take an order, which needs a cycle of the controller; then the order is taken "
        "back. A program that stands is found at once.",
    )
    move_timeout_s: float = Field(default=600.0, gt=0, description="for a whole motion.")
    stop_timeout_s: float = Field(default=5.0, gt=0, description="for the standstill after STOP.")
    heartbeat_s: float = Field(
        default=0.1,
        gt=0,
        le=0.25,
        description="between two heartbeats; the program stops the arm 0.5 s after the last.",
    )
    poll_s: float = Field(
        default=0.02, gt=0, description="pause between two looks at a motion, on the driver's clock."
    )
    tolerance_deg: float = Field(
        default=0.02, gt=0, description="how far an axis may be read back from the target of a motion."
    )
    drives_variable: str = Field(
        default="$PERI_RDY",
        pattern=_NAME,
        description="BOOL that is TRUE while the drives are ready; empty where the controller has none.",
    )
    emergency_stop_variable: str = Field(
        default="$ALARM_STOP",
        pattern=_NAME,
        description="BOOL that is FALSE while an emergency stop is active; empty where the controller has none.",
    )
    message_variable: str = Field(
        default="$STOPMESS",
        pattern=_NAME,
        description="BOOL that is TRUE while a message keeps programs from running; empty for none.",
    )
