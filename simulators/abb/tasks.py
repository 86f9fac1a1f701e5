"""rw/rapid: execution, tasks and symbols."""

from catseye.simulators.abb.calls import Call
from catseye.simulators.abb.http import Answer
from catseye.simulators.abb.program import TASK
from catseye.simulators.abb.rapid import ReadOnlyError, Symbol, UnknownSymbolError, ValueTextError
from catseye.simulators.abb.replies import NO_VALUE, NOT_FOUND, NOTHING, REFUSED, RefusedError, State
from catseye.simulators.errors import EmulatorError

_CYCLES = frozenset({"asis", "once", "forever"})


def execution(call: Call) -> Answer:
    """Return whether programs run."""
    fields = {"ctrlexecstate": execution_state(call), "cycle": call.controller.cycle}
    return call.said(State("rap-execution", "execution", fields))


def execution_state(call: Call) -> str:
    """Return running or stopped."""
    return "running" if call.controller.program.running else "stopped"


def change_execution(call: Call) -> Answer:
    """Start or stop programs, or set their pointers to main."""
    controller = call.controller
    match call.request.query.get("action"):
        case "stop":
            controller.control.hold()
        case "start":
            _start(call)
        case "resetpp":
            call.require_mastership("rapid")
            if controller.program.running:
                raise RefusedError(403, REFUSED, "the program runs")
            controller.program.reset_pointer()
        case action:
            raise RefusedError(400, NO_VALUE, f"there is no action {action}")
    return NOTHING


def _start(call: Call) -> None:
    cycle = call.request.form.get("cycle", ["asis"])[-1]
    if cycle not in _CYCLES:
        raise RefusedError(400, NO_VALUE, f"{cycle} is no cycle")
    try:
        call.controller.start(cycle)
    except EmulatorError as error:
        raise RefusedError(403, REFUSED, str(error)) from None


def tasks(call: Call) -> Answer:
    """Return the only task."""
    controller = call.controller
    fields = {
        "name": TASK,
        "type": "normal",
        "taskstate": "linked",
        "excstate": "started" if controller.program.running else "stopped",
        "active": "On" if controller.active else "Off",
        "motiontask": "TRUE",
    }
    return call.said(State("rap-task-li", TASK, fields))


def change_task(call: Call) -> Answer:
    """Activate or deactivate a task."""
    action = call.request.query.get("action")
    if call.parts != (TASK,) or action not in {"activate", "deactivate"}:
        raise RefusedError(404, NOT_FOUND, "there is no such task or action")
    if call.controller.program.running:
        raise RefusedError(403, REFUSED, "the program runs")
    call.controller.active = action == "activate"
    return NOTHING


def symbol_value(call: Call) -> Answer:
    """Return the value of data."""
    url = call.parts[0]
    try:
        value = call.controller.symbols.read(url)
    except UnknownSymbolError:
        raise _unknown(url) from None
    return call.said(State("rap-data", url, {"value": value}))


def set_symbol_value(call: Call) -> Answer:
    """Give data a value."""
    url, text = call.parts[0], call.value("value")
    if call.request.query.get("action", "set") != "set":
        raise RefusedError(404, NOT_FOUND, "there is no such action")
    call.require_mastership("rapid")
    try:
        call.controller.symbols.write(url, text)
    except UnknownSymbolError:
        raise _unknown(url) from None
    except ReadOnlyError:
        raise RefusedError(403, REFUSED, f"{url} is not to be written") from None
    except ValueTextError:
        raise RefusedError(400, NO_VALUE, f"{text[:40]} is no value of {url}") from None
    return NOTHING


def search_symbols(call: Call) -> Answer:
    """Return symbols within a block."""
    if call.request.query.get("action", "search-symbols") != "search-symbols":
        raise RefusedError(404, NOT_FOUND, "there is no such action")
    wanted = {name: values[-1] for name, values in call.request.form.items()}
    kind, pattern = wanted.get("symtyp", "any"), wanted.get("regexp", "")
    found = call.controller.symbols.search(wanted.get("blockurl", "RAPID"), kind, pattern)
    return call.said(*(_symbol(url, symbol) for url, symbol in found))


def _symbol(url: str, symbol: Symbol) -> State:
    fields = {"symburl": url, "name": url.rpartition("/")[2], "symtyp": "per" if symbol.read else "prc"}
    if symbol.read:
        return State("rap-symproppers-li", url, fields | {"dattyp": symbol.kind})
    return State("rap-sympropproc-li", url, fields)


def _unknown(url: str) -> RefusedError:
    return RefusedError(404, NOT_FOUND, f"there is no {url}")
