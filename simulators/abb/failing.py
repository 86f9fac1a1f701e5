"""A web server that answers with an error what it may have carried out."""

import re
from dataclasses import dataclass

from catseye.simulators.abb.http import Answer, Request

FAILED = Answer(503, b"<html><body>Service Unavailable</body></html>")


@dataclass
class Failing:
    """Answers some requests with 503.

    Attributes:
        pattern: regular expression that is searched for in method, path and query of a request.
        carried_out: they take effect all the same.
        left: so many more fail.
    """

    pattern: str
    carried_out: bool
    left: int

    def fails(self, request: Request) -> bool:
        """Return whether a request fails, and count it."""
        failing = self.left > 0 and re.search(self.pattern, f"{request.method} {request.target}") is not None
        self.left -= failing
        return failing
