"""What can go wrong with shared work."""

from catseye.app.errors import CatseyeError


class WorkerLostError(CatseyeError):
    """A worker ended before its item was finished."""
