"""[tracker] and [ballbar] of the cell file: instruments that say where the targets of an arm's tool are."""

from typing import Annotated, Any, Final, Self

from pydantic import Field, field_validator, model_validator

from catseye.app.cell.arm import Triple
from catseye.app.cell.endpoints import checked_endpoint
from catseye.app.cell.section import Finite, Name, NotNegative, Positive, Section, require_own_names
from catseye.drivers.roles.tracker import on_a_line

_FRAME: Final = 3
"""Nests that make the world frame."""

Degrees = Annotated[float, Field(gt=0.0, le=90.0, allow_inf_nan=False)]


class Nest(Section):
    """[[tracker.nest]]: a nest that stays where it is; three of them make the world frame."""

    name: Name
    # In the instrument's frame, roughly: it turns there and searches.
    x_mm: Finite
    y_mm: Finite
    z_mm: Finite


class Tracker(Section):
    """[tracker]: a laser tracker or an optical CMM; by default the one of the emulated bench."""

    driver: str = "bench-tracker"
    endpoint: str
    settings: dict[str, Any] = Field(default_factory=dict)
    # Control port of the bench of an emulated instrument, for hands; that of a bench-tracker is its endpoint.
    control: str | None = None
    # The arm's base in the instrument's frame, R = Rz Ry Rx, roughly: what is seen from where follows from it.
    base_mm: Triple | None = None
    base_deg: Triple | None = None
    # A nest returns the beam of a tracker that comes within this of its normal; a face that of an optical CMM.
    cone_deg: Degrees = 30.0
    face_deg: Degrees = 15.0
    nest: list[Nest] = Field(default_factory=list)

    @field_validator("endpoint")
    @classmethod
    def _endpoint_or_file(cls, text: str) -> str:
        """A tracker is the only device that may be a file: its own program writes it."""
        return text if text.startswith("file:") else checked_endpoint(text)

    @field_validator("control")
    @classmethod
    def _control_is_an_endpoint(cls, text: str | None) -> str | None:
        return None if text is None else checked_endpoint(text)

    @model_validator(mode="after")
    def _unique_nests(self) -> Self:
        require_own_names("[[tracker.nest]]", [nest.name for nest in self.nest])
        return self

    @model_validator(mode="after")
    def _nests_span_a_frame(self) -> Self:
        if len(self.nest) >= _FRAME:
            first, second, third = [(nest.x_mm, nest.y_mm, nest.z_mm) for nest in self.nest[:_FRAME]]
            if on_a_line(first, second, third):
                names = ", ".join(nest.name for nest in self.nest[:_FRAME])
                raise ValueError(
                    f"the nests {names} lie on a line and make no frame; state where they are, or put one aside"
                )
        return self


class Ballbar(Section):
    """[ballbar]: a telescopic ballbar between a nest of the tool and a fixed cup."""

    length_mm: Positive = 300.0
    range_mm: Positive = 1.0
    u_length_mm: NotNegative = 0.001
    # The fixed cup in the frame of the arm's base; a calibrated arm finds out more exactly.
    centre_mm: Triple
    # Of its body; ASSUMED, since no maker's figure is known: measure the thickest part.
    radius_mm: Positive = 15.0
