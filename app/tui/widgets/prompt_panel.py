"""The open question: what is asked, what to do, and how to answer. Nothing is answered by leaning on a key."""

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.message import Message
from textual.widgets import Button, Input, Label

from catseye.app.results.numbers import duration_text
from catseye.app.tui.dialogs.questions import READ_S
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from catseye.app.tui.widgets.static_text import StaticText, lines
from catseye.app.tui.widgets.task_picture import task_picture

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from catseye.app.protocol.run_events import PromptAsked
    from catseye.app.protocol.scara.layout import ReflectorPlace
    from catseye.procedures.kit.context import Prompt


_SETTLE_S: Final = 0.5
"""A key that was meant for something else, pressed as a question came onto the screen, answers nothing."""


class PromptPanel(Vertical):
    """Docked above the log while a question is open; gone otherwise.

    Args:
        now_s: monotonic time, s.
    """

    DEFAULT_CSS = """
    PromptPanel { height: auto; max-height: 14; border: heavy $warning; padding: 0 1; display: none; }
    PromptPanel.open { display: block; }
    PromptPanel #asked { height: auto; max-height: 6; scrollbar-size-vertical: 1; }
    PromptPanel #question { text-style: bold; height: auto; }
    PromptPanel #task, PromptPanel #motion, PromptPanel #refused { height: auto; }
    PromptPanel #motion, PromptPanel .motion, PromptPanel #ahead { color: $warning; }
    PromptPanel #ahead { height: 1; text-wrap: nowrap; text-overflow: ellipsis; display: none; }
    PromptPanel .motion { text-style: bold; margin-right: 2; }
    PromptPanel #refused { color: $error; }
    PromptPanel #answers { height: 1; }
    PromptPanel Button { height: 1; min-width: 10; border: none; margin-right: 2; }
    PromptPanel Input { height: 1; width: 1fr; background: $boost; }
    PromptPanel Input.short { width: 24; }
    PromptPanel #unit { width: 1fr; }
    """

    class Answered(Message):
        """A person has decided."""

        def __init__(self, prompt: str, text: str) -> None:
            super().__init__()
            self.prompt = prompt
            self.text = text

    def __init__(self, now_s: Callable[[], float]) -> None:
        super().__init__(id="prompt")
        self._now_s = now_s
        self._asked: PromptAsked | None = None
        self._prompt: Prompt | None = None
        self._at_s = 0.0
        self._pressed_s = -math.inf
        self._laid_out: PromptAsked | None = None
        self._seen_s: float | None = None
        self._chosen = ""
        self._ahead = ""

    def compose(self) -> ComposeResult:
        """Question, task, motion, answers, refusal."""
        # However long a question is, the keys that answer it stay in sight.
        with VerticalScroll(id="asked", can_focus=False):
            yield StaticText(id="question")
        yield StaticText(id="task")
        yield StaticText(id="motion")
        yield StaticText(id="ahead")
        yield Horizontal(id="answers")
        yield StaticText(id="refused")

    @property
    def asked(self) -> "PromptAsked | None":
        """The open question."""
        return self._asked

    def show(
        self,
        asked: "PromptAsked | None",
        at_s: float,
        speed: float,
        note: str,
        reflectors: "Sequence[ReflectorPlace]",
        ahead: str = "",
    ) -> None:
        """Show the open question, or nothing.

        Args:
            asked: the question; None where none is open.
            at_s: when it came, monotonic s.
            speed: bench seconds in one real second; the time to answer is bench time.
            note: who may answer, when that is not this client.
            ahead: how far the arm goes after it, and what was rehearsed; empty where nothing moves.
        """
        now_s = self._now_s()
        if (asked and asked.id) != (self._asked and self._asked.id) or at_s != self._at_s:
            self._asked, self._at_s, self._seen_s = asked, at_s, None
            self._prompt = None if asked is None else asked.prompt
            self._chosen = ""
            self.set_class(asked is not None, "open")
            self.run_worker(self._lay_out(asked), group="prompt", exclusive=True, exit_on_error=False)
        if asked is not None:
            drawn = task_picture(asked.task, reflectors)
            self._show_part("task", Content("\n".join(drawn)))
            self._ahead = ahead
            self._show_part("ahead", Content(ahead))
            set_title(self, f"Question {asked.id}" + (f"  ({note})" if note else ""))
            set_subtitle(self, _time_left(asked, now_s - at_s, speed))
        if self._seen_s is None and self._laid_out is asked and self.screen.is_current and self.is_on_screen:
            self._seen_s = now_s

    def refuse(self, prompt: str, text: str) -> None:
        """Say beside the question why an answer was refused.

        Args:
            prompt: id of the question that was answered.
            text: why it was refused.
        """
        if self._asked is not None and self._asked.id == prompt:
            self._show_part("refused", Content(f"✗ {text}"))

    def come_up(self) -> None:
        """Be seen from now on: another screen was before it. What is typed, or the safe answer, has the focus."""
        self._seen_s = None
        self.take_focus()

    def take_focus(self) -> None:
        """Put the keyboard's focus on what is typed, or on the safe answer."""
        for each in self.query("#answers .first"):
            each.focus()

    def yes(self) -> None:
        """Answer yes where no motion follows."""
        if self._kind() == "confirm" and self._moves("yes"):
            self._refuse("the arm moves after this answer: F8 confirms it, n refuses")
        elif self._kind() == "confirm":
            self._answer("yes")

    def no(self) -> None:
        """Answer no."""
        if self._kind() == "confirm":
            self._answer("no")

    def choose(self, number: int) -> None:
        """Choose by number, from 1."""
        choices = () if self._prompt is None else self._prompt.choices
        if self._kind() != "choice" or not 1 <= number <= len(choices):
            return
        chosen = choices[number - 1]
        if self._moves(chosen):
            self._chosen = chosen
            self._refuse(f"the arm moves after {chosen}: F8 confirms it")
        else:
            self._answer(chosen)

    @property
    def motion(self) -> str:
        """The open question and the motion that follows on it; empty where none does."""
        if self._asked is None or not self.agreement:
            return ""
        shown = (self._asked.text, _motion_text(self._asked).plain, self._ahead)
        text = "\n".join(part for part in shown if part)
        return text if self._asked.kind == "confirm" else f"{text}\nThe answer is: {self.agreement}"

    @property
    def agreement(self) -> str:
        """The answer that lets the arm move; empty where none does."""
        prompt = self._prompt
        if prompt is None:
            return ""
        match prompt.kind:
            case "confirm":
                answer = "yes"
            case "choice":
                answer = self._chosen or prompt.choices[0]
            case _:
                answer = "" if self._fault_of_typed() else self._typed()
        return answer if answer and prompt.moves_after(answer) else ""

    def move(self) -> None:
        """Agree to a motion; F8 that is held down, or was not pressed for this question, agrees to nothing."""
        before_s, self._pressed_s = self._pressed_s, self._now_s()
        read = self._seen_s is not None and self._pressed_s - max(before_s, self._seen_s) >= READ_S
        if self.agreement and not read:
            self._refuse("read it, then press F8 once")
        elif self.agreement:
            self._answer(self.agreement)
        elif self._asked is not None and self._asked.motion:
            self._refuse(self._why_not_moving())

    def _why_not_moving(self) -> str:
        """Return why F8 answers nothing."""
        if self._kind() == "choice":
            return "first choose by number an answer after which the arm moves"
        return self._fault_of_typed() or "the arm does not move after this answer: press Enter"

    def on_button_pressed(self, event: Button.Pressed) -> None:
        """Take the answer of a button."""
        event.stop()
        self._answer(str(event.button.name))

    def on_input_changed(self, event: Input.Changed) -> None:
        """Judge a number as it is typed."""
        event.stop()
        self._show_part("refused", Content(""))
        if event.value.strip() and (fault := self._fault_of_typed()):
            self._refuse(fault)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Take what was typed; an empty line answers nothing."""
        event.stop()
        if fault := self._fault_of_typed():
            self._refuse(fault)
        elif self._moves(self._typed()):
            self._refuse(f"the arm moves after {self._typed()}: F8 confirms it")
        else:
            self._answer(self._typed())

    def _typed(self) -> str:
        return "".join(each.value.strip() for each in self.query(Input))

    def _fault_of_typed(self) -> str:
        """Return why what is typed answers nothing; empty when it does."""
        if self._prompt is None:
            return ""
        fault = self._prompt.fault_of(self._typed())
        return fault or ("" if self._typed() else f"type an answer{self._prompt.in_unit}")

    def _answer(self, text: str) -> None:
        if self._asked is None or self._seen_s is None or self._now_s() - self._seen_s < _SETTLE_S:
            return
        self._show_part("refused", Content(""))
        self.post_message(self.Answered(self._asked.id, text))

    def _show_part(self, name: str, text: Content) -> None:
        """Show a part; an empty one takes no room."""
        part = self.query_one(f"#{name}", StaticText)
        part.set_text(text)
        part.display = bool(text.plain)

    def _refuse(self, text: str) -> None:
        self._show_part("refused", Content(f"✗ {text}"))

    def _kind(self) -> str:
        return "" if self._prompt is None else self._prompt.kind

    def _moves(self, answer: str) -> bool:
        return self._prompt is not None and self._prompt.moves_after(answer)

    async def _lay_out(self, asked: "PromptAsked | None") -> None:
        for name in ("question", "task", "motion", "refused"):
            self._show_part(name, Content(""))
        answers = self.query_one("#answers")
        await answers.remove_children()
        if asked is None:
            return
        self._show_part("question", Content(asked.text))
        self._show_part("motion", _motion_text(asked))
        await answers.mount_all(_answers(asked.prompt))
        self._laid_out = asked
        if self.screen.is_current:
            self.take_focus()


def _answers(prompt: "Prompt") -> list[Button | Input | Label]:
    """Return what an answer is given by; the safe one has the keyboard's focus, so Enter moves nothing."""
    match prompt.kind:
        case "confirm":
            moves = prompt.moves_after("yes")
            safe = prompt.safe_answer or ("" if moves else "no")
            agree = (
                Label("F8  done: the arm may move", classes="motion")
                if moves
                else _button("y", "yes", "yes", safe)
            )
            return [_button("n", "no", "no", safe), agree]
        case "choice":
            return [
                Label(_motion_label(number, choice), classes="motion", markup=False)
                if prompt.moves_after(choice)
                else _button(str(number), choice, choice, prompt.safe_answer or "")
                for number, choice in enumerate(prompt.choices, 1)
            ]
        case "number":
            unit = Label(prompt.unit, id="unit", markup=False)
            then = ", then F8" if prompt.motion else ""
            return [Input(placeholder=f"number{then}", compact=True, classes="first short"), unit]
    then = "F8: the arm may move" if prompt.motion else "Enter"
    return [Input(placeholder=f"text, then {then}", compact=True, classes="first")]


