"""The IRC5 that all clients share: its panel, the arm, the RAPID task that moves it, signals, files and events."""

from functools import partial

from catseye.simulators.abb.arm_control import MODES, ArmControl
from catseye.simulators.abb.events import EventLog
from catseye.simulators.abb.failing import Failing
from catseye.simulators.abb.program import MODULE, TASK, CatsAbb, declarations
from catseye.simulators.abb.rapid import Symbol, Symbols, Value
from catseye.simulators.config import SerialArm
from catseye.simulators.errors import EmulatorError
from catseye.simulators.world.serial.bench import SerialBench
from catseye.simulators.world.serial.screws import ScrewArm
from catseye.simulators.world.timekeeper import TimeKeeper


class AbbController:
    """What all clients of one controller share.

    Args:
        arm: as its maker describes it.
        keeper: bench time.

    Attributes:
        bench: on which the arm stands.
        keeper: bench time.
        control: of the arm.
        program: that moves it.
        symbols: of the task.
        events: of the event log.
        name: of the system.
        screws: geometry of the arm, as the controller believes it.
        active: the task may be started.
        cycle: how often a program is carried out.
        signals: values by network, unit and name.
        files: by their paths.
        queues: messages by the name of their queue.
        starts: how often its power came back.
        failing: what the web server answers with an error; None: nothing.
    """

    def __init__(self, bench: SerialBench, arm: SerialArm, keeper: TimeKeeper) -> None:
        self.bench = bench
        self.keeper = keeper
        self.control = ArmControl(bench, keeper.changed)
        self.events = EventLog(lambda: bench.time_s)
        self.program = CatsAbb(arm, self.control, keeper, self.events.add)
        self.symbols = Symbols(TASK)
        self.name = f"{arm.name.replace(' ', '_').upper()}_EMULATOR"
        self.screws = ScrewArm(arm.joints)
        self.active = True
        self.cycle = "forever"
        self.signals: dict[str, str] = {}
        self.files: dict[str, bytes] = {}
        self.queues: dict[str, list[dict[str, str]]] = {}
        self.starts = 0
        self.failing: Failing | None = None
        self._install()
        self.events.add(10002, "Program pointer has been reset")

    @property
    def servo_on(self) -> bool:
        """The motors hold the arm."""
        return self.control.servo_on

    @property
    def alarm(self) -> int:
        """Number of the failure that keeps the program from running, 0 for none."""
        return self.control.alarm

    def raise_alarm(self, number: int) -> None:
        """Let the system fail."""
        self.events.add(50_000 + number, f"System failure {number}")
        self.control.raise_alarm(number)

    def set_emergency_stop(self, *, on: bool) -> None:
        """Open or close the emergency stop circuit."""
        if on:
            self.events.add(10013, "Emergency stop state")
        self.control.set_emergency_stop(on=on)

    def set_teach_mode(self, *, on: bool) -> None:
        """Turn the mode switch to manual, or back to automatic."""
        self.control.set_mode("MANR" if on else "AUTO")

    def switch_servo_off(self) -> None:
        """Stop the arm and take the power off."""
        self.control.switch_servo_off()

    def lose_power(self) -> None:
        """Stop the arm and start anew: program pointer, interrupted path, data, files and event log are kept."""
        self.control.lose_power()
        self.signals.clear()
        self.queues.clear()
        self.starts += 1

    def clear_faults(self) -> None:
        """Release and confirm everything, turn the switch back, power the motors, start the program from main."""
        self.failing = None
        self.control.emergency_stop = False
        self.control.confirm()
        self.control.mode = "AUTO"
        self.control.switch_servo_on()
        if not self.program.running:
            self.program.reset_pointer()
            self.program.start()

    def press(self, key: str) -> None:
        """Press a button of panel or pendant, turn the mode switch, or open a safeguard.

        Raises:
            EmulatorError: it has no effect now.
        """
        match key:
            case "start":
                self.start("forever")
            case "main":
                self.program.reset_pointer()
            case "stop":
                self.control.hold()
            case "confirm":
                self.control.confirm()
            case "drives":
                self.control.switch_servo_on()
            case "guard":
                self.control.open_guard()
            case _ if key in MODES:
                self.control.set_mode(key)
            case _:
                raise EmulatorError(f"the panel of an IRC5 has no key {key!r}")

    def start(self, cycle: str) -> None:
        """Start the program where its pointer is.

        Raises:
            EmulatorError: it does not start.
        """
        if not self.control.ready or self.control.state != "motoron":
            raise EmulatorError(f"the program does not start: the controller is in {self.control.state}")
        if not self.active:
            raise EmulatorError("the program does not start: no task is active")
        if self.program.running:
            raise EmulatorError("the program runs already")
        if cycle != "asis":
            self.cycle = cycle
        self.events.add(10050, "Program started")
        self.program.start()

    def _install(self) -> None:
        for name, value in declarations().items():
            kind = "jointtarget" if isinstance(value, list) else "num"
            read = partial(self.program.data.__getitem__, name)
            self.symbols.add(name, Symbol(MODULE, kind, read, partial(self._set, name)))
        for name in ("main", "cats_take", "cats_move"):
            self.symbols.add(name, Symbol(MODULE, ""))

    def _set(self, name: str, value: Value) -> None:
        self.program.data[name] = value
        self.program.written()
