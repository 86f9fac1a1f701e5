"""What every screen may ask of the program: orders to the engine, STOP, errors, work that outlives a screen."""

import asyncio
import traceback
from collections.abc import Callable, Coroutine, Mapping
from typing import TYPE_CHECKING, Any, Literal

from textual.app import App
from textual.notifications import SeverityLevel

from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.questions import ConfirmDialog, MotionDialog
from catseye.app.tui.session import Session
from catseye.app.tui.stopping import StopOp

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.requests import AnyRequest


class Program(App[int]):
    """The program as its screens know it.

    Attributes:
        begins: a run is asked for, and is being planned.
    """

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.begins = False
        self._tasks: set[asyncio.Task[None]] = set()
        self._faults: set[str] = set()
        self._waiting: list[asyncio.Future[None]] = []

    def action_go(self, name: str) -> None:
        """Show a screen."""
        self.switch_mode(name)

    def action_hold(self) -> None:
        """Hold the run at its next checkpoint."""
        self._order_plain("hold", "The run cannot be held")

    def action_ask_to_go_on(self) -> None:
        """Say what moves when a held run is let go; F8 there, and nothing else, has it go on."""
        # The first screen is painted before this is imported.
        from catseye.app.tui.going_on import going_on_lines, hold_changed

        engine, now_s = self.session.link.engine, self.session.now_s
        if engine.run is None or not engine.held:
            self.notify("no run is held")
            return
        dialog = MotionDialog(
            "Continue the run",
            "\n".join(going_on_lines(engine, engine.run, now_s())),
            hold_changed(engine),
            now_s,
        )
        self.push_screen(dialog, lambda agreed: self._go_on() if agreed else None)

    def action_stop(self) -> None:
        """Stop the arm now."""
        self.keep(self._stop("stop"))

    def action_abort(self) -> None:
        """Abort the run."""
        self.keep(self._stop("abort"))

    def action_clear(self) -> None:
        """Clear an abort."""
        self._order_plain("clear", "The abort is not cleared", control=True, done="cleared")

    def action_reset_alarm(self) -> None:
        """Show the controller's alarm; y there resets it, and no other one that has come meanwhile."""
        robot = self.session.link.engine.robot
        if robot is None or not robot.alarm_number:
            self.notify("the controller is in no alarm")
            return
        number, text = robot.alarm_number, robot.alarm_text
        if not robot.resets_alarms:
            self.show_error("This alarm is confirmed at the controller's pendant, not here", text)
            return

        def answered(agreed: bool | None) -> None:
            if agreed:
                fields: dict[str, str | int] = {"op": "reset-alarm", "number": number, "text": text}
                self.order_of(fields, "The alarm is not reset", done=f"alarm {number} is reset")

        about = f"{text}\n\nRemove its cause first. The reset moves nothing; the drives stay as they are."
        self.push_screen(ConfirmDialog(f"Reset alarm {number}?", about, "reset it", "leave it"), answered)

    def action_take_control(self) -> None:
        """Take control; from somebody else only after a question, and by force: whoever has it is informed."""
        engine = self.session.link.engine
        if engine.control is None or engine.in_control:
            self._take_control(force=False)
            return
        holder = engine.control.text
        text = (
            f"{holder} has control and will see that you take it. Whoever has control answers the questions and lets "
            "the run go on."
        )

        def answered(agreed: bool | None) -> None:
            if agreed:
                self._take_control(force=True)

        self.push_screen(ConfirmDialog(f"Take control from {holder}?", text, "take it", "leave it"), answered)

    def action_release(self) -> None:
        """Give control back."""
        self._order_plain("release", "Control was not given back", done="control given back")

    def order(
        self,
        request: "AnyRequest",
        failure: str,
        *,
        control: bool = False,
        done: str = "",
        then: Callable[[], None] | None = None,
    ) -> asyncio.Task[None]:
        """Have the engine do something; a refusal is shown with its remedy. Returns at once what ends with it.

        Args:
            failure: title of the error when it is not done.
            control: take control first when nobody has it.
            done: shown when it is done.
            then: called when it is done.
        """
        return self.keep(self._order(request, failure, control=control, done=done, then=then))

    def order_of(
        self,
        fields: Mapping[str, str | int | None],
        failure: str,
        *,
        done: str = "",
        then: Callable[[], None] | None = None,
    ) -> None:
        """Take control and order what was typed or came from a device; what no request may be is shown.

        Args:
            fields: of the request.
            failure: title of the error when it is not done.
            done: shown when it is done.
            then: called when it is done.
        """
        from catseye.app.protocol.message import MessageError
        from catseye.app.protocol.requests import request_of

        try:
            request = request_of(dict(fields))
        except MessageError as error:
            self.show_error(failure, str(error))
        else:
            self.order(request, failure, control=True, done=done, then=then)

    def notify(
        self,
        message: str,
        *,
        title: str = "",
        severity: SeverityLevel = "information",
        timeout: float | None = None,
        markup: bool = False,
    ) -> None:
        """Show a message for some time; none holds markup, and names of people and files may look like it."""
        del markup
        super().notify(message, title=title, severity=severity, timeout=timeout, markup=False)

    def show_error(self, title: str, text: str) -> None:
        """Show an error that can be copied; the same one is not shown twice over."""
        if isinstance(self.screen, ErrorDialog) and self.screen.shown == (title, text):
            return
        self.push_screen(ErrorDialog(title, text))

    def show_fault(self, error: BaseException) -> None:
        """Show a fault of this program, each once; everything else goes on."""
        if self.is_running and repr(error) not in self._faults:
            self._faults.add(repr(error))
            self.show_error("A fault of this program", _fault_text(error))

    def keep(self, action: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        """Have something go on until it is done or the program ends, whatever screen is shown."""
        task = asyncio.get_running_loop().create_task(action)
        self._tasks.add(task)
        task.add_done_callback(self._kept)
        return task

    async def end_tasks(self) -> None:
        """Cancel whatever goes on."""
        tasks = list(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def note_change(self) -> None:
        """Called after each message of the engine, and after orders."""
        waiting, self._waiting = self._waiting, []
        for one in waiting:
            if not one.done():
                one.set_result(None)

    async def changed(self) -> None:
        """Wait for the next message of the engine."""
        one = asyncio.get_running_loop().create_future()
        self._waiting.append(one)
        await one

    def _kept(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            self.show_fault(error)

    def _go_on(self) -> None:
        self._order_plain("unhold", "The run does not go on", control=True)

    def _take_control(self, *, force: bool) -> None:
        from catseye.app.protocol.requests import Control

        self.order(Control(force=force), "Control was not taken", done="control taken")

    def _order_plain(
        self,
        op: Literal["hold", "unhold", "clear", "release"],
        failure: str,
        *,
        control: bool = False,
        done: str = "",
    ) -> None:
        from catseye.app.protocol.requests import Plain

        self.order(Plain(op=op), failure, control=control, done=done)

    async def _stop(self, op: StopOp) -> None:
        try:
            await self.session.link.stop(op)
        except RefusedError as error:
            text = f"{error}: if the arm moves all the same, use the emergency stop"
            self.show_error(f"There is nothing to {op}", text)
        except ServiceError as error:
            self.show_error(
                f"{op.upper()} IS NOT CONFIRMED: use the emergency stop if the arm moves", str(error)
            )
        self.note_change()

    async def _order(
        self,
        request: "AnyRequest",
        failure: str,
        *,
        control: bool,
        done: str,
        then: Callable[[], None] | None,
    ) -> None:
        begins = request.op in {"start", "resume"}
        self.begins = self.begins or begins
        try:
            if control:
                await self.session.take_free_control()
            await self.session.link.request(request)
        except (RefusedError, ServiceError) as error:
            self.show_error(failure, str(error))
            return
        finally:
            self.begins = self.begins and not begins
        if done:
            self.notify(done)
        if then is not None:
            then()
        self.note_change()


def _fault_text(error: BaseException) -> str:
    """Return what happened and where, to be copied into a report."""
    where = "".join(traceback.format_exception(error)).strip()
    return (
        "Engine and run go on; F12 stops the arm. What is shown may be incomplete: quit with Ctrl-Q (leave the run "
        f"running) and start catseye tui again.\n\n{where}"
    )
