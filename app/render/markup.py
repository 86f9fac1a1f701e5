"""HTML by plain functions. Text is escaped unless it is `Html` already."""

import html
import re
from collections.abc import Iterable, Sequence


class Html(str):
    """Markup that stands as it is; any other string is text and is escaped."""

    __slots__ = ()


_CONTROL = re.compile("[\\x00-\\x08\\x0b\\x0c\\x0e-\\x1f\\x7f]")


def shown(text: str) -> str:
    """Return a text without control characters, which neither HTML nor XML takes and some terminal obeys."""
    return _CONTROL.sub("\N{REPLACEMENT CHARACTER}", text)


def escaped(text: str) -> str:
    """Return a text as markup that shows it, also within the quotes of an attribute."""
    return html.escape(shown(text), quote=True)


def element(name: str, *children: str, **attributes: str) -> Html:
    """Return an element.

    Args:
        attributes: a trailing underscore is dropped, any other is a hyphen: `class_`, `aria_label`.
    """
    written = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escaped(value)}"' for key, value in attributes.items()
    )
    return Html(f"<{name}{written}>{join(children)}</{name}>")


def join(children: Iterable[str]) -> Html:
    """Return texts and markup one after the other."""
    return Html("".join(child if isinstance(child, Html) else escaped(child) for child in children))


def paragraphs(*texts: str) -> Html:
    """Return one paragraph a text; empty ones are left out."""
    return join(element("p", text) for text in texts if text)


def bullets(texts: Iterable[str]) -> Html:
    """Return a list."""
    return element("ul", *(element("li", text) for text in texts))


def table(
    head: Sequence[str], rows: Iterable[Sequence[str]], numeric: Sequence[bool], *, labelled_by: str
) -> Html:
    """Return a table.

    Args:
        head: names of the columns with their units.
        rows: cells; the first names the row.
        numeric: which columns stand flush right.
        labelled_by: name of the element with its caption.
    """

    def kind(column: int) -> str:
        return "number" if numeric[column] else "text"

    names = (element("th", name, scope="col", class_=kind(i)) for i, name in enumerate(head))
    body = (
        element(
            "tr",
            element("th", row[0], scope="row", class_="text"),
            *(element("td", cell, class_=kind(i)) for i, cell in enumerate(row[1:], start=1)),
        )
        for row in rows
    )
    return element(
        "table",
        element("thead", element("tr", *names)),
        element("tbody", *body),
        aria_labelledby=labelled_by,
    )


def section(anchor: str, title: str, *children: str) -> Html:
    """Return a section with its heading; empty when it has nothing to show."""
    content = join(children)
    return element("section", element("h2", title), content, id_=anchor) if content else Html()


def unbroken(text: str) -> str:
    """Return a text in which no line ends between a number and its unit."""
    return re.sub(r"(?<=\d) (?=(?:µm|mm|mdeg|%|u)\b|%)", "\u00a0", text)
