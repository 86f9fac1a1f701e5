"""Name and version of the program, as results and runs state it."""

from importlib.metadata import version

SOFTWARE = f"catseye {version('catseye')}"


def other_version_text(engine: str) -> str:
    """Return what a person is told of an engine that is of another version.

    Args:
        engine: its software.
    """
    return f"the engine is {engine}, this program {SOFTWARE}: what only one of them knows is passed over"
