"""The robot controller that all clients share: the arm's control, programs, signals and the operation right."""

from collections.abc import Callable

from catseye.simulators.config import EmulationConfig
from catseye.simulators.errors import EmulatorError
from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import ArmControl
from catseye.simulators.melfa.choices import Choices
from catseye.simulators.melfa.jogging import Jog
from catseye.simulators.melfa.parameters import Parameters
from catseye.simulators.melfa.programs import Editor, Program, ProgramMemory
from catseye.simulators.melfa.resident import Resident
from catseye.simulators.melfa.task import Task
from catseye.simulators.world.timed_bench import TimedBench


class Controller(ArmControl):
    """What all clients of one controller share.

    Args:
        config: limits, nominal links, delays.
        changed: called when a motion ends at another moment than it would have.
        choices: what no source says of a controller.
    """

    def __init__(
        self,
        bench: TimedBench,
        config: EmulationConfig,
        changed: Callable[[], None],
        choices: Choices | None = None,
    ) -> None:
        super().__init__(bench, config, changed, choices)
        self.teach_mode = False
        self.right_holders: set[object] = set()
        self.parameters = Parameters(config)
        self.memory = ProgramMemory()
        self.editor = Editor(self.memory, lambda: bench.time_s)
        self.residents: dict[str, Resident] = {}
        self.task = Task(self, self.memory, self.residents)
        self.jog = Jog(self)
        self.largest_seen: dict[str, tuple[float, ...]] = {}
        self._started_anew = False
        self.on_interrupt.append(self._halt)

    @property
    def program_running(self) -> bool:
        """The selected program is carried out."""
        return self.task.running

    @property
    def executing(self) -> bool:
        """Something is carried out: a motion, the selected program, or a program that waits for its PC."""
        waits = any(resident.running for resident in self.residents.values())
        return self.arm.moving or self.task.running or waits

    def install(self, resident: Resident) -> None:
        """Keep a program whose behaviour is emulated without an interpreter; after a start anew nobody started it."""
        name = self.memory.key(resident.name)
        self.memory.put(name, Program(lines={1: "' carried out by the emulator, line by line it is empty"}))
        self.residents[name] = resident
        if self._started_anew:
            resident.reset()

    def set_teach_mode(self, *, on: bool) -> None:
        """Turn the key: the arm stops, and in TEACH the operation right is gone."""
        self.teach_mode = on
        self.stopped = True
        self.interrupt(alarms.STOP_IS_ON)
        if on and not self.choices.teach_keeps_right:
            self.right_holders.clear()

    def take_right(self, client: object) -> None:
        """Give a client the right to operate.

        Raises:
            Refusal: the key is at TEACH, or another client has the right; both only if so chosen.
        """
        if self.teach_mode and not self.choices.teach_keeps_right:
            raise Refusal(alarms.PENDANT_ENABLED)
        if self.choices.exclusive_right and self.right_holders - {client}:
            raise Refusal(alarms.NO_OPERATION_RIGHT)
        self.right_holders.add(client)

    def lock_machine(self, *, on: bool) -> None:
        """Let motions be carried out without the arm, or with it again; nothing may lead it meanwhile.

        Raises:
            Refusal: something moves, or a program has the arm.
        """
        leads = self.task.running or any(resident.busy for resident in self.residents.values())
        if leads and on == (self.machine_lock is None):
            raise Refusal(alarms.WHILE_RUNNING)
        super().lock_machine(on=on)

    def press(self, key: str) -> None:
        """Press a key of the panel.

        Raises:
            EmulatorError: always; what an operator does to this controller are faults of the control port.
        """
        raise EmulatorError(f"the panel of a MELFA controller has no key {key!r}")

    def lose_power(self) -> None:
        """Stop the arm and start anew: stored programs, parameters, error log, key and emergency stop stay."""
        self.switch_servo_off()
        self.task.pause()
        for resident in self.residents.values():
            resident.reset()
        self._started_anew = True
        self._start_anew()
        self.right_holders.clear()
        self.editor = Editor(self.memory, lambda: self.bench.time_s)
        self.task = Task(self, self.memory, self.residents)
        self.jog = Jog(self)
        self.largest_seen.clear()
        if self.emergency_stop:
            self.raise_alarm(alarms.EMERGENCY_STOP)

    def clear_faults(self) -> None:
        """Close the emergency stop circuit, turn the key back and reset the alarm."""
        self.emergency_stop = False
        self.teach_mode = False
        self.reset_alarm()

    def _halt(self, number: int) -> None:
        # A program that switches the servo off itself, at rest, goes on.
        if number != alarms.SERVO_IS_OFF or self.arm.moving:
            self.task.pause()
        for resident in self.residents.values():
            resident.halt(number)
        self.jog.forget()
