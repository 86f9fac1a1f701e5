"""Procedures that others of this system build on."""

from typing import Final

from catseye.procedures.kit.needs import After

LEVELLED: Final = After("beam-level", "levelling")
ALIGNED: Final = After("beam-to-j4", "alignment")

WARM: Final = After("warmup", "warm arm", fresh_for_s=4 * 3600.0)
"""Links and drives cool down within hours."""
