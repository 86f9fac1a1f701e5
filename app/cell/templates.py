"""The cell files to begin with, one for each system."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

from catseye.app.cell.resolution import template as resolution
from catseye.app.cell.scara import template as scara
from catseye.app.cell.six_axis import template as six_axis


@dataclass(frozen=True)
class Template:
    """A cell file to begin with.

    Attributes:
        title: what the system measures, for people.
        by_arm: texts of the file by arm; the first is the one that is meant where none is named.
    """

    title: str
    by_arm: Mapping[str, str]

    @property
    def text(self) -> str:
        """The text of the file where no arm is named."""
        return next(iter(self.by_arm.values()))


SCARA: Final = "scara"
RESOLUTION: Final = "resolution"
SIX_AXIS: Final = "six-axis"

TEMPLATES: Final[Mapping[str, Template]] = MappingProxyType(
    {
        SCARA: Template("error maps of a SCARA that tracks reflectors", {"rh-3frh5515": scara.TEMPLATE}),
        RESOLUTION: Template("motion resolution of the joints of an arm", resolution.BY_ARM),
        SIX_AXIS: Template("calibration of a serial arm with a tracker", six_axis.BY_ARM),
    }
)
"""By name of the system; the first is the one that is meant where none is named."""


def system_of(data: Mapping[str, Any]) -> str:
    """Return the system that the values of a cell file are meant for, right or wrong as they are."""
    robot = data.get("robot")
    arm = isinstance(robot, Mapping) and "arm" in robot
    tracker = data.get("tracker")
    if "ballbar" in data or (isinstance(tracker, Mapping) and "base_mm" in tracker):
        return SIX_AXIS
    of_resolution = arm or bool({"angular_optics", "linear_optics"} & data.keys())
    return RESOLUTION if of_resolution and not scara.is_meant(data) else SCARA
