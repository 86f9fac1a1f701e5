"""What resources say, as JSON or as XHTML."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any, Final

from catseye.simulators.abb.http import Answer

JSON: Final = "application/json"
XHTML: Final = "application/xhtml+xml"

NOT_FOUND: Final = -1073445865
REFUSED: Final = -1073445859
NO_VALUE: Final = -1073445881
QUEUE_EXISTS: Final = -1073445879
"""Of a queue that there is already, by what `abb_robot_client` expects; the others are chosen beside it."""


@dataclass(frozen=True)
class State:
    """One item of an answer.

    Attributes:
        kind: its type.
        title: its name.
        fields: texts, or lists of items with texts.
    """

    kind: str
    title: str
    fields: Mapping[str, Any] = field(default_factory=dict)


class RefusedError(Exception):
    """A resource does not do what is asked.

    Args:
        status: of the answer.
        code: of the controller.
        text: what is wrong.
    """

    def __init__(self, status: int, code: int, text: str) -> None:
        super().__init__(text)
        self.status = status
        self.code = code


NOTHING: Final = Answer(204)
"""The answer to what was done."""


def said(states: Sequence[State], path: str, *, as_json: bool, status: int = 200) -> Answer:
    """Return the answer of a resource.

    Args:
        path: of the resource.
    """
    if as_json:
        items = [{"_type": state.kind, "_title": state.title, **state.fields} for state in states]
        return _json(status, path, {"_state": items})
    listed = "".join(map(item_xhtml, states))
    return Answer(status, _page(path, f'<div class="state"><ul>{listed}</ul></div>'), XHTML)


def refused(error: RefusedError, path: str, *, as_json: bool) -> Answer:
    """Return the answer of a resource that refuses."""
    if as_json:
        return _json(error.status, path, {"status": {"code": error.code, "msg": str(error)}})
    spans = f'<span class="code">{error.code}</span><span class="msg">{escape(str(error))}</span>'
    return Answer(error.status, _page(path, f'<div class="status">{spans}</div>'), XHTML)


def item_xhtml(state: State, link: str = "") -> str:
    """Return an item as an element of a list, on one line.

    Args:
        link: address of what it is about; the title where there is none.
    """
    spans = "".join(
        f'<span class="{escape(name)}">{escape(value)}</span>'
        for name, value in state.fields.items()
        if isinstance(value, str)
    )
    href = escape(link or state.title)
    return f'<li class="{state.kind}" title="{escape(state.title)}"><a href="{href}" rel="self"/>{spans}</li>'


def event_page(items: Sequence[str]) -> str:
    """Return the body of an event from its items."""
    return _page("", f'<div class="state"><ul>{"".join(items)}</ul></div>').decode()


def subscribed(address: str, states: Sequence[State]) -> Answer:
    """Return the answer to a subscription: XHTML in any case, since it names the address as a link."""
    link = f'<a href="{escape(address)}" rel="self"></a>'
    body = f'<div class="state">{link}<ul>{"".join(map(item_xhtml, states))}</ul></div>'
    return Answer(201, _page("subscription", body), XHTML, (("Location", address),))


def _json(status: int, path: str, embedded: Mapping[str, Any]) -> Answer:
    document = {"_links": {"base": {"href": f"/{path}"}}, "_embedded": embedded}
    return Answer(status, json.dumps(document).encode(), JSON)


def _page(title: str, body: str) -> bytes:
    return (
        '<?xml version="1.0" encoding="UTF-8"?><html xmlns="http://www.w3.org/1999/xhtml"><head>'
        f'<title>{escape(title)}</title><base href="/{escape(title)}/"/></head><body>{body}</body></html>'
    ).encode()
