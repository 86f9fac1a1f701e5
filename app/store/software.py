"""Name and version of the program, as results and runs state it."""

from importlib.metadata import version

SOFTWARE = f"catseye {version('catseye')}"
