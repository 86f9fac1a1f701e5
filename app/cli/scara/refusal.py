"""A refused result as data, for programs that read stdout."""

from collections.abc import Iterator
from contextlib import contextmanager

from catseye.app.cli.documents import Refused
from catseye.app.cli.output import write_document
from catseye.app.results.scara.plausible import ImplausibleError


@contextmanager
def refusal_as_json(*, as_json: bool) -> Iterator[None]:
    """Write why a result is refused as JSON, where that is wanted; the error goes on."""
    try:
        yield
    except ImplausibleError as error:
        if as_json:
            refused = Refused(reason=error.reason, text=str(error), findings=tuple(error.findings))
            write_document("refusal", refused.json_object())
        raise
