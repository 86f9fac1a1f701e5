"""What the emulation refuses to do, and what to do about it."""


class EmulatorError(Exception):
    """The emulation cannot start or go on; the text says what to do."""


class TruthFileError(EmulatorError):
    """A truth file cannot be used; the text names the file and the key."""


class BenchError(EmulatorError):
    """The bench was asked for something that it cannot do in its present state."""
