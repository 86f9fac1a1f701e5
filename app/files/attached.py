"""Documents that travel with a table: in comments above the header of a CSV file, in the metadata of Parquet.

A kind begins with `catseye-`; other comments and metadata are passed over.
"""

import json
import re
from collections.abc import Iterable, Mapping
from typing import Final

from catseye.app.files.csv_text import uncommented

_KIND: Final = "catseye-"
_LINE: Final = re.compile(rf"#\s*({_KIND}[a-z]+)\s+(.*)")
_STRING: Final = re.compile(r'"(?:[^"\\]|\\.)*"')
_UNSAFE: Final = re.compile(r"\\.|['=+@;]|(?<!\w)-")
"""Escapes, apostrophes, and what begins a formula in some cell that a spreadsheet makes of a comment."""


def document_comments(documents: Mapping[str, object]) -> list[str]:
    """Return comments for the top of a CSV file; apostrophes stand there for the quotes of JSON.

    Args:
        documents: what JSON can hold, by kind.
    """
    return [
        f"{kind} {_STRING.sub(lambda found: _UNSAFE.sub(_escaped, found[0]), json.dumps(document))}"
        for kind, document in documents.items()
    ]


def _escaped(found: re.Match[str]) -> str:
    sign = found[0]
    if sign.startswith("\\") and sign != '\\"':
        return sign
    return f"\\u{ord(sign[-1]):04x}"


def attached_documents(comments: Iterable[str]) -> dict[str, str]:
    """Return the documents that comments hold, by kind; a damaged one is no JSON, and so are two of a kind."""
    documents: dict[str, str] = {}
    for comment in comments:
        if found := _LINE.fullmatch(comment.strip()):
            documents[found[1]] = documents.get(found[1], "") + uncommented(found[2])
    return documents


def attached_metadata(metadata: Mapping[bytes, bytes]) -> dict[str, str]:
    """Return the documents that the metadata of a Parquet schema hold, JSON by kind."""
    texts = {
        key.decode("utf-8", "replace"): text.decode("utf-8", "replace") for key, text in metadata.items()
    }
    return {kind: text for kind, text in texts.items() if kind.startswith(_KIND)}
