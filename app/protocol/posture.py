"""How an arm stands: its joints and bodies in the base's frame."""

from catseye.app.protocol.message import Message

Place = tuple[float, float, float]
"""x, y and z in the arm's base frame, mm."""


class Limb(Message):
    """A body of the arm: everything within a radius of a segment.

    Attributes:
        name: as messages use it.
        start_mm: one end of the segment.
        end_mm: the other end.
        radius_mm: of the body.
    """

    name: str
    start_mm: Place
    end_mm: Place
    radius_mm: float


class Posture(Message):
    """The nominal arm as it stands.

    Attributes:
        joints_mm: origins of the frames, from the base outwards: one more than there are joints.
        heading_deg: direction of the arm's plane, from x counter-clockwise as seen from above.
        limbs: bodies of the arm.
        table_z_mm: height of what the arm stands on.
    """

    joints_mm: tuple[Place, ...]
    heading_deg: float
    limbs: tuple[Limb, ...]
    table_z_mm: float
