"""What a cell file may set of a Leica tracker."""

from typing import Self

from pydantic import Field, model_validator

from catseye.drivers.links.driver import DeviceSettings


class LeicaSettings(DeviceSettings):
    """What a cell file may set. Times are real seconds, but for `plane_dwell_s`."""

    reflector: str | None = Field(
        default=None, description="name of the reflector as the tracker lists it; None keeps the one in use."
    )
    temperature_c: float | None = Field(
        default=None,
        description="of the air, for a tracker without weather station; with both others, or none.",
    )
    pressure_hpa: float | None = Field(default=None, description="of the air; see temperature_c.")
    humidity_percent: float | None = Field(default=None, description="of the air; see temperature_c.")
    search_radius_mm: float = Field(
        default=25.0,
        gt=0,
        description="around the place where a target is expected: half the distance of two targets at most.",
    )
    search_timeout_s: float = Field(default=10.0, gt=0, description="for the search of a target.")
    find_distance_mm: float = Field(
        default=3000.0,
        gt=0,
        description="of a target that is searched for without a place where it is expected.",
    )
    home_radius_mm: float = Field(
        default=500.0,
        ge=0,
        description="around the tracker: what is seen in it without an expected place is its home position, whose "
        "place is not documented; 0 takes everything for a target.",
    )
    u_mm: float | None = Field(
        default=None,
        gt=0,
        description="standard uncertainty of a coordinate beside the scatter of the readings, where the tracker "
        "states none.",
    )
    covariances: bool = Field(
        default=True,
        description="have the tracker state covariances of the coordinates; false where it states impossible ones.",
    )
    plane_dwell_s: float = Field(
        default=1.0, gt=0, description="over which a place in the plane is averaged, s of the clock."
    )
    initialise_timeout_s: float = Field(default=180.0, gt=0, description="for the tracker's initialisation.")
    move_timeout_s: float = Field(
        default=20.0, gt=0, description="for pointing at a place, and for the other face."
    )
    measure_timeout_s: float = Field(default=10.0, gt=0, description="for a result, beyond the dwell.")
    busy_timeout_s: float = Field(
        default=10.0, gt=0, description="for a tracker that is busy with somebody else's command."
    )
    timeout_s: float = Field(default=2.0, gt=0, description="for a reply.")
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    quiet_s: float = Field(default=0.02, gt=0, description="silence after which a link counts as drained.")

    @property
    def air(self) -> tuple[float, float, float] | None:
        """Temperature, °C, pressure, hPa, and humidity, %; None where the tracker knows them by itself."""
        values = (self.temperature_c, self.pressure_hpa, self.humidity_percent)
        return None if None in values else (values[0] or 0.0, values[1] or 0.0, values[2] or 0.0)

    @model_validator(mode="after")
    def _whole_air(self) -> Self:
        given = [
            value is not None for value in (self.temperature_c, self.pressure_hpa, self.humidity_percent)
        ]
        if any(given) and not all(given):
            raise ValueError(
                "state temperature_c, pressure_hpa and humidity_percent together, or none of them"
            )
        return self
