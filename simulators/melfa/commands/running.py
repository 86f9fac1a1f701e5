"""Run control: servo, override, program selection and start, stop, direct execution (sheet, section 1.9)."""

import re

from catseye.simulators.melfa import alarms, statements
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import Run
from catseye.simulators.melfa.commands.command import Client, Command, do, required_number, say, show, whole
from catseye.simulators.melfa.controller import Controller


def _latch_stop(controller: Controller) -> None:
    controller.stop_latched = True
    controller.stop()


def _release_stop(controller: Controller) -> None:
    controller.stop_latched = False


def _stop_after_cycle(controller: Controller) -> None:
    # A motion of direct execution is no cycle and goes on.
    controller.task.cycle_stop = True


def _set_override(controller: Controller, arguments: str) -> str:
    percent = required_number(arguments)
    if not 1.0 <= percent <= 100.0:
        raise Refusal(alarms.OUT_OF_RANGE)
    # Clients send decimals; the panel knows whole per cent.
    controller.override_percent = round(percent)
    return str(controller.override_percent)


def _run(controller: Controller, arguments: str) -> str:
    name, _, mode = arguments.partition(";")
    if mode not in {"", "0", "1"}:
        raise Refusal(alarms.OUT_OF_RANGE)
    if name.strip():
        controller.memory.find(name)
    controller.task.start(name.strip(), repeat=mode != "1")
    return ""


def _load(controller: Controller, arguments: str) -> str:
    controller.task.load(arguments)
    return ""


def _neighbour(controller: Controller, step: int) -> str:
    names = controller.memory.names
    if not names:
        raise Refusal(alarms.NO_PROGRAM)
    here = names.index(controller.task.program) if controller.task.program in names else -max(step, 0)
    controller.task.load(names[(here + step) % len(names)])
    return ""


def _set_line(controller: Controller, arguments: str) -> str:
    controller.task.go_to(whole(arguments, 0, 99_999))
    return ""


def _enable_start(controller: Controller, *, on: bool) -> str:
    controller.start_enabled = on
    return ""


def _execute(controller: Controller, arguments: str) -> str:
    _direct(controller, arguments)
    return ""


def _execute_and_wait(controller: Controller, client: Client, arguments: str) -> str | Run:
    del client
    return _direct(controller, arguments) or ""


def _direct(controller: Controller, statement: str) -> Run | None:
    if controller.task.running:
        raise Refusal(alarms.WHILE_RUNNING)
    try:
        return statements.execute(controller, statement)
    except Refusal as refusal:
        if refusal.number in alarms.OUT_OF_REACH and controller.choices.limit_raises_alarm:
            controller.raise_alarm(refusal.number)
        raise


def _to_rest(controller: Controller) -> str:
    if controller.task.running:
        raise Refusal(alarms.WHILE_RUNNING)
    controller.move(controller.config.start_joints)
    return ""


def _hand(controller: Controller, arguments: str, *, is_open: bool) -> str:
    if re.fullmatch(r"[1-8]", arguments) is None:
        raise Refusal(alarms.OUT_OF_RANGE)
    hands = controller.signals.open_hands
    (hands.add if is_open else hands.discard)(int(arguments))
    return ""


def _set_tool(controller: Controller, arguments: str) -> str:
    controller.tool = whole(arguments.removeprefix("="), 0, statements.LAST_TOOL)
    return ""


def _low_speed(controller: Controller, arguments: str) -> str:
    del controller
    whole(arguments, 0, 1)
    return ""


def _reset_outputs(controller: Controller) -> None:
    controller.signals.outputs.clear()


COMMANDS = {
    "SRVON": Command(do(Controller.switch_servo_on), right=True),
    "SRVOFF": Command(do(Controller.switch_servo_off), right=True),
    "OVRD": Command(show(lambda c: str(c.override_percent))),
    "OVRD=": Command(say(_set_override), arguments=True, right=True),
    "RUN": Command(say(_run), arguments=True, right=True, alone=True),
    "STOP": Command(do(Controller.stop)),
    "STOPON": Command(do(_latch_stop)),
    "STOPOFF": Command(do(_release_stop)),
    "CSTOP": Command(do(_stop_after_cycle)),
    "RSTALRM": Command(do(Controller.reset_alarm)),
    "SLOTINIT": Command(do(lambda c: c.task.reset())),
    "RSTPRG": Command(do(lambda c: c.task.reset())),
    "RSTIO": Command(do(_reset_outputs)),
    "PRGLOAD=": Command(say(_load), arguments=True, right=True),
    "PRGUP": Command(show(lambda c: _neighbour(c, -1)), right=True),
    "PRGDOWN": Command(show(lambda c: _neighbour(c, 1)), right=True),
    "PRGRD": Command(show(lambda c: c.task.file_name)),
    "LINENO": Command(show(lambda c: str(c.task.line))),
    "LINENO=": Command(say(_set_line), arguments=True, right=True),
    "LINERD": Command(show(lambda c: c.task.line_text)),
    "AUEON": Command(show(lambda c: _enable_start(c, on=True))),
    "AUEOFF": Command(show(lambda c: _enable_start(c, on=False))),
    "ATENA": Command(show(lambda c: str(int(not c.start_enabled or c.stop_latched)))),
    "MLOCKON": Command(do(lambda c: c.lock_machine(on=True))),
    "MLOCKOFF": Command(do(lambda c: c.lock_machine(on=False))),
    "HNDON": Command(say(lambda c, a: _hand(c, a, is_open=True)), arguments=True),
    "HNDOFF": Command(say(lambda c, a: _hand(c, a, is_open=False)), arguments=True),
    "MOVSP": Command(show(_to_rest), right=True),
    # The hand of an upright arm is always aligned.
    "ALIGN": Command(do(Controller.require_ready), right=True),
    "TOOLSET": Command(say(_set_tool), arguments=True),
    "TOOLRD": Command(show(lambda c: str(c.tool))),
    "SAFE=": Command(say(_low_speed), arguments=True),
    "EXEC": Command(say(_execute), arguments=True, right=True),
    "EXEC2=": Command(_execute_and_wait, arguments=True, right=True),
}