def _motion_label(number: int, choice: str) -> str:
    keys = "F8" if number == 1 else f"{number} F8"
    # Three of these have to stand side by side on 80 columns.
    return f"{keys}  {choice}: arm moves"


def _button(key: str, label: str, answer: str, safe: str) -> Button:
    """Return a button; without a safe answer none has the focus, and Enter answers nothing."""
    button = Button(
        Content(f"{key}  {label}"), name=answer, compact=True, classes="first" if answer == safe else ""
    )
    button.can_focus = bool(safe)
    return button


def _motion_text(asked: "PromptAsked") -> Content:
    """Say where the arm goes, how fast, at which override."""
    if not asked.motion:
        return Content("")
    where = "to the next pose of the plan" if asked.kind in {"confirm", "choice"} else "as the answer says"
    if asked.target:
        named = zip(asked.axes, asked.target, strict=False)
        where = f"to {', '.join(axis.text(value) for axis, value in named)}"
    shown = [Content(f"THE ARM THEN MOVES, {where}")]
    if asked.override_percent is not None:
        speeds = ", ".join(f"{speed:.0f}" for speed in asked.speed_deg_s or ())
        turning = ", ".join(axis.name for axis in asked.axes if axis.unit == "deg")
        fast = f"; joints up to {speeds} deg/s ({turning})" if speeds else ""
        shown.append(Content(f"at {asked.override_percent:g} % override{fast}"))
    return lines(*shown)


def _time_left(asked: "PromptAsked", open_s: float, speed: float) -> str:
    if asked.timeout_s is None:
        return ""
    left_s = max(asked.timeout_s / speed - open_s, 0.0)
    return f"{duration_text(left_s)} left, then {asked.safe_answer or 'the run ends'}"
