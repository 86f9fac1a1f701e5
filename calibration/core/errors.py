"""What the mathematics refuses to do, and why."""


class CalibrationError(Exception):
    """Root of the errors of the calibration room; the text says what to do."""


class UnidentifiableError(CalibrationError):
    """The rows leave combinations of parameters undetermined.

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


class ArgumentError(CalibrationError, ValueError):
    """An argument has no meaning: an unknown name, a number out of range, arrays that do not fit together."""


class InsufficientPointsError(CalibrationError):
    """There are fewer usable rows than the model needs."""


class ConvergenceError(CalibrationError):
    """The iteration did not settle: the starting values are too far off, or the rows contradict each other."""


class RejectionError(CalibrationError):
    """More rows than a stated share would have to be left out: the model is in doubt, not the measurement."""


class BudgetError(CalibrationError):
    """The error budget leaves open what is needed."""
