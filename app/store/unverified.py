"""What comes of using a run that is known to be changed."""

from collections.abc import Iterator
from contextlib import contextmanager

from catseye.app.errors import StorageError, UsageError
from catseye.app.store.reader import RunReader

_OF_WRONG_DATA = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, RecursionError)


@contextmanager
def taken_as_it_is(*readers: RunReader) -> Iterator[None]:
    """Blame a changed run, not the program, for what cannot be made of it.

    Args:
        readers: the runs; of those that are what was written every error is the program's own.

    Raises:
        StorageError: one is changed, and no run any more.
    """
    try:
        yield
    except (*_OF_WRONG_DATA, UsageError) as error:
        changed = dict.fromkeys(text for reader in readers for text in reader.unverified)
        asked_wrongly = isinstance(error, UsageError) and not isinstance(error.__cause__, _OF_WRONG_DATA)
        if not changed or asked_wrongly:
            raise
        raise StorageError(
            f"{'; '.join(changed)}; what it holds now cannot be used as a run ({type(error).__name__}: {error}): "
            "take a copy from before the change"
        ) from error
