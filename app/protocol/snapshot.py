"""What a client has to know when it comes."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from catseye.app.protocol.engine_events import Client, DrivesFields, JogFields, LeftOverride
from catseye.app.protocol.loss import LossPolicy
from catseye.app.protocol.message import Message, absent
from catseye.app.protocol.run_events import LiveShown, Progressed, PromptAsked, StepStarted
from catseye.app.protocol.state import ControlState


def _none_if_empty(value: object) -> object:
    return value or None


class Snapshot(Message):
    """Engine, clients and run as they are now; the last fields only an engine that outlives its runs fills.

    Attributes:
        engine: its software.
        protocol: version of the messages.
        pid: of its process.
        you: name of this client.
        clients: all, in the order in which they came.
        control: who holds it; the terminal of a run that hosts itself is client "console".
        on_client_lost: what becomes of the run when that client is lost.
        run: name of the run under way; None between runs, as all about it.
        path: of its record.
        procedure: its name.
        title: one line for people.
        simulated: all devices are emulated; None until they are known.
        state: of run or idle engine.
        reason: why it is in that state.
        step: under way.
        prompt: the open question.
        prompt_open_s: for how long it has been open, real s.
        progress: the last.
        live: the last live value.
        cell: cell file of the engine.
        runs: folder of all runs.
        aborted: why nothing begins before somebody has cleared it.
        drives: what becomes of drives that a run has left on.
        jog: the jog under way.
        emulated_speed: bench seconds in one real second of emulators that live as long as the engine.
        override_left: what a jog has left of the speed override; None where nothing is to be set again.
    """

    engine: str
    protocol: int
    pid: int
    you: str | None
    clients: tuple[Client, ...]
    control: Client | None
    on_client_lost: LossPolicy
    run: str | None
    path: str | None
    procedure: str | None
    title: str | None
    simulated: bool | None
    state: ControlState
    reason: str | None
    step: StepStarted | None = None
    prompt: PromptAsked | None = None
    prompt_open_s: float | None = None
    progress: Progressed | None = None
    live: LiveShown | None = None
    cell: str | None = None
    runs: str | None = None
    aborted: str | None = None
    drives: DrivesFields | None = None
    jog: Annotated[JogFields | None, BeforeValidator(_none_if_empty)] = None
    emulated_speed: float | None = Field(default=None, exclude_if=absent)
    override_left: LeftOverride | None = Field(default=None, exclude_if=absent)

    @property
    def in_control(self) -> bool:
        """The client that this is for holds control."""
        return self.control is not None and self.control.client == self.you
