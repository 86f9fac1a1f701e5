"""Keys that move a SCARA and its beam by hand, and what stands beside them."""

from typing import Final

from catseye.app.tui.jog_client import Way

MOVES: Final[tuple[tuple[str, str, Way, str], ...]] = (
    ("left,a", "j1", 1, "J1 counter-clockwise"),
    ("right,d", "j1", -1, "J1 clockwise"),
    ("up,w", "j2", 1, "J2 counter-clockwise"),
    ("down,s", "j2", -1, "J2 clockwise"),
    ("q", "j4", 1, "J4 counter-clockwise"),
    ("e", "j4", -1, "J4 clockwise"),
    ("z", "beam", 1, "beam to the left"),
    ("x", "beam", -1, "beam to the right"),
)
"""Keys, what moves as the engine names it, which way, and that in words."""

JOINT_ROWS: Final = (
    ("J1", "← a", "→ d", 0),
    ("J2", "↑ w", "↓ s", 1),
    ("J4", "q", "e", 3),
)
"""Name of a joint, its keys, and its place in a pose."""

NO_AIM: Final = "no aim: J1 and J2 take the beam away"
WITH_AIM: Final = " J4 follows steps · p points at it"
POINT: Final = "turn J4 until the beam points at the aim"
POINT_COMMAND: Final = "turn J4; asks first"
