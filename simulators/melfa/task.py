"""The task slot: which program is selected, and its execution (sheet, sections 1.9 and 1.10).

There is one task; the slot in the header of a request has to exist, and leads to it. A program is carried out
line by line, as `catseye.simulators.melfa.flow` leads, each motion and delay up to its end. A line that is not
understood stops the program with alarm 4220.

STEP carries out one line, goes on like RUN to the end of the cycle, or goes one line back. The sheet has no more of
it than its letters. Assumed are that a program pauses behind the line, that one which has not begun begins at its
top, that a breakpoint does not keep a single step back, and that one step back carries out the last motion before the
line (or, if so chosen, the line before) and leaves the program there.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import ArmControl
from catseye.simulators.melfa.breakpoints import Breakpoints
from catseye.simulators.melfa.flow import Flow, Step
from catseye.simulators.melfa.programs import EXTENSION, ProgramMemory
from catseye.simulators.melfa.resident import Resident, Stage


class Task:
    """The selected program.

    Args:
        residents: programs without lines, by name.
    """

    def __init__(
        self, controller: ArmControl, memory: ProgramMemory, residents: Mapping[str, Resident]
    ) -> None:
        self._controller = controller
        self._memory = memory
        self._residents = residents
        self.program = ""
        self.running = False
        self.paused = False
        self.repeat = True
        self.cycle_stop = False
        self._place = 0
        self._turn = 0
        self._begun_s = 0.0
        self._flow = Flow(controller)
        self._single = self._steps = self._stays = self._passes = False
        self.breakpoints = Breakpoints()

    @property
    def file_name(self) -> str:
        """Name of the selected program's file, empty when none is selected."""
        return f"{self.program}.{EXTENSION}" if self.program else ""

    @property
    def line(self) -> int:
        """Number of the line that is next or being carried out, 0 when there is none."""
        numbers = self._numbers
        return numbers[self._place] if self._place < len(numbers) else 0

    @property
    def line_text(self) -> str:
        """The line it stands at, with its number; empty without one."""
        return self.text_of(self.line) if self.line else ""

    def text_of(self, number: int) -> str:
        """Return a line of the program with its number."""
        return f"{number} {self._memory.find(self.program).lines[number]}"

    def load(self, name: str) -> None:
        """Select a program.

        Raises:
            Refusal: one runs or is paused, or there is none of that name.
        """
        self._require_stopped()
        if self.paused:
            raise Refusal(alarms.PROGRAM_PAUSED)
        self._memory.find(name)
        self.program = self._memory.key(name)
        self._place = 0

    def go_to(self, number: int) -> None:
        """Let the program go on at another line.

        Raises:
            Refusal: it runs, none is selected, or it has no such line.
        """
        self._require_stopped()
        if not self.program:
            raise Refusal(alarms.NOTHING_SELECTED)
        if number not in self._numbers:
            raise Refusal(alarms.OUT_OF_RANGE)
        self._place = self._numbers.index(number)

    def start(self, name: str, *, repeat: bool) -> None:
        """Start the program, or let it go on where it was stopped.

        Raises:
            Refusal: the controller is not in a state to start, or there is no such program.
        """
        if self._start_resident(name):
            return
        self._require_stopped()
        self._controller.require_start()
        if name and self._memory.key(name) != self.program:
            self.load(name)
        if not self.program:
            raise Refusal(alarms.NOTHING_SELECTED)
        self.repeat = repeat
        self._begin(single=False, steps=False)

    def step(self, *, single: bool) -> None:
        """Carry out one line, or go on to the end of the cycle.

        Raises:
            Refusal: the controller is not in a state to start, or no program is selected.
        """
        self._require_step()
        self._begin(single=single, steps=True)

    def step_back(self) -> None:
        """Carry out the last motion before the line, or the line before it, and stand there.

        Raises:
            Refusal: the controller is not in a state to start, or there is nothing before the line.
        """
        self._require_step()
        place: int | None = self._place - 1 if self._place else None
        if self._controller.choices.step_back == "motion":
            place = self._flow.motion_before(self._memory.find(self.program).lines, self._place)
        if place is None:
            raise Refusal(alarms.OUT_OF_RANGE)
        self._place = place
        self._begin(single=True, steps=True, stays=True)

    @property
    def stepping(self) -> bool:
        """The program runs by STEP."""
        return self.running and self._steps

    def pause(self) -> None:
        """Stop after what is under way; `start` goes on with the same line."""
        if self.running:
            self.running, self.paused = False, True
            self._turn += 1
            self._flow.halt()

    def reset(self) -> None:
        """Begin at the top next time, and let another program be selected.

        Raises:
            Refusal: it runs, or one that waits for its PC.
        """
        self._require_stopped()
        self._require_at_rest(self._residents.values())
        self._flow.begin()
        self.paused = False
        self._place = 0
        for resident in self._residents.values():
            resident.reset()

    @property
    def _numbers(self) -> list[int]:
        return list(self._memory.find(self.program).lines) if self._memory.has(self.program) else []

    def _start_resident(self, name: str) -> bool:
        """Start what has no lines to carry out; RUN without a name lets the halted ones go on."""
        if name:
            named = self._residents.get(self._memory.key(name))
            started = [] if named is None else [named]
        else:
            started = [resident for resident in self._residents.values() if resident.stage is Stage.HALTED]
        self._require_at_rest(started)
        if started:
            self._controller.require_start()
            self._controller.stopped = False
        for resident in started:
            resident.start()
        return bool(started)

    def _require_step(self) -> None:
        self._require_stopped()
        self._controller.require_start()
        if not self._numbers:
            raise Refusal(alarms.NOTHING_SELECTED)

    def _begin(self, *, single: bool, steps: bool, stays: bool = False) -> None:
        """Carry out lines from where the program stands.

        Args:
            single: one line only.
            steps: by STEP: without another cycle.
            stays: the program stands at the line that is carried out, not behind it.
        """
        # It may have paused at a breakpoint.
        self._passes = self.paused or single
        if not self.paused:
            self._flow.begin()
            self._begun_s = self._controller.bench.time_s
            self._controller.variables.update(self._memory.find(self.program).positions)
        self.running, self.paused, self.cycle_stop = True, False, False
        self._single, self._steps, self._stays = single, steps, stays
        self._controller.stopped = False
        self._next()

    def _require_stopped(self) -> None:
        if self.running:
            raise Refusal(alarms.WHILE_RUNNING)

    def _require_at_rest(self, residents: Iterable[Resident]) -> None:
        tolerated = self._controller.choices.reset_while_running
        if not tolerated and any(resident.running for resident in residents):
            raise Refusal(alarms.WHILE_RUNNING)

    def _next(self) -> None:
        bench, self._turn = self._controller.bench, self._turn + 1
        turn = self._turn
        due_s = bench.time_s + self._controller.choices.line_time_s
        bench.call_at(due_s, lambda: self._carry_out(turn))

    def _carry_out(self, turn: int) -> None:
        if turn != self._turn:
            return
        if not self.line:
            self._finish_cycle()
            return
        if not self._passes and self.breakpoints.reached(self.program, self.line):
            self.pause()
            return
        self._passes = False
        try:
            step = self._flow.carry_out(self._memory.find(self.program).lines, self._place)
        except Refusal as refusal:
            self._fail(refusal)
            return
        self._wait_for(step, turn)

    def _wait_for(self, step: Step, turn: int) -> None:
        """Go on when what the line has begun is over."""
        if step.begin is not None:
            try:
                step.begin(lambda: self._go_on(step, turn))
            except Refusal as refusal:
                self._fail(refusal)
        elif step.run is None:
            self._go_on(step, turn)
        else:
            self._controller.bench.call_at(step.run.end_s, lambda: self._go_on(step, turn))

    def _fail(self, refusal: Refusal) -> None:
        self.pause()
        self._controller.raise_alarm(refusal.number)

    def _go_on(self, step: Step, turn: int) -> None:
        if turn != self._turn:
            return
        if not self._stays:
            self._place = step.place
        if step.halted or (self._single and self.line):
            self.pause()
        elif self.line:
            self._next()
        else:
            self._finish_cycle()

    def _finish_cycle(self) -> None:
        memory, now_s = self._memory, self._controller.bench.time_s
        if memory.has(self.program):
            program = memory.find(self.program)
            took_s = now_s - self._begun_s
            counted = replace(
                program, cycles=program.cycles + 1, last_s=took_s, total_s=program.total_s + took_s
            )
            memory.put(self.program, counted)
        self._place, self._begun_s = 0, now_s
        self._flow.begin()
        if self.repeat and not self.cycle_stop and not self._steps and self._numbers:
            self._next()
        else:
            self.running = False
