"""The text of a cell file with other values: whatever stays as it is keeps its comments and its place."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT, Comment, InlineTable, Item, Key, Null, Table, Whitespace

from catseye.app.errors import ConfigError
from catseye.app.files.documents import parse_toml, read_text

_Parent = tomlkit.TOMLDocument | Table | InlineTable
_Body = list[tuple[Key | None, Item]]

_LONE_NEWLINE: Final = re.compile(r"(?<!\r)\n")


class CommentsLostError(Exception):
    """A file cannot be changed in place: its values can be written, its comments cannot be kept."""


def rewritten(text: str, wanted: Mapping[str, Any]) -> str:
    """Return the text of a file with exactly the wanted values.

    Comments right above a table belong to it: they go with it, and stay when the table before it goes.

    Args:
        wanted: all its values, as `tomllib` reads them.

    Raises:
        CommentsLostError: its form does not allow it; write `plain(wanted)` instead.
    """
    try:
        document = tomlkit.parse(text)
        _change(document, wanted)
        new = _with_line_ends_of(text, tomlkit.dumps(document))
        same = tomllib.loads(new) == wanted
    except (TOMLKitError, tomllib.TOMLDecodeError):
        same = False
    if not same:
        raise CommentsLostError("this file cannot be changed in place: its comments cannot be kept")
    return new


def _with_line_ends_of(text: str, new: str) -> str:
    """Return a text whose added lines end as all others do."""
    if "\r\n" in text and not _LONE_NEWLINE.search(text):
        return _LONE_NEWLINE.sub("\r\n", new)
    return new


def plain(wanted: Mapping[str, Any]) -> str:
    """Return a file with the wanted values and no comments."""
    return tomlkit.dumps(wanted)


def with_reflector_tables(path: Path, reflectors: list[tuple[str, float, float, float]]) -> str:
    """Return the text of a cell file with its [[reflector]] tables replaced.

    Args:
        path: the cell file; it has passed every check.
        reflectors: name, x and y in mm, direction of the axis in deg.

    Raises:
        ConfigError: the file cannot be changed in place.
    """
    text = read_text(path)
    tables = [dict(zip(("name", "x_mm", "y_mm", "facing_deg"), values, strict=True)) for values in reflectors]
    try:
        return rewritten(text, {**parse_toml(text, str(path)), "reflector": tables})
    except CommentsLostError as error:
        raise ConfigError(f"{path}: {error}; write each of its tables in one piece") from error


def _change(parent: _Parent, wanted: Mapping[str, Any]) -> None:
    """Bring a table and those within it to the wanted values."""
    for key in [key for key in parent if key not in wanted]:
        _remove(parent, key)
    for key, value in wanted.items():
        present = _item(parent, key)
        if present is not None and present.unwrap() == value:
            continue
        if isinstance(present, Table | InlineTable) and isinstance(value, Mapping):
            _change(present, value)
        elif isinstance(present, AoT) and _are_tables(value):
            if _same_entries(present, value):
                for entry, values in zip(present.body, value, strict=True):
                    _change(entry, values)
            else:
                parent[key] = _entries(present, value)
        elif present is None or isinstance(present, Table | AoT) or isinstance(value, Mapping):
            if present is not None:
                _remove(parent, key)
            _append(parent, key, value)
        else:
            _replace(parent, key, present, tomlkit.item(value))


def _append(parent: _Parent, key: str, value: Any) -> None:
    """Add a value to a table, before the blank lines and comments that lead to the next one."""
    below = _cut(_last_body(parent), Comment, Whitespace)
    parent.append(key, tomlkit.item(value))
    _last_body(parent).extend(below)


def _replace(parent: _Parent, key: str, present: Item, new: Item) -> None:
    """Set a value; the comment behind it stays in its column."""
    parent[key] = new
    longer = len(new.as_string()) - len(present.as_string().rpartition("\n")[2])
    if present.trivia.comment:
        new.trivia.comment_ws = " " * max(1, len(present.trivia.comment_ws) - longer)


def _remove(parent: _Parent, key: str) -> None:
    """Take a value out, and a table with the comments above it."""
    present = _item(parent, key)
    if not isinstance(present, Table | AoT):
        parent.remove(key)
        return
    below = _cut(_last_body(present), Comment)
    body = _body_of(parent)
    place = next(i for i, (name, _) in enumerate(body) if name is not None and name.key == key)
    parent.remove(key)
    before = next((item for _, item in reversed(body[:place]) if not isinstance(item, Null)), None)
    if isinstance(before, Table | AoT):
        _cut(_last_body(before), Comment)
        _last_body(before).extend(below)
    else:
        # In the place of the table: tomlkit counts the lines of a table.
        body[place] = None, Whitespace("".join(comment.as_string() for _, comment in below))


def _same_entries(present: AoT, wanted: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether the entries of a [[list]] stay in their places, so that each is changed where it stands."""
    names = [str(entry.get("name")) for entry in present.body]
    return names == [str(values.get("name")) for values in wanted] and len(set(names)) == len(names)


def _entries(present: AoT, wanted: Sequence[Mapping[str, Any]]) -> AoT:
    """Return a [[list]] of the wanted entries; those that are still there keep their lines."""
    below = [_cut(_last_body(entry), Comment, Whitespace) for entry in present.body]
    kept = {
        str(entry.get("name")): (entry, above)
        for entry, above in zip(present.body, [[], *below[:-1]], strict=True)
    }
    entries: list[Table] = []
    for values in wanted:
        entry, above = kept.pop(str(values.get("name")), (tomlkit.table(), []))
        _change(entry, values)
        if entries:
            _last_body(entries[-1]).extend(above)
        elif above:
            # What stands above the list stays; its first entry brings its own comments.
            entry.trivia.indent = "".join(comment.as_string() for _, comment in above)
        entries.append(entry)
    _last_body(entries[-1]).extend(below[-1])
    return AoT(entries)


def _cut(body: _Body, *kinds: type[Item]) -> _Body:
    """Take what stands at the end of a table, and leads to the next one, out of it."""
    start = len(body)
    while start and isinstance(body[start - 1][1], kinds):
        start -= 1
    cut = body[start:]
    del body[start:]
    return cut


def _last_body(item: _Parent | AoT) -> _Body:
    """Return the lines of the table that ends last within an item."""
    if isinstance(item, AoT):
        return _last_body(item.body[-1])
    body = _body_of(item)
    last = body[-1][1] if body else None
    return _last_body(last) if isinstance(last, Table | AoT) else body


def _item(parent: _Parent, key: str) -> Item | None:
    """Return a value as it is written.

    Raises:
        CommentsLostError: it is a table in several parts.
    """
    found = [item for name, item in _body_of(parent) if name is not None and name.key == key]
    if len(found) > 1:
        raise CommentsLostError(f"{key} is written in several parts of the file: its comments cannot be kept")
    return found[0] if found else None


def _body_of(parent: _Parent) -> _Body:
    return parent.body if isinstance(parent, tomlkit.TOMLDocument) else parent.value.body


def _are_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(entry, Mapping) for entry in value)
