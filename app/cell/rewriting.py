"""The text of a cell file with other values: whatever stays as it is keeps its comments and its place."""

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

_HEADER: Final = re.compile(r"\s*(?P<open>\[\[?)\s*(?P<name>[\w.\- \"]+?)\s*\]\]?\s*(#.*)?$")
_KEY: Final = re.compile(r"\s*(?P<key>[\w\-]+)\s*=")
_LONGEST_VALUE: Final = 200
"""Lines that a value may take."""


class CommentsLostError(Exception):
    """A file cannot be changed line by line: its values can be written, its comments cannot be kept."""


@dataclass
class _Block:
    """A table as it stands in the file, with the comments above it.

    Attributes:
        path: its name; empty for what stands above the first table.
        array: it is one of a [[list]].
        lines: comments above, the header, keys.
    """

    path: tuple[str, ...]
    array: bool
    lines: list[str] = field(default_factory=list)


def rewritten(text: str, wanted: Mapping[str, Any]) -> str:
    """Return the text of a file with exactly the wanted values.

    Args:
        text: a TOML file.
        wanted: all its values, as `tomllib` reads them.

    Raises:
        CommentsLostError: its form does not allow it; write `plain(wanted)` instead.
    """
    blocks = _blocks(text)
    present = tomllib.loads(text)
    _change(blocks, (), present, wanted)
    for name in _arrays(present) | _arrays(wanted):
        if not all(isinstance(values.get(name) or [], list) for values in (present, wanted)):
            raise CommentsLostError(
                f"{name} is a list of tables in one of both only: its comments cannot be kept"
            )
        _change_array(blocks, name, present.get(name) or [], wanted.get(name) or [])
    new = "\n".join(line for block in blocks for line in block.lines).rstrip("\n") + "\n"
    try:
        same = tomllib.loads(new) == wanted
    except tomllib.TOMLDecodeError:
        same = False
    if not same:
        raise CommentsLostError(
            "this file is written in a way that cannot be changed line by line (dotted keys or values over several "
            "lines): its comments cannot be kept"
        )
    return new


def plain(wanted: Mapping[str, Any]) -> str:
    """Return a file with the wanted values and no comments."""
    lines = _pairs({key: value for key, value in wanted.items() if not _is_table(value)})
    for key, value in wanted.items():
        if isinstance(value, Mapping):
            lines += _table((key,), value, array=False)
        elif _is_table(value):
            for entry in value:
                lines += _table((key,), entry, array=True)
    return "\n".join(lines).strip("\n") + "\n"


def toml_value(value: Any) -> str:
    """Return a value as TOML writes it."""
    match value:
        case bool():
            return "true" if value else "false"
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case Mapping():
            inner = ", ".join(f"{_key(name)} = {toml_value(one)}" for name, one in value.items())
            return f"{{ {inner} }}" if inner else "{}"
        case list() | tuple():
            return f"[{', '.join(toml_value(one) for one in value)}]"
        case _:
            return repr(value)


def _blocks(text: str) -> list[_Block]:
    lines = text.splitlines()
    blocks, i = [_Block((), array=False)], 0
    while i < len(lines):
        header = _HEADER.match(lines[i])
        if header:
            path = tuple(part.strip().strip('"') for part in header["name"].split("."))
            block = _Block(path, header["open"] == "[[", _comments_above(blocks[-1]))
            blocks.append(block)
        # A line within a value over several lines is no header.
        after = i + 1 if header else _after_value(lines, i)
        blocks[-1].lines += lines[i:after]
        i = after
    return blocks


def _comments_above(block: _Block) -> list[str]:
    """Take the comments right above a header from the table before."""
    start = len(block.lines)
    while start and block.lines[start - 1].lstrip().startswith("#"):
        start -= 1
    if start == 0 and not block.path:
        # The head of the file stays where it is.
        return []
    taken = block.lines[start:]
    del block.lines[start:]
    return taken


def _after_value(lines: list[str], start: int) -> int:
    """Return the line after the value that begins on a line."""
    if not _KEY.match(lines[start]):
        return start + 1
    for end in range(start + 1, min(start + _LONGEST_VALUE, len(lines)) + 1):
        if _parses("\n".join(lines[start:end])):
            return end
    return start + 1


def _parses(text: str) -> bool:
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return False
    return True


def _change(
    blocks: list[_Block], path: tuple[str, ...], present: Mapping[str, Any], wanted: Mapping[str, Any]
) -> None:
    """Bring one table and those within it to the wanted values."""
    block = next((block for block in blocks if block.path == path and not block.array), None)
    within = {other.path[: len(path) + 1] for other in blocks}
    for key in [*present, *(key for key in wanted if key not in present)]:
        inner = (*path, key)
        if not path and key in _arrays(present) | _arrays(wanted):
            continue
        if present.get(key) == wanted.get(key) and (key in present) == (key in wanted):
            continue
        value = wanted.get(key)
        if isinstance(value, Mapping) and (inner in within or not (block and key in present)):
            _change_table(blocks, inner, present.get(key) or {}, value)
            continue
        # A table that is no longer wanted goes, also where a single value takes its place.
        blocks[:] = [other for other in blocks if other.path[: len(inner)] != inner]
        if block is not None:
            _change_key(block, key, value)


