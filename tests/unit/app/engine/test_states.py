"""The state machine, by examples and by random walks."""

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from catseye.app.engine.states import Effect, Trigger, transition
from catseye.app.protocol.state import ENDED, INTERRUPTED, RUNNING, ControlState


@pytest.mark.parametrize("state", sorted(RUNNING))
@pytest.mark.parametrize(
    ("event", "target"),
    [
        (Trigger.STOP, ControlState.STOPPING),
        (Trigger.ABORT, ControlState.ABORTING),
        (Trigger.FAULT, ControlState.STOPPING),
    ],
)
def test_every_running_state_stops_the_robot_at_once(
    state: ControlState, event: Trigger, target: ControlState
) -> None:
    result = transition(state, event)
    assert result.state == target
    motion = [effect for effect in result.effects if effect != Effect.FORBID_MOTION]
    assert motion[0] == Effect.STOP_ROBOT


@pytest.mark.parametrize("event", [event for event in Trigger if event != Trigger.CLEAR])
def test_aborted_leaves_only_by_clear(event: Trigger) -> None:
    assert transition(ControlState.ABORTED, event).state == ControlState.ABORTED
    assert transition(ControlState.ABORTED, Trigger.CLEAR).state == ControlState.CLEARING


def test_a_meaningless_event_keeps_the_state_and_is_reported() -> None:
    result = transition(ControlState.COMPLETE, Trigger.HOLD)
    assert result.state == ControlState.COMPLETE
    assert result.effects == (Effect.REPORT_IGNORED,)


def test_a_hold_outlasts_the_condition_of_a_suspension() -> None:
    held = transition(ControlState.SUSPENDED, Trigger.HOLD).state
    assert transition(held, Trigger.CONDITION_BACK).state == ControlState.HOLDING
    # A move may have been under way when the run was suspended: HELD comes at a checkpoint.
    assert transition(held, Trigger.HELD).state == ControlState.HELD


@pytest.mark.parametrize(
    "state", [ControlState.EXECUTE, ControlState.HOLDING, ControlState.UNHOLDING, ControlState.SUSPENDED]
)
def test_a_procedure_that_is_over_is_complete_wherever_it_ends(state: ControlState) -> None:
    assert transition(state, Trigger.DONE).state == ControlState.COMPLETE


@pytest.mark.parametrize(
    "state", sorted(RUNNING - {ControlState.STARTING, ControlState.SUSPENDING, ControlState.UNSUSPENDING})
)
def test_the_surroundings_stop_the_robot_and_not_the_run(state: ControlState) -> None:
    result = transition(state, Trigger.INTERRUPT)
    assert result.state == ControlState.SUSPENDING
    assert result.effects[:2] == (Effect.FORBID_MOTION, Effect.STOP_MOTION)


@pytest.mark.parametrize("event", [event for event in Trigger if event != Trigger.ACKNOWLEDGE])
def test_nothing_but_an_acknowledgement_permits_motion_after_that(event: Trigger) -> None:
    for state in INTERRUPTED:
        assert Effect.PERMIT_MOTION not in transition(state, event).effects
    assert transition(ControlState.SUSPENDING, Trigger.ACKNOWLEDGE).state == ControlState.SUSPENDING


class RunMachine(RuleBasedStateMachine):
    """Walks at random and remembers what the effects have permitted."""

    def __init__(self) -> None:
        super().__init__()
        self.state = ControlState.IDLE
        self.permitted = False
        self.halted = False
        self.unacknowledged = False

    @rule(event=st.sampled_from(Trigger))
    def happen(self, event: Trigger) -> None:
        before = self.state
        result = transition(before, event)
        self.state = result.state
        if event == Trigger.ACKNOWLEDGE and Effect.REPORT_IGNORED not in result.effects:
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
        assert self.permitted == (self.state == ControlState.EXECUTE)

    @invariant()
    def every_state_has_a_way_to_an_end(self) -> None:
        state = self.state
        for event in (Trigger.CLEAR, Trigger.ABORT, Trigger.ABORTED):
            state = transition(state, event).state
        assert state in ENDED


TestRunMachine = RunMachine.TestCase
