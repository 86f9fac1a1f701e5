"""The state machine, by examples and by random walks."""

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from catseye.app.engine.states import ENDED, INTERRUPTED, RUNNING, Effect, Event, State, transition


@pytest.mark.parametrize("state", sorted(RUNNING))
@pytest.mark.parametrize(
    ("event", "target"),
    [(Event.STOP, State.STOPPING), (Event.ABORT, State.ABORTING), (Event.FAULT, State.STOPPING)],
)
def test_every_running_state_stops_the_robot_at_once(state: State, event: Event, target: State) -> None:
    result = transition(state, event)
    assert result.state == target
    motion = [effect for effect in result.effects if effect != Effect.FORBID_MOTION]
    assert motion[0] == Effect.STOP_ROBOT


@pytest.mark.parametrize("event", [event for event in Event if event != Event.CLEAR])
def test_aborted_leaves_only_by_clear(event: Event) -> None:
    assert transition(State.ABORTED, event).state == State.ABORTED
    assert transition(State.ABORTED, Event.CLEAR).state == State.CLEARING


def test_an_event_that_means_nothing_leaves_the_state_and_says_so() -> None:
    result = transition(State.COMPLETE, Event.HOLD)
    assert result.state == State.COMPLETE
    assert result.effects == (Effect.REPORT_IGNORED,)


def test_a_hold_outlasts_the_condition_of_a_suspension() -> None:
    held = transition(State.SUSPENDED, Event.HOLD).state
    assert transition(held, Event.CONDITION_BACK).state == State.HOLDING
    # A move may have been under way when the run was suspended: HELD comes at a checkpoint.
    assert transition(held, Event.HELD).state == State.HELD


@pytest.mark.parametrize("state", [State.EXECUTE, State.HOLDING, State.UNHOLDING, State.SUSPENDED])
def test_a_procedure_that_is_over_is_complete_wherever_it_ends(state: State) -> None:
    assert transition(state, Event.DONE).state == State.COMPLETE


@pytest.mark.parametrize("state", sorted(RUNNING - {State.STARTING, State.SUSPENDING, State.UNSUSPENDING}))
def test_the_surroundings_stop_the_robot_and_not_the_run(state: State) -> None:
    result = transition(state, Event.INTERRUPT)
    assert result.state == State.SUSPENDING
    assert result.effects[:2] == (Effect.FORBID_MOTION, Effect.STOP_MOTION)


@pytest.mark.parametrize("event", [event for event in Event if event != Event.ACKNOWLEDGE])
def test_nothing_but_an_acknowledgement_permits_motion_after_that(event: Event) -> None:
    for state in INTERRUPTED:
        assert Effect.PERMIT_MOTION not in transition(state, event).effects
    assert transition(State.SUSPENDING, Event.ACKNOWLEDGE).state == State.SUSPENDING


class RunMachine(RuleBasedStateMachine):
    """Walks at random and remembers what the effects have permitted."""

    def __init__(self) -> None:
        super().__init__()
        self.state = State.IDLE
        self.permitted = False
        self.halted = False
        self.unacknowledged = False

    @rule(event=st.sampled_from(Event))
    def happen(self, event: Event) -> None:
        before = self.state
        result = transition(before, event)
        self.state = result.state
        if event == Event.ACKNOWLEDGE and Effect.REPORT_IGNORED not in result.effects:
            self.unacknowledged = False
        for effect in result.effects:
            if effect == Effect.PERMIT_MOTION:
                assert not self.halted, "motion was permitted after a stop"
                assert not self.unacknowledged, "motion was permitted before an acknowledgement"
                self.permitted = True
            if effect == Effect.FORBID_MOTION:
                self.permitted = False
            if effect == Effect.STOP_MOTION:
                self.unacknowledged = True
            if effect == Effect.STOP_ROBOT:
                self.halted = True
        ignored = Effect.REPORT_IGNORED in result.effects
        assert ignored == ((before, event) != (before, event) or result.effects == (Effect.REPORT_IGNORED,))
        assert not ignored or self.state == before

    @invariant()
    def motion_is_permitted_in_execute_only(self) -> None:
        assert self.permitted == (self.state == State.EXECUTE)

    @invariant()
    def every_state_has_a_way_to_an_end(self) -> None:
        state = self.state
        for event in (Event.CLEAR, Event.ABORT, Event.ABORTED):
            state = transition(state, event).state
        assert state in ENDED


TestRunMachine = RunMachine.TestCase
