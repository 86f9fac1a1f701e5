"""Variables (sheet, section 1.14).

A name whose second letter is an underscore is global. A list of one class begins with `<;class`, the first of all.
VALS and GVALS answer as many variables as fit into one answer; the client asks on with +1.
"""

from catseye.simulators.melfa import alarms, statements
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.commands.command import Client, Command, place_in, say
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.values import value_text

_TYPES = {"M", "C", "P", "J"}
_LONGEST_LIST = 200


def _read(controller: Controller, client: Client, arguments: str, *, is_global: bool) -> str:
    which, separator, kind = arguments.partition(";")
    if not separator:
        return _entry(controller, arguments.strip().upper())
    names = _names(controller, kind, is_global=is_global)
    place = place_in(client, f"VAL{kind}{is_global}", which, len(names))
    return "" if place is None else _entry(controller, names[place])


def _read_several(controller: Controller, client: Client, arguments: str, *, is_global: bool) -> str:
    which, _, kind = arguments.partition(";")
    names = _names(controller, kind, is_global=is_global)
    place = place_in(client, f"VALS{kind}{is_global}", which, len(names))
    if place is None:
        return ""
    entries: list[str] = []
    while place < len(names) and sum(map(len, entries)) < _LONGEST_LIST:
        entries.append(_entry(controller, names[place]))
        place += 1
    client.places[f"VALS{kind}{is_global}"] = place - 1
    listed = "\v".join(entries)
    return f"{listed};{len(entries)};{int(place < len(names))}"


def _names(controller: Controller, kind: str, *, is_global: bool) -> list[str]:
    if kind not in _TYPES:
        raise Refusal(alarms.OUT_OF_RANGE)
    return sorted(n for n in controller.variables if n[0] == kind and (n[1:2] == "_") == is_global)


def _entry(controller: Controller, name: str) -> str:
    return f"{name}={value_text(statements.read(controller, name))}"


def _write(controller: Controller, arguments: str) -> str:
    name, separator, value = arguments.partition("=")
    if not separator:
        raise Refusal(alarms.SYNTAX)
    statements.assign(controller, name.strip().upper(), value.strip().upper())
    return ""


def _write_running(controller: Controller, arguments: str) -> str:
    """Write behind the name of a program, which has to exist."""
    program, _, assignment = arguments.partition(";")
    if controller.memory.key(program) not in controller.residents:
        controller.memory.find(program)
    return _write(controller, assignment)


def _type(controller: Controller, arguments: str) -> str:
    name = arguments.strip().upper()
    statements.read(controller, name)
    return name[0]


COMMANDS = {
    "VAL": Command(lambda c, who, a: _read(c, who, a, is_global=False), arguments=True),
    "VAL=": Command(say(_write), arguments=True),
    "VALS": Command(lambda c, who, a: _read_several(c, who, a, is_global=False), arguments=True),
    "GVAL": Command(lambda c, who, a: _read(c, who, a, is_global=True), arguments=True),
    "GVALS": Command(lambda c, who, a: _read_several(c, who, a, is_global=True), arguments=True),
    "HOT": Command(say(_write_running), arguments=True),
    "VTYPRD": Command(say(_type), arguments=True),
}
