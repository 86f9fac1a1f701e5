"""Valid bytes and documents, changed a little, as an accident or a hostile author would."""

import random
import re
from collections.abc import Sequence
from typing import Any, Final

_NUMBER: Final = re.compile(rb"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")

NUMBERS: Final = (
    b"0",
    b"-0",
    b"-1",
    b"1e999",
    b"1e308",
    b"-1e-320",
    b"nan",
    b"NaN",
    b"inf",
    b"Infinity",
    b"9" * 30,
    b"9" * 5000,
    b"1_000",
    b"0x10",
    b"1,5",
    b"++1",
    b"\xd9\xa3",
    b"",
)
"""What may stand where a number did; the one in two bytes is an Arabic-Indic digit."""

SIGNS: Final = (
    b"\0",
    b"\x1b[2J",
    b"\xff\xfe",
    b"\xc0\x80",
    b"\xed\xa0\x80",
    b"\xe2\x80\xae",
    b"\r",
    b"\n",
    b"\r\n",
    b"\t",
    b'"',
    b"'",
    b",",
    b";",
    b"=",
    b"[" * 3000,
    b"{" * 3000,
    b"<!DOCTYPE a [<!ENTITY b SYSTEM 'file:///etc/passwd'>]>&b;",
    b"[/x]",
    b"../" * 20,
)


def mutated(data: bytes, source: random.Random, others: Sequence[bytes] = ()) -> bytes:
    """Return bytes with one to four changes.

    Args:
        data: what is changed.
        others: valid ones, parts of which may take the place of parts of it.
    """
    for _ in range(source.choice((1, 1, 2, 4))):
        data = _changed(data, source, others)
    return data


def _changed(data: bytes, source: random.Random, others: Sequence[bytes]) -> bytes:
    begin, end = _span(data, source)
    match source.randrange(8):
        case 0:
            return data[:begin] + bytes([source.randrange(256)]) + data[begin + 1 :]
        case 1:
            return data[:begin] + data[end:]
        case 2:
            return data[:end] + data[begin:]
        case 3:
            return data[:begin] + source.choice(SIGNS) + data[begin:]
        case 4:
            return data[:begin]
        case 5 if others:
            other = source.choice(others)
            from_, to = _span(other, source)
            return data[:begin] + other[from_:to] + data[end:]
        case 6 if data:
            return data[:begin] + bytes([data[begin] ^ 1 << source.randrange(8)]) + data[begin + 1 :]
        case _:
            return _other_number(data, source)


def _span(data: bytes, source: random.Random) -> tuple[int, int]:
    begin = source.randrange(len(data)) if data else 0
    return begin, min(len(data), begin + source.choice((1, 2, 8, 40, 200)))


def _other_number(data: bytes, source: random.Random) -> bytes:
    found = list(_NUMBER.finditer(data))
    if not found:
        return data + source.choice(NUMBERS)
    place = source.choice(found)
    return data[: place.start()] + source.choice(NUMBERS) + data[place.end() :]


VALUES: Final[tuple[object, ...]] = (
    None,
    True,
    0,
    -1,
    2**63,
    -(2**63),
    10**30,
    0.0,
    -1.0,
    1e308,
    5e-324,
    "",
    "nan",
    "x" * 100_000,
    "a\0b",
    "\x1b]0;owned\x07",
    "<script>alert(1)</script>",
    "../../etc/passwd",
    "[/x]",
    [],
    {},
    [[]],
    [1.0] * 3,
    {"value": 1.0, "u": -1.0},
)
"""What may stand in place of any value of a document."""


def mutated_document(document: Any, source: random.Random) -> Any:
    """Return a document of JSON or TOML with one or two values changed, taken away, doubled or exchanged."""
    for _ in range(source.choice((1, 1, 2))):
        document = _with_change(document, source)
    return document


def _with_change(value: Any, source: random.Random) -> Any:
    if isinstance(value, dict) and value and source.random() < 0.9:
        return _changed_table(value, source)
    if isinstance(value, list) and value and source.random() < 0.9:
        return _changed_list(value, source)
    return source.choice(VALUES)


def _changed_table(table: dict[str, Any], source: random.Random) -> dict[str, Any]:
    key = source.choice([*table])
    match source.randrange(10):
        case 0:
            return {name: value for name, value in table.items() if name != key}
        case 1:
            return {**table, source.choice(("x", "", "a.b", "__class__", key.upper(), "é")): table[key]}
        case 2:
            return {**table, key: table[source.choice([*table])]}
        case _:
            return {**table, key: _with_change(table[key], source)}


def _changed_list(values: list[Any], source: random.Random) -> list[Any]:
    place = source.randrange(len(values))
    match source.randrange(8):
        case 0:
            return values[:place] + values[place + 1 :]
        case 1:
            return [*values, values[place]]
        case 2:
            return values[:place]
        case 3:
            return values[::-1]
        case _:
            return [*values[:place], _with_change(values[place], source), *values[place + 1 :]]
