"""What the mathematics refuses to do, and why."""


class CalibrationError(Exception):
    """Root of the errors of the calibration room; the text says what to do."""


class OutOfReachError(CalibrationError):
    """A position lies outside the ring that the arm reaches."""


class MapRangeError(CalibrationError):
    """An angle lies outside the nodes of an error map; maps are never extrapolated."""


class UnidentifiableError(CalibrationError):
    """The points leave combinations of parameters undetermined.

    Args:
        text: what is undetermined and what to measure.
        null_directions: for each combination, the names of the parameters that it moves.
    """

    def __init__(self, text: str, null_directions: list[list[str]]) -> None:
        super().__init__(text)
        self.null_directions = null_directions

    def __reduce__(self) -> tuple[type["UnidentifiableError"], tuple[str, list[list[str]]]]:
        """Keep both arguments on the way to another process."""
        return type(self), (str(self), self.null_directions)


class InsufficientPointsError(CalibrationError):
    """There are fewer usable points than the model needs."""


class ConvergenceError(CalibrationError):
    """The iteration did not settle; the starting values are too far off or the points contradict."""


class RejectionError(CalibrationError):
    """More distances than a stated share would have to be left out: the model is in doubt, not the points."""


class BudgetError(CalibrationError):
    """The error budget leaves open what is needed."""
