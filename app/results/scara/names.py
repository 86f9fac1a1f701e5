"""What a reader calls models, angles and quantities."""

from typing import Final

MODEL_TITLES: Final = {"conventional": "conventional model", "error-map": "error map"}

ANGLES: Final = {"theta1": "θ1", "theta2": "θ2", "theta4": "θ4"}
"""θ4 is the angle of the beam against link 2."""

VARYING: Final = {"theta1": "deviation of J1", "theta2": "deviation of J2", "length": "distance"}


def node_name(joint: int, node_deg: float, direction: int = 0) -> str:
    """Return the name of a map's value at a node; the direction is 1 or -1, and 0 for both."""
    return f"Δθ{joint}({node_deg:g}°, {'±+−'[direction]})"
