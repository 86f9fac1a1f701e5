"""What decoders make of any bytes."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

from catseye.drivers.roles.errors import ProtocolError

P = ParamSpec("P")
T = TypeVar("T")


def outcome_of(work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T | type[ProtocolError]:
    """Return what work returns, or ProtocolError where it raises one; any other error is the test's."""
    try:
        return work(*args, **kwargs)
    except ProtocolError:
        return ProtocolError
