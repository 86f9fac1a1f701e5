"""Program editing (sheet, section 1.14).

LISTL answers like VALS: lines separated by VT, then their count and whether more follow; no source gives its
layout.
"""

import re

from catseye.simulators.melfa import alarms, statements
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.commands.command import Client, Command, place_in, whole
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.programs import Program
from catseye.simulators.melfa.values import value_text

_LINE = re.compile(r"\s*(\d{1,5})(?:\s(.*))?", re.DOTALL)
_VARIABLE = re.compile(r"\s*([JP][A-Z0-9_]{0,15})\s*=\s*(\(.*)", re.IGNORECASE | re.DOTALL)
_LONGEST_LIST = 200
_LAST_LINE = 32_767


def _load(controller: Controller, client: Client, arguments: str) -> str:
    controller.editor.open(arguments, client)
    return ""


def _save(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    controller.editor.save(client)
    return ""


def _discard(controller: Controller, client: Client, arguments: str) -> str:
    """Close what is open; nothing has to be (sheet, section 1.14)."""
    del arguments
    if controller.editor.name:
        controller.editor.draft(client)
    controller.editor.discard(client)
    return ""


def _write_line(controller: Controller, client: Client, arguments: str) -> str:
    draft = controller.editor.draft(client)
    if (found := _VARIABLE.fullmatch(arguments)) is not None:
        name = found[1].upper()
        controller.editor.declare(client, name, statements.constant(controller, found[2].upper(), name[0]))
        return ""
    found = _LINE.fullmatch(arguments)
    if found is None:
        raise Refusal(alarms.SYNTAX, place=";1")
    if not found[2]:
        draft.lines.pop(int(found[1]), None)
        return ""
    controller.editor.write(client, int(found[1]), found[2].rstrip())
    return ""


def _write_lines(controller: Controller, client: Client, arguments: str) -> str:
    for place, line in enumerate(re.split(r"[\v\n]", arguments), start=1):
        try:
            _write_line(controller, client, line)
        except Refusal as refusal:
            raise Refusal(refusal.number, place=f";{place}{refusal.place or ';1'}") from None
    return ""


def _insert(controller: Controller, client: Client, arguments: str) -> str:
    """Lines from that number on move up by one where they have to make room."""
    number, _, text = arguments.partition(";")
    draft, at = controller.editor.draft(client), whole(number, 1, _LAST_LINE)
    moved = dict(draft.lines)
    last = at
    while last in moved:
        last += 1
    for n in range(last, at, -1):
        moved[n] = moved[n - 1]
    controller.editor.write(client, at, text)
    controller.editor.sort(draft, {**moved, at: draft.lines[at]})
    return ""


def _list_line(controller: Controller, client: Client, arguments: str) -> str:
    draft = controller.editor.draft(client)
    number = _line_number(draft, client, arguments)
    return "" if number is None else f"{number} {draft.lines[number]}"


def _list_lines(controller: Controller, client: Client, arguments: str) -> str:
    draft = controller.editor.draft(client)
    first = _line_number(draft, client, arguments)
    if first is None:
        return ""
    numbers = [number for number in draft.lines if number >= first]
    entries: list[str] = []
    while len(entries) < len(numbers) and sum(map(len, entries)) < _LONGEST_LIST:
        number = numbers[len(entries)]
        entries.append(f"{number} {draft.lines[number]}")
    client.places["lines"] = list(draft.lines).index(numbers[len(entries) - 1])
    listed = "\v".join(entries)
    return f"{listed};{len(entries)};{int(len(entries) < len(numbers))}"


def _line_number(draft: Program, client: Client, which: str) -> int | None:
    numbers = list(draft.lines)
    if which.isascii() and which.isdecimal():
        wanted = int(which[:6])
        if wanted not in draft.lines:
            return None
        client.places["lines"] = numbers.index(wanted)
        return wanted
    place = place_in(client, "lines", which, len(numbers))
    return None if place is None else numbers[place]


def _list_position(controller: Controller, client: Client, arguments: str) -> str:
    positions = controller.editor.draft(client).positions
    names = sorted(positions)
    name = arguments.strip().upper()
    if name not in positions:
        if name not in {"TOP", "END", "+1", "-1"}:
            return ""
        place = place_in(client, "positions", name, len(names))
        if place is None:
            return ""
        name = names[place]
    return f"{name}={value_text(positions[name])}"


def _count(controller: Controller, client: Client, arguments: str) -> str:
    # Counting asks for no open program: an empty edit slot has no lines.
    if not controller.editor.name:
        return "0000"
    return f"{len(_range(controller.editor.draft(client), arguments)):04d}"


def _delete(controller: Controller, client: Client, arguments: str) -> str:
    draft = controller.editor.draft(client)
    for number in _range(draft, arguments):
        del draft.lines[number]
    return ""


def _range(draft: Program, arguments: str) -> list[int]:
    first, _, last = arguments.partition(";")
    low = whole(first, 0, 2**31) if first else 0
    high = whole(last, 0, 2**31) if last else 2**31
    return [number for number in draft.lines if low <= number <= high]


def _renumber(controller: Controller, client: Client, arguments: str) -> str:
    """Arguments: new first number, old first, step, old last; 0 or nothing: 10, top, 10, bottom."""
    draft = controller.editor.draft(client)
    first, old_first, step, old_last = [
        whole(part, 0, _LAST_LINE) if part else 0 for part in [*arguments.split(";"), "", "", "", ""][:4]
    ]
    chosen = [n for n in draft.lines if old_first <= n <= (old_last or _LAST_LINE)]
    new = [(first or 10) + (step or 10) * place for place in range(len(chosen))]
    kept = {n: text for n, text in draft.lines.items() if n not in chosen}
    if any(n in kept or n > _LAST_LINE for n in new):
        raise Refusal(alarms.OUT_OF_RANGE)
    renumbered = {n: draft.lines[old] for n, old in zip(new, chosen, strict=True)}
    controller.editor.sort(draft, {**kept, **renumbered})
    return ""


def _clear(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    draft = controller.editor.draft(client)
    draft.lines.clear()
    draft.positions.clear()
    return ""


COMMANDS = {
    "LOAD=": Command(_load, arguments=True),
    "SAVE": Command(_save),
    "NEW": Command(_discard),
    "EDATA": Command(_write_line, arguments=True),
    "EMDAT": Command(_write_lines, arguments=True),
    "EDINS=": Command(_insert, arguments=True),
    "LISTI": Command(_list_line, arguments=True),
    "LISTL": Command(_list_lines, arguments=True),
    "LISTP": Command(_list_position, arguments=True),
    "LISTCNT": Command(_count, arguments=True, alone=True),
    "DELETE": Command(_delete, arguments=True, alone=True),
    "RENUM": Command(_renumber, arguments=True, alone=True),
    "ECLR": Command(_clear),
}
