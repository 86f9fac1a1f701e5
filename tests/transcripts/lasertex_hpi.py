"""Frames of the Lasertex HPI-3D / µLine F1.

Source: the open client l-pio/pylinef1 (MIT, commit ba679cd), its frames and its own checksum routine.
"""

COMMANDS = {
    0xB032: "AA B0 32 00 00 00 00 8E",
    0xB033: "AA B0 33 00 00 00 00 5D",
    0xB034: "AA B0 34 00 00 00 00 06",
    0xB035: "AA B0 35 00 00 00 00 D5",
    0xB03C: "AA B0 3C 00 00 00 00 38",
    0xB03D: "AA B0 3D 00 00 00 00 EB",
    0xB03F: "AA B0 3F 00 00 00 00 7C",
    0xB040: "AA B0 40 00 00 00 00 5C",
    0xB048: "AA B0 48 00 00 00 00 62",
    0xB079: "AA B0 79 00 00 00 00 35",
    0xB07A: "AA B0 7A 00 00 00 00 71",
}
"""Command codes and whole frames."""

DISTANCE = "AA B0 15 00 00 00 00 BC 61 46 00 00 00 09 50 4F"
"""+1.234567 mm, level 80, laser ready, signal OK, no overspeed."""
