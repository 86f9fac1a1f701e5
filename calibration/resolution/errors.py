"""What the evaluation of a recording refuses, and what to do instead."""

from catseye.calibration.core.errors import CalibrationError


class ResolutionError(CalibrationError):
    """A recording and the moves commanded meanwhile give no step errors."""


class RecordingError(ResolutionError):
    """The recording itself cannot be used.

    Args:
        text: what is wrong, where, and what to do.
        row: the sample at which it shows, counting from 1; None where it is none in particular.
    """

    def __init__(self, text: str, row: int | None = None) -> None:
        super().__init__(text)
        self.row = row

    def __reduce__(self) -> tuple[type["RecordingError"], tuple[str, int | None]]:
        """Keep both arguments on the way to another process."""
        return type(self), (str(self), self.row)


class MovesError(ResolutionError):
    """The moves do not fit the test or the recording: too few, of another run, or not covered."""


class ClockError(ResolutionError):
    """The clocks of recording and moves cannot be aligned without doubt."""
