"""Why a request is refused, and why there is no service."""

from catseye.app.errors import CatseyeError, exit_code_of, text_of
from catseye.app.exitcode import ExitCode


class RefusedError(CatseyeError):
    """The engine does not do what a client asks.

    Args:
        code: exit code that the refusal leads to.
    """

    exit_code = ExitCode.USAGE

    def __init__(self, text: str, code: ExitCode = ExitCode.USAGE) -> None:
        super().__init__(text)
        self.code = code


class ServiceError(CatseyeError):
    """A socket cannot be made or reached, or nobody answers at it."""

    exit_code = ExitCode.DEVICE


def refusal_of(error: BaseException) -> RefusedError:
    """Return an error as a client is answered."""
    return error if isinstance(error, RefusedError) else RefusedError(text_of(error), exit_code_of(error))
