"""A picture of the bench, and what it follows from."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from textual.content import Content

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from catseye.app.protocol.posture import Posture
    from catseye.app.protocol.scara.layout import Layout


@dataclass(frozen=True)
class Seen:
    """What a picture of the bench follows from.

    Attributes:
        layout: of a SCARA's bench; None of any other.
        posture: of any other arm; None while it is not known.
        joints: of the arm, deg or mm; None while they are not known.
        names: of its axes.
        moving: what is moved by hand, as the engine names it; None when nothing is.
        beam_ok: the beam comes back; None when that is not known.
        stale: what is known of the arm is old.
    """

    layout: "Layout | None"
    posture: "Posture | None"
    joints: Sequence[float] | None
    names: tuple[str, ...]
    moving: str | None
    beam_ok: bool | None
    stale: bool


@dataclass(frozen=True)
class Picture:
    """A drawing with what stands in its frame.

    Attributes:
        title: what is seen, from where.
        drawing: of a size that was asked for.
        caption: state as word and sign.
    """

    title: str
    drawing: Content
    caption: str = ""
