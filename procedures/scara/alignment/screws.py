"""Guided turning of a screw until a measured quantity is small enough: measure, say what to turn, measure again."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Final, Literal

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.beam.loss import BeamLoss, BeamLossPolicy, Cause, LossLog
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import AlignmentError, BeamLostError
from catseye.procedures.kit.expanded import EXPANDED, expanded_text
from catseye.procedures.kit.live import Live, in_band
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.kit.tasks import TurnScrew
from catseye.procedures.scara.beam.nests import Nests
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.arrival import Arrival
from catseye.procedures.scara.questions import SCREW, SCREW_BEAM_LOST, SCREW_SENSE
from catseye.procedures.scara.records import AlignmentRound, ScrewTurn

ROUND_S: Final = 60.0
"""Expected time of a round, hands included; the run's own pace corrects it."""

_POLICY: Final = BeamLossPolicy(attempts=1, most_questions=3)
"""A measurement looks for the beam by itself before it gives up."""

_CLEAR = 3.0
"""A change is judged where it exceeds this many of its standard uncertainties."""

_HARDLY = 0.2
"""A change below this share of what was asked for means that the screw was not turned."""

_FACTOR = 0.25
"""A change that is off by more than this share means another pitch of the screw."""


@dataclass(frozen=True)
class Screw:
    """A screw, and what it does to a quantity that has to become zero.

    Attributes:
        name: as in the tasks for hands.
        label: in sentences.
        quantity: what it changes.
        unit: of the quantity.
        per_turn: change of the quantity in one turn clockwise, signed; as the cell file says, or as observed.
        plus: where the beam goes when the quantity grows.
        minus: where the beam goes when it shrinks.
        sense_key: key of the cell file with the side to which a clockwise turn moves.
        sense_values: values of that key for a quantity that grows and shrinks with clockwise turns.
        pitch_key: key of the cell file with the change in one turn.
        tolerance: largest accepted size of the quantity.
    """

    name: Literal["stage", "level"]
    label: str
    quantity: str
    unit: str
    per_turn: float
    plus: str
    minus: str
    sense_key: str
    sense_values: tuple[str, str]
    pitch_key: str
    tolerance: float

    def accepts(self, value: float, u: float) -> bool:
        """Return whether a value is within the tolerance with its expanded uncertainty, as screens show it.

        Args:
            u: standard uncertainty.
        """
        return in_band(value, -self.tolerance, self.tolerance, EXPANDED * u)

    def turns(self, change: float) -> float:
        """Return the turns, clockwise positive, that change the quantity; in hundredths, as they are instructed."""
        return round(change / self.per_turn, 2)

    def instruction(self, value: float) -> str:
        """Return what brings the quantity to zero, as an imperative without its full stop."""
        side = self.minus if value > 0.0 else self.plus
        turns = self.turns(-value)
        way = "clockwise" if turns > 0.0 else "anticlockwise"
        return f"{self.label} {abs(value):.2f} {self.unit} {side}, {abs(turns):.2f} turns {way}"

    def while_turned(self, turns: float, signal: float) -> Live:
        """Return what stands before the eyes of whoever turns the screw.

        How much of it is done nobody can tell: a retroreflector that is met off its centre returns the same length,
        and how the signal falls off its centre is not known.

        Args:
            turns: that were asked for, clockwise positive.
            signal: now, 0...1.
        """
        way = "clockwise" if turns > 0.0 else "anticlockwise"
        # A small screen has three short lines for it.
        text = f"{way}; count: neither length nor signal ({signal:.0%}) tells"
        return Live(f"{self.name} screw, turns to make", turns, "turns", text=text)

    def sense_word(self) -> str:
        """Return the value of the cell file's key for the present sense."""
        grows, shrinks = self.sense_values
        return grows if self.per_turn > 0.0 else shrinks


@dataclass(frozen=True)
class Observed:
    """The quantity as one round measured it.

    Attributes:
        value: in the screw's unit.
        u: its standard uncertainty.
        u_repeat: the part of it that differs from round to round; changes are judged by it.
    """

    value: float
    u: float
    u_repeat: float


Verdict = Literal["expected", "unclear", "not turned", "wrong way", "other pitch"]


@dataclass(frozen=True)
class Response:
    """What a turn did.

    Attributes:
        verdict: against what was asked.
        per_turn: observed change in one turn clockwise; 0 where it is not known.
    """

    verdict: Verdict
    per_turn: float


def respond(screw: Screw, before: Observed, after: Observed, turns: float) -> Response:
    """Compare the change of a quantity with what a turn should have done.

    Args:
        turns: what was asked for, clockwise positive.
    """
    asked, change = turns * screw.per_turn, after.value - before.value
    u_change = math.hypot(before.u_repeat, after.u_repeat)
    if abs(asked) <= _CLEAR * u_change or turns == 0.0:
        return Response("unclear", 0.0)
    share, u_share = change / asked, u_change / abs(asked)
    observed = change / turns
    if abs(share) < _HARDLY:
        return Response("not turned", 0.0)
    if share < 0.0:
        return Response("wrong way", observed)
    if abs(share - 1.0) > _FACTOR + _CLEAR * u_share:
        return Response("other pitch", observed)
    return Response("expected", observed)


