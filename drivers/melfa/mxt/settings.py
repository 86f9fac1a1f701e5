"""What a cell file may set of real-time control."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from catseye.drivers.melfa.settings import MelfaSettings

Speed = Annotated[float, Field(gt=0)]


class MxtSettings(MelfaSettings):
    """Settings of the MXT driver, on top of those of the R-protocol. Times are real seconds unless said otherwise."""

    program: str = Field(
        default="CATSMXT",
        pattern=r"^[A-Z0-9]{0,12}$",
        description="name of the program to start again after a stop; empty leaves that to the operator.",
    )
    mxt_cycle_ms: float = Field(
        default=7.1,
        ge=1.0,
        le=100.0,
        description="cycle of the controller: 7.1 (CR750, CR751, CR800-Q) or 3.5 (CR800-R, CR800-D).",
    )
    mxt_timeout_s: float = Field(
        default=0.5,
        ge=-1.0,
        description="how long the controller is to wait for a set point (parameter MXTTOUT); -1 for ever. The "
        "parameter itself is read before the first motion: for ever, or longer than 0.5 s, moves no real "
        "arm.",
    )
    mxt_timeout_unit_ms: float | None = Field(
        default=None,
        gt=0,
        description="what MXTTOUT counts in, ms. The sheet does not say; by default cycles of the controller, in "
        "which the controller counts its time without reception (TCount).",
    )
    reply_timeout_s: float = Field(default=0.1, gt=0, description="for the answer to one set point.")
    most_lost: int = Field(
        default=5, ge=0, description="so many answers in a row may be lost before the arm is stopped."
    )
    arrival_timeout_s: float = Field(
        default=5.0, gt=0, description="for the arm to come to rest at the last set point."
    )
    follow_speed_deg_s: float = Field(
        default=20.0, gt=0, description="fastest J1, J2, J4 on a way; the override bounds it further."
    )
    follow_acceleration_deg_s2: float = Field(default=200.0, gt=0, description="their largest acceleration.")
    follow_speed_mm_s: float = Field(default=50.0, gt=0, description="fastest J3 on a way.")
    follow_acceleration_mm_s2: float = Field(default=500.0, gt=0, description="its largest acceleration.")
    most_lead_ms: float = Field(
        default=3.0,
        ge=0.0,
        le=10.0,
        description="largest difference between the lags of two joints that the set points make up for; when the "
        "arm shows a larger one nothing is made up for, and a note says so. 0 sends every joint its set point at the "
        "same time.",
    )
    full_speed: tuple[Speed, Speed, Speed, Speed] = Field(
        default=(420.0, 720.0, 1100.0, 3000.0),
        description="speeds at 100 % override, J1 deg/s, J2 deg/s, J3 mm/s, J4 deg/s; the sheet has them from memory "
        "of a catalogue (5.1).",
    )

    @property
    def timeout_unit_s(self) -> float:
        """What MXTTOUT counts in, s."""
        return (self.mxt_timeout_unit_ms or self.mxt_cycle_ms) / 1e3

    @model_validator(mode="after")
    def _patience(self) -> Self:
        if 0.0 <= self.mxt_timeout_s <= self.reply_timeout_s:
            raise ValueError(
                f"reply_timeout_s = {self.reply_timeout_s:g} has to be below mxt_timeout_s = {self.mxt_timeout_s:g}: "
                "one lost answer would be an alarm of the controller"
            )
        return self
