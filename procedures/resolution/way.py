"""The way from optics on an arm to the least steps of its joints and of its tool."""

from typing import Final

from catseye.procedures.kit.procedure import Stage

_WAY: Final = "resolution"

DECAYING: Final = Stage(110, "how small a step each joint still makes, in both directions", _WAY)
EQUAL: Final = Stage(120, "the same by equal steps, as ISO 230 has it", _WAY)
THERE_AND_BACK: Final = Stage(130, "what a reversal costs, and whether it is play", _WAY)
STRAIGHT: Final = Stage(170, "how small a straight step the tool still makes", _WAY)
