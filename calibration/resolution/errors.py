"""What the evaluation of a recording refuses, and what to do instead."""

from catseye.calibration.core.errors import CalibrationError


class ResolutionError(CalibrationError):
    """A recording and the moves commanded meanwhile give no step errors."""


class _PlacedError(ResolutionError):
    """Something that shows at one place of a table.

    Args:
        text: what is wrong, where, and what to do.
        row: the place, counting from 1; None where it is none in particular.
    """

    def __init__(self, text: str, row: int | None = None) -> None:
        super().__init__(text)
        self.row = row

    def __reduce__(self) -> tuple[type["_PlacedError"], tuple[str, int | None]]:
        """Keep both arguments on the way to another process."""
        return type(self), (str(self), self.row)


class RecordingError(_PlacedError):
    """The recording itself cannot be used; the row is that of a sample."""


class MovesError(_PlacedError):
    """The moves do not fit the test or the recording: too few, of another run, or not covered.

    The row is the number of a move.
    """


class ClockError(ResolutionError):
    """The clocks of recording and moves cannot be aligned without doubt."""
