"""Parameters (sheet, section 1.14). The list of changed ones comes as in PAL: more follow, count, names."""

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.commands.command import Client, Command, say, unknown
from catseye.simulators.melfa.controller import Controller

_NAMES_IN_ONE_ANSWER = 20


def _read(controller: Controller, arguments: str) -> str:
    return controller.parameters.read(arguments)


def _write(controller: Controller, arguments: str) -> str:
    name, _, values = arguments.partition(";")
    controller.parameters.write(name, values)
    return ""


def _changed(controller: Controller, client: Client, arguments: str) -> str:
    if arguments not in {"0", "1"}:
        raise Refusal(alarms.OUT_OF_RANGE)
    first = client.places.get("parameters", 0) if arguments == "1" else 0
    names = controller.parameters.changed[first : first + _NAMES_IN_ONE_ANSWER]
    client.places["parameters"] = first + len(names)
    more = int(first + len(names) < len(controller.parameters.changed))
    listed = "\v".join(names)
    return f"{more};{len(names)};{listed}"


COMMANDS = {
    "PNR": Command(say(_read), arguments=True),
    "PAR": Command(say(_read), arguments=True),
    "PRM=": Command(say(_write), arguments=True),
    "PAW=": Command(say(_write), arguments=True),
    "PAW2=": Command(say(_write), arguments=True),
    "PMR=": Command(_changed, arguments=True),
    # Seen on the wire and undocumented; without this entry it would be the parameter CRC=....
    "PARCRC=": Command(unknown, arguments=True),
}
