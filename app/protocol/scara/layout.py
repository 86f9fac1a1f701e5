"""A SCARA's bench from above."""

from catseye.app.protocol.message import Message


class ReflectorPlace(Message):
    """A reflector as cell file or search have it."""

    name: str
    x_mm: float
    y_mm: float
    facing_deg: float
    field_half_angle_deg: float


class Layout(Message):
    """The bench from above.

    Attributes:
        link1_mm: length of link 1.
        link2_mm: length of link 2.
        column_radius_mm: of the robot's column.
        theta40_deg: direction of the beam at J4 = 0.
        limits_deg: lowest and highest angle, by axis.
        reflectors: all.
        aim: name of the one that the beam is meant for; None when it passes all.
    """

    link1_mm: float
    link2_mm: float
    column_radius_mm: float
    theta40_deg: float
    limits_deg: dict[str, tuple[float, float]]
    reflectors: tuple[ReflectorPlace, ...]
    aim: str | None

    @property
    def aimed(self) -> ReflectorPlace | None:
        """The reflector that the beam is meant for."""
        return self.reflector(self.aim)

    def reflector(self, name: str | None) -> ReflectorPlace | None:
        """Return a reflector by its name; None where there is none."""
        return next((each for each in self.reflectors if each.name == name), None)
