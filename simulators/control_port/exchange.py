"""A request of the control port, its answer, and the lines that carry them: one JSON object a line.

A request has `op` and its arguments, a fault `"op": "fault"` and its `name`; an answer is `{"ok": true, …}` or
`{"ok": false, "error": "…"}`.
"""

import json
from collections.abc import Mapping
from typing import Any, ClassVar, Generic, TypeVar, cast

from pydantic import BaseModel, ConfigDict

from catseye.simulators.errors import EmulatorError


class RefusedRequestError(ValueError):
    """The emulated bench refused a request; the text is its own."""


class Answer(BaseModel):
    """An answer that says no more than that the request was carried out."""

    model_config = ConfigDict(frozen=True)


A = TypeVar("A", bound=Answer)


class Request(BaseModel, Generic[A]):
    """A request; the type parameter is its answer."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)

    op: ClassVar[str]
    answer: ClassVar[type[Answer]] = Answer

    def encode(self) -> bytes:
        """Return the line that asks for it."""
        return _line(self.arguments())

    def arguments(self) -> dict[str, Any]:
        """Return what the line holds."""
        return {"op": self.op, **self.model_dump()}

    def decode(self, line: bytes) -> A:
        """Read the answer.

        Raises:
            RefusedRequestError: the bench refused the request.
            ValueError: the line is no answer to it.
        """
        document = json.loads(line)
        if not isinstance(document, dict):
            raise ValueError(f"{line!r} is no answer of a control port")
        if not document.pop("ok", False):
            raise RefusedRequestError(f"the emulated bench refused: {document.get('error')}")
        return cast(A, self.answer.model_validate(document))


def encode_answer(answer: Answer) -> bytes:
    """Return the line that answers a request that was carried out."""
    return _line({"ok": True, **answer.model_dump()})


def encode_refusal(error: str) -> bytes:
    """Return the line that answers a request that was not carried out."""
    return _line({"ok": False, "error": error})


def _line(document: dict[str, Any]) -> bytes:
    return json.dumps(document).encode() + b"\n"


Kind = TypeVar("Kind", bound=type[Request[Any]])


def known(table: Mapping[str, Kind], what: str, name: object) -> Kind:
    """Return what a table has under a name that a client sent.

    Raises:
        EmulatorError: it has nothing under it.
    """
    if not isinstance(name, str) or name not in table:
        raise EmulatorError(f"there is no {what} {name!r}; there are {', '.join(table)}")
    return table[name]