def _change_table(
    blocks: list[_Block], path: tuple[str, ...], present: Mapping[str, Any], wanted: Mapping[str, Any]
) -> None:
    if not any(block.path == path for block in blocks):
        plain_keys = {key: value for key, value in wanted.items() if not isinstance(value, Mapping)}
        _insert(blocks, _Block(path, array=False, lines=_table(path, plain_keys, array=False)))
        present = plain_keys
    _change(blocks, path, present, wanted)


def _insert(blocks: list[_Block], new: _Block) -> None:
    """Put a table behind the others of its section, or at the end."""
    places = [i for i, block in enumerate(blocks) if block.path[:1] == new.path[:1]]
    place = places[-1] + 1 if places else len(blocks)
    before = blocks[place - 1].lines
    if before and before[-1].strip():
        before.append("")
    blocks.insert(place, new)


def _change_key(block: _Block, key: str, value: Any) -> None:
    """Set a key; None takes it out, and leaves the comments above it."""
    found = _line_of(block, key)
    if found is None:
        if value is not None:
            block.lines.insert(_end_of_keys(block), f"{_key(key)} = {toml_value(value)}")
        return
    start, end = found
    if value is None:
        del block.lines[start:end]
        return
    remark = _remark(block.lines[end - 1])
    line = f"{_key(key)} = {toml_value(value)}"
    block.lines[start:end] = [f"{line:<39} {remark}" if remark else line]


def _line_of(block: _Block, key: str) -> tuple[int, int] | None:
    i = 0
    while i < len(block.lines):
        found = _KEY.match(block.lines[i])
        end = _after_value(block.lines, i)
        if found and found["key"] == key:
            return i, end
        i = end
    return None


def _end_of_keys(block: _Block) -> int:
    end = len(block.lines)
    while end and not block.lines[end - 1].strip():
        end -= 1
    return end


def _remark(line: str) -> str:
    """Return the comment behind a value: from the first # that is in no string."""
    for i in (i for i, letter in enumerate(line) if letter == "#"):
        before = line[:i].strip()
        if _parses(before) or (before.endswith(("]", "}")) and not _KEY.match(line)):
            return line[i:].rstrip()
    return ""


def _change_array(
    blocks: list[_Block], name: str, present: list[dict[str, Any]], wanted: list[dict[str, Any]]
) -> None:
    """Bring a [[list]] to the wanted entries; those that are still there keep their lines."""
    if present == wanted:
        return
    groups = _entries(blocks, name)
    if len(groups) != len(present):
        raise CommentsLostError(f"{name} is not written as tables [[{name}]]: its comments cannot be kept")
    place = blocks.index(groups[0][0]) if groups else len(blocks)
    gone = [block for group in groups for block in group]
    blocks[:] = [block for block in blocks if not any(block is one for one in gone)]
    kept = {str(entry.get("name")): (entry, group) for entry, group in zip(present, groups, strict=True)}
    new = [block for entry in wanted for block in _entry(name, entry, kept.get(str(entry.get("name"))))]
    if place and blocks[place - 1].lines and blocks[place - 1].lines[-1].strip():
        blocks[place - 1].lines.append("")
    blocks[place:place] = new


def _entry(
    name: str, wanted: dict[str, Any], kept: tuple[dict[str, Any], list[_Block]] | None
) -> list[_Block]:
    if kept is not None:
        present, group = kept
        flat = not any(isinstance(value, Mapping) for value in (*present.values(), *wanted.values()))
        if present == wanted or flat:
            for key in [*present, *wanted]:
                if present.get(key) != wanted.get(key):
                    _change_key(group[0], key, wanted.get(key))
            return group
    return [_Block((name,), array=True, lines=_table((name,), wanted, array=True))]


def _entries(blocks: list[_Block], name: str) -> list[list[_Block]]:
    """Return the tables of each entry of a [[list]]."""
    groups: list[list[_Block]] = []
    for block in blocks:
        if block.path == (name,) and block.array:
            groups.append([block])
        elif groups and block.path[:1] == (name,):
            groups[-1].append(block)
    return groups


def _table(path: tuple[str, ...], values: Mapping[str, Any], *, array: bool) -> list[str]:
    name = ".".join(_key(part) for part in path)
    inline = {key: value for key, value in values.items() if array or not isinstance(value, Mapping)}
    lines = [f"[[{name}]]" if array else f"[{name}]", *_pairs(inline), ""]
    for key, value in values.items():
        if key not in inline:
            lines += _table((*path, key), value, array=False)
    return lines


def _pairs(values: Mapping[str, Any]) -> list[str]:
    return [f"{_key(key)} = {toml_value(value)}" for key, value in values.items()]


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else toml_value(name)


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and all(isinstance(one, Mapping) for one in value)
    )


def _arrays(values: Mapping[str, Any]) -> set[str]:
    """Return the names of the [[lists]]."""
    return {key for key, value in values.items() if isinstance(value, list) and _is_table(value)}
