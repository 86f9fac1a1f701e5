"""Program directory and files (sheet, section 1.14). The only files are those of the programs.

PDIR and FDIR take the place in the list; FDIR<*.* asks for the first of all.
"""

import re
from dataclasses import replace

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.commands.command import Client, Command, OpenFile, clock, place_in, say, show
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.programs import EXTENSION, TOTAL_BYTES, Program

_ALL = "<*.*"
_BLOCK_BYTES = 100
_LARGEST_FILE = 65_536
_FILE_LINE = re.compile(r"(\d{1,5}) (.{1,127})")


def _directory(controller: Controller, client: Client, arguments: str) -> str:
    place = _place(controller, client, arguments)
    if place is None:
        return ""
    name = controller.memory.names[place]
    program = controller.memory.find(name)
    counted = f"{_count_and_free(controller)};" if arguments == "TOP" else ""
    size = f"{_entry(name, program)};{counted}{_attributes(program)};"
    return f"{size};{len(program.lines)};{len(program.positions)};{program.cycle_times}"


def _file_directory(controller: Controller, client: Client, arguments: str) -> str:
    place = _place(controller, client, arguments)
    if place is None:
        return ""
    name = controller.memory.names[place]
    program = controller.memory.find(name)
    counted = f"{_count_and_free(controller)};" if arguments in {"TOP", _ALL} else ""
    return f"{_entry(name, program)};{counted}{_attributes(program)}"


def _place(controller: Controller, client: Client, which: str) -> int | None:
    length = len(controller.memory.names)
    if which.isascii() and which.isdecimal():
        number = int(which[:6])
        return number - 1 if 1 <= number <= length else None
    return place_in(client, "directory", "TOP" if which == _ALL else which, length)


def _entry(name: str, program: Program) -> str:
    return f"{name}.{EXTENSION};{len(program.text)};{clock(program.changed_s, '%y-%m-%d%H:%M:%S')}"


def _count_and_free(controller: Controller) -> str:
    return f"{len(controller.memory.names)};{TOTAL_BYTES - controller.memory.used_bytes}"


def _attributes(program: Program) -> int:
    return ("p" in program.attributes) + 2 * ("q" in program.attributes)


def _check(controller: Controller, arguments: str) -> str:
    return "N" if controller.memory.has(arguments) else "F"


def _path(controller: Controller, arguments: str) -> str:
    return f"{controller.memory.key(arguments.removeprefix('='))}.{EXTENSION}"


def _copy(controller: Controller, arguments: str) -> str:
    source, _, target = arguments.partition(";")
    _require_new(controller, target)
    program = controller.memory.find(source)
    controller.memory.put(
        target, replace(program, lines=dict(program.lines), positions=dict(program.positions))
    )
    return ""


def _delete(controller: Controller, arguments: str) -> str:
    _require_idle(controller, arguments)
    if "p" in controller.memory.find(arguments).attributes:
        raise Refusal(alarms.FILE)
    controller.memory.remove(arguments)
    return ""


def _rename(controller: Controller, arguments: str) -> str:
    source, _, target = arguments.partition(";")
    _require_idle(controller, source)
    _require_new(controller, target)
    controller.memory.put(target, controller.memory.remove(source))
    return ""


def _require_new(controller: Controller, name: str) -> None:
    controller.memory.key(name)
    if controller.memory.has(name):
        raise Refusal(alarms.FILE)


def _require_idle(controller: Controller, name: str) -> None:
    """Raise a refusal for a program that runs or is paused."""
    controller.memory.find(name)
    task = controller.task
    if (task.running or task.paused) and controller.memory.key(name) == task.program:
        raise Refusal(alarms.FILE)


def _attribute(controller: Controller, arguments: str) -> str:
    name, _, words = arguments.partition(";")
    program = controller.memory.find(name)
    attributes = set(program.attributes)
    for word in words.split("/"):
        if word not in {"+p", "-p", "+q", "-q"}:
            raise Refusal(alarms.SYNTAX)
        (attributes.add if word[0] == "+" else attributes.discard)(word[1])
    controller.memory.put(name, replace(program, attributes=frozenset(attributes)))
    return ""


def _open(controller: Controller, client: Client, arguments: str) -> str:
    name, _, mode = arguments.partition(";")
    if client.file is not None or mode not in {"r", "w"}:
        raise Refusal(alarms.FILE)
    key = controller.memory.key(name)
    text = controller.memory.find(key).text if mode == "r" else ""
    client.file = OpenFile(key, mode, bytearray(text.encode("latin-1")))
    return ""


def _read(controller: Controller, client: Client, arguments: str) -> str:
    del controller, arguments
    file = _opened(client, "r")
    block = bytes(file.content[:_BLOCK_BYTES])
    del file.content[:_BLOCK_BYTES]
    return f"{block.hex().upper()};{int(bool(file.content))}"


def _write(controller: Controller, client: Client, arguments: str) -> str:
    del controller
    file = _opened(client, "w")
    count, _, digits = arguments.partition(";")
    if re.fullmatch(r"(?:[0-9A-Fa-f]{2})*", digits) is None or count != str(len(digits) // 2):
        raise Refusal(alarms.SYNTAX)
    if len(file.content) + len(digits) // 2 > _LARGEST_FILE:
        raise Refusal(alarms.FILE)
    file.content += bytes.fromhex(digits)
    return ""


def _opened(client: Client, mode: str) -> OpenFile:
    if client.file is None or client.file.mode != mode:
        raise Refusal(alarms.FILE)
    return client.file


def _close(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    file, client.file = client.file, None
    if file is None:
        raise Refusal(alarms.FILE)
    if file.mode == "w":
        _require_free(controller, file.name)
        controller.memory.put(
            file.name, Program(_lines(bytes(file.content)), changed_s=controller.bench.time_s)
        )
    return ""


def _require_free(controller: Controller, name: str) -> None:
    if controller.memory.has(name):
        _require_idle(controller, name)


def _lines(content: bytes) -> dict[int, str]:
    """Return the lines of a written file; what is no numbered line makes it no program."""
    found = [_FILE_LINE.fullmatch(line) for line in content.decode("latin-1").splitlines() if line.strip()]
    if not all(found):
        raise Refusal(alarms.FILE)
    return dict(sorted((int(line[1]), line[2]) for line in found if line))


def _memory(controller: Controller) -> str:
    used = controller.memory.used_bytes
    return f"{TOTAL_BYTES};{used};{100 * used // TOTAL_BYTES}"


COMMANDS = {
    "PDIR": Command(_directory, arguments=True),
    "PDIRTOP": Command(lambda c, who, _a: _directory(c, who, "TOP")),
    "FDIR": Command(_file_directory, arguments=True),
    "FCHECK": Command(say(_check), arguments=True),
    "FPATH": Command(say(_path), arguments=True),
    "FCOPY": Command(say(_copy), arguments=True),
    "FDEL": Command(say(_delete), arguments=True),
    "FRENAME": Command(say(_rename), arguments=True),
    "FATTRIB": Command(say(_attribute), arguments=True),
    "FOPEN": Command(_open, arguments=True),
    "FREAD": Command(_read),
    "FWRITE": Command(_write, arguments=True),
    "FCLOSE": Command(_close),
    "EFREE": Command(show(_memory)),
}