class ScrewRounds(ABC):
    """The measurements of what a screw changes."""

    def __init__(self, ctx: Context, bench: ScaraBench) -> None:
        self._ctx = ctx
        self._bench = bench
        self._nests = Nests(ctx, bench)
        self._arrival = Arrival(ctx, bench)

    @property
    @abstractmethod
    def start(self) -> Pose:
        """Where each round begins."""

    @abstractmethod
    async def measure(self, number: int, expected: float | None, last: Row | None) -> Row:
        """Measure the quantity.

        Args:
            number: of the round.
            expected: change since the last round; None where nobody knows.
            last: what the last round returned; None at the first.

        Returns:
            A row with `value`, `u`, `u_repeat` and what else is kept.
        """

    async def _begin(self, reflector: Reflector) -> None:
        """Put the reflector in its place and go to where the round begins."""
        await self._nests.place(reflector, target=self.start)
        await self._arrival.at(self.start)


class GuidedScrew:
    """Measures and instructs round by round. Each round's measurement, judgement and turn is a step of its own.

    Args:
        max_rounds: most measurements.
        alone: the alignment is all that the run does, so its rounds are the run's progress.
    """

    def __init__(
        self, ctx: Context, screw: Screw, rounds: ScrewRounds, max_rounds: int, *, alone: bool = True
    ) -> None:
        self._ctx = ctx
        self._screw = screw
        self._rounds = rounds
        self._max_rounds = max_rounds
        self._alone = alone
        self._seen: list[Observed] = []
        self._last: Row | None = None
        self._instructions: list[str] = []
        self._turned: float | None = None
        self._fresh = False
        self._losses = LossLog(ctx)
        self._beam = BeamLoss(
            ctx,
            _POLICY,
            "the reflector",
            lambda number: f"{screw.name}/beam/{number}",
            question=SCREW_BEAM_LOST,
        )

    @property
    def turned(self) -> bool:
        """Hands were sent to the screw."""
        return bool(self._instructions)

    async def align(self) -> Row:
        """Go on until the quantity is within its tolerance.

        Returns:
            What the last round measured.

        Raises:
            AlignmentError: not within the rounds, or the operator will not turn the screw.
        """
        for number in range(1, self._max_rounds + 1):
            row = await self._round(number)
            if self._alone:
                text = f"{self._screw.quantity}, round {number}"
                self._ctx.progress(number * ROUND_S, self._max_rounds * ROUND_S, text)
            seen = self._seen[-1]
            self._show(seen)
            if self._screw.accepts(seen.value, seen.u):
                return row
            self._require_certainty(seen)
            if number > 1 and self._turned is not None:
                await self._judge(number)
            if number < self._max_rounds:
                await self._turn(number)
        raise AlignmentError(self._never())

    async def _round(self, number: int) -> Row:
        screw = self._screw
        done = self._instructions[-1] if self._instructions else ""
        expected = None if self._turned is None else self._turned * screw.per_turn

        async def action() -> Row:
            self._fresh = True
            row = await self._measured(number, expected)
            self._ctx.record(
                AlignmentRound(
                    quantity=screw.quantity,
                    value=number_of(row, "value"),
                    u=number_of(row, "u"),
                    unit=screw.unit,
                    round=number,
                    instruction=done,
                )
            )
            return row

        self._fresh = False
        row = await self._ctx.step(
            f"{screw.name}/{number}/measure", f"{screw.quantity}, round {number}", action
        )
        self._last = row
        self._seen.append(Observed(*(number_of(row, key) for key in ("value", "u", "u_repeat"))))
        return row

    async def _measured(self, number: int, expected: float | None) -> Row:
        """Measure; hands that hold something into the beam may free it and have it measured again."""
        while True:
            try:
                return await self._rounds.measure(number, expected, self._last)
            except BeamLostError as error:
                cause, where = Cause("lost", str(error)), f"{self._screw.quantity}, round {number}"
                await self._losses.note(cause, where, where=where)
                await self._beam.decide(cause, where, goal=self._rounds.start)

    async def _judge(self, number: int) -> None:
        """Look what the last turn did, and take the screw as it acts from then on."""
        before, after, turns = self._seen[-2], self._seen[-1], self._turned or 0.0
        found = respond(self._screw, before, after, turns)

        async def action() -> Row:
            per_turn = await self._settle(number, found, before, after, turns)
            return {"verdict": found.verdict, "per_turn": per_turn}

        title = f"what the {self._screw.name} screw did in round {number - 1}"
        row = await self._ctx.step(f"{self._screw.name}/{number}/judge", title, action)
        self._screw = replace(self._screw, per_turn=number_of(row, "per_turn"))

    async def _settle(
        self, number: int, found: Response, before: Observed, after: Observed, turns: float
    ) -> float:
        """Report what is wrong with a turn and return how the screw is taken to act."""
        screw, ctx = self._screw, self._ctx
        went = "grew" if abs(after.value) > abs(before.value) else "went"
        step = f"the {screw.quantity} {went} from {before.value:.2f} to {after.value:.2f} {screw.unit}"
        match found.verdict:
            case "not turned":
                await ctx.warn(
                    f"{step}: the {screw.name} screw was hardly turned, or it slips; turn it {abs(turns):.2f} turns "
                    "as asked and check that the mount follows"
                )
            case "wrong way":
                return await self._ask_sense(number, found, f"{step}: the screw acts the other way")
            case "other pitch":
                await ctx.warn(
                    f"{step}: {abs(found.per_turn):.2g} {screw.unit} a turn instead of {abs(screw.per_turn):.2g}; "
                    f"this is used from now on. Set {screw.pitch_key} = {abs(found.per_turn):.2g} in the "
                    "cell file if the screw was turned as asked"
                )
                return found.per_turn
            case "expected" | "unclear":
                pass
        return screw.per_turn

    async def _ask_sense(self, number: int, found: Response, text: str) -> float:
        screw, other = self._screw, replace(self._screw, per_turn=found.per_turn)
        way = "clockwise" if other.turns(-self._seen[-1].value) > 0.0 else "anticlockwise"
        setting = f'{other.sense_key} = "{other.sense_word()}"'
        await self._ctx.warn(f"{text}; turn it {way}, or set {setting} in the cell file")
        answer = await self._ctx.ask(
            SCREW_SENSE.prompt(
                f"{screw.name}-sense/{number - 1}",
                f"Say what happened, since {text}: is its sense reversed ({setting} would say so), or was it "
                "turned the wrong way?",
            )
        )
        return found.per_turn if answer == "reversed" else screw.per_turn

    async def _turn(self, number: int) -> None:
        screw, seen = self._screw, self._seen[-1]
        instruction, turns = screw.instruction(seen.value), screw.turns(-seen.value)

        async def action() -> Row:
            # Hands may have turned it before the interruption: only a new measurement can tell.
            if self._ctx.resumed and not self._fresh:
                await self._ctx.warn(
                    f"the run was interrupted while the {screw.name} screw was to be turned: the {screw.quantity} is "
                    "measured again before anything else is turned"
                )
                return {"turns": None, "instruction": instruction}
            await self._ask_to_turn(number, instruction, turns)
            self._ctx.record(ScrewTurn(screw=screw.name, turns=turns, round=number, text=instruction))
            return {"turns": turns, "instruction": instruction}

        row = await self._ctx.step(f"{screw.name}/{number}/turn", instruction, action)
        self._instructions.append(str(row["instruction"]))
        self._turned = None if row["turns"] is None else number_of(row, "turns")

    async def _ask_to_turn(self, number: int, instruction: str, turns: float) -> None:
        screw = self._screw

        async def watch() -> Live:
            return screw.while_turned(turns, (await self._ctx.beam()).signal)

        answer = await self._ctx.ask(
            SCREW.prompt(
                f"{screw.name}/{number}",
                f"{instruction[0].upper()}{instruction[1:]}, then confirm.",
                task=TurnScrew(screw=screw.name, turns=turns),
                target=self._rounds.start,
            ),
            watch,
        )
        if answer != "yes":
            raise AlignmentError(
                f"the operator did not turn the {screw.name} screw; the {screw.quantity} is "
                f"{self._seen[-1].value:.2f} {screw.unit}, accepted is ±{screw.tolerance:g} {screw.unit}"
            )

    def _require_certainty(self, seen: Observed) -> None:
        """Stop where turning cannot help any more."""
        screw, expanded = self._screw, EXPANDED * seen.u
        blurred = expanded >= screw.tolerance and abs(seen.value) <= expanded
        if blurred or screw.turns(-seen.value) == 0.0:
            known = expanded_text(seen.value, seen.u, 3, signed=True)
            raise AlignmentError(
                f"the {screw.quantity} is {known} {screw.unit} (k = 2); that does not show whether it is within "
                f"±{screw.tolerance:g} {screw.unit}: measure at more positions or raise the tolerance in [alignment]"
            )

    def _show(self, seen: Observed) -> None:
        screw = self._screw
        text = "" if screw.accepts(seen.value, seen.u) else screw.instruction(seen.value)
        low, high, expanded = -screw.tolerance, screw.tolerance, EXPANDED * seen.u
        self._ctx.show(Live(screw.quantity, seen.value, screw.unit, low, high, text, expanded=expanded))

    def _never(self) -> str:
        screw = self._screw
        rounds = "; ".join(
            f"round {number}: {expanded_text(seen.value, seen.u, 3, signed=True)} {screw.unit}"
            for number, seen in enumerate(self._seen, start=1)
        )
        return (
            f"the {screw.quantity} is not within ±{screw.tolerance:g} {screw.unit} after {len(self._seen)} rounds "
            f"({rounds}; k = 2): check that screw and mount follow without slip and that {screw.pitch_key} and "
            f"{screw.sense_key} are right"
        )
