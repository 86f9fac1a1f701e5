"""The emulator led by abb_robot_client, a client of Robot Web Services that nobody here wrote."""

import queue
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from abb_robot_client import rws

from catseye.app.testing.bench import RunningBench, bench_in_thread
from tests.patience import HANG_S
from tests.unit.simulators.abb.benches import BENT, abb_config


@pytest.fixture
def bench() -> Iterator[RunningBench]:
    with bench_in_thread(abb_config()) as running:
        yield running


@pytest.fixture
def client(bench: RunningBench) -> Iterator[Any]:
    made = rws.RWS(bench.endpoint("robot").replace("tcp", "http"))
    yield made
    made.close()
    beside = vars(made)["_rmmp_session"]
    if beside is not None:
        # It leaves this one open.
        beside.close()


def until(holds: Callable[[], bool]) -> None:
    """Ask until something holds that takes an answer of the emulator to find out, which is the pause."""
    end_s = time.monotonic() + HANG_S
    while not holds():
        assert time.monotonic() < end_s


def test_it_reads_the_arm_and_the_panel(client: Any) -> None:
    assert list(client.get_jointtarget().robax) == pytest.approx(BENT, abs=1e-4)
    assert list(client.get_robtarget().trans) == pytest.approx([364.354, 0.0, 594.0], abs=1e-3)
    assert (client.get_controller_state(), client.get_operation_mode()) == ("motoron", "AUTO")
    assert client.get_speedratio() == 100.0
    assert client.get_tasks()["T_ROB1"].motiontask
    assert client.read_event_log()[-1].seqnum == 1


def test_it_moves_the_arm_through_variables(client: Any, bench: RunningBench) -> None:
    client.set_speedratio(50)
    goal = rws.JointTarget(np.array([0.1, 0.0, 0.0, 0.0, 0.5, 0.0]), np.zeros(6))
    client.set_rapid_variable_jointtarget("cats_goal", goal)
    client.set_rapid_variable_num("cats_for", 1)
    client.set_rapid_variable_num("cats_seq", 1)
    beats = iter(range(1, 10_000))

    def done() -> bool:
        client.set_rapid_variable_num("cats_beat", next(beats))
        return bool(client.get_rapid_variable_num("cats_done") == 1.0)

    until(done)
    assert bench.arm().joints[0] == pytest.approx(5.7296, abs=1e-3)


def test_it_stops_and_starts_rapid(client: Any) -> None:
    client.stop()
    assert client.get_execution_state().ctrlexecstate == "stopped"
    client.resetpp()
    client.start(cycle="forever")
    assert client.get_execution_state() == ("running", "forever")


def test_it_switches_the_motors(client: Any, bench: RunningBench) -> None:
    client.set_controller_state("motoroff")
    assert not bench.arm().servo
    client.set_controller_state("motoron")
    assert bench.arm().servo


def test_it_uses_signals_files_and_queues(client: Any) -> None:
    client.set_digital_io("do1", 1)
    assert client.get_digital_io("do1") == 1
    client.set_analog_io("ao1", 2.5)
    assert client.get_analog_io("ao1") == 2.5
    client.upload_file("$HOME/a.mod", b"MODULE a")
    assert client.read_file("$HOME/a.mod") == b"MODULE a"
    assert client.list_files("$HOME") == ["a.mod"]
    client.delete_file("$HOME/a.mod")
    assert client.get_ramdisk_path()
    assert [client.try_create_ipc_queue("q"), client.try_create_ipc_queue("q")] == [True, False]
    client.send_ipc_message("q", "hello", "q")
    assert client.read_ipc_message("q")[0].data == "hello"


def test_it_is_granted_remote_control(client: Any, bench: RunningBench) -> None:
    bench.fault("teach_mode")
    with pytest.raises(rws.ABBException, match="manual mode"):
        client.set_rapid_variable_num("cats_beat", 1)
    client.request_rmmp()
    client.set_rapid_variable_num("cats_beat", 1)


def test_it_is_shown_what_it_subscribed_to(client: Any) -> None:
    wanted = [
        (rws.SubscriptionResourceType.ExecutionState, None),
        (rws.SubscriptionResourceType.ControllerState, None),
        (rws.SubscriptionResourceType.PersVar, "cats_beat"),
        (rws.SubscriptionResourceType.Signal, "do1"),
    ]
    low = rws.SubscriptionResourcePriority.Low
    seen: queue.Queue[Any] = queue.Queue()
    requests = [rws.SubscriptionResourceRequest(kind, low, name) for kind, name in wanted]
    subscription = client.subscribe(requests, seen.put)
    try:
        until(
            lambda: (
                client.get_operation_mode() == "AUTO"
                and bool(subscription.ws.sock and subscription.ws.sock.connected)
            )
        )
        client.stop()
        client.set_rapid_variable_num("cats_beat", 7)
        client.set_digital_io("do1", 1)
        client.set_controller_state("motoroff")
        shown = [seen.get(timeout=HANG_S) for _ in requests]
    finally:
        subscription.close()
        subscription.thread.join(HANG_S)
    assert rws.RAPIDExecutionState("stopped", "") in shown
    assert rws.ControllerState("motoroff") in shown
    assert rws.VariableValue("T_ROB1", "7", "cats_beat") in shown
    assert rws.Signal("do1", "1") in shown


def test_it_is_refused_with_the_controllers_number(client: Any) -> None:
    with pytest.raises(rws.ABBException) as error:
        client.get_rapid_variable("nothing")
    assert error.value.code < -1_073_000_000


def test_it_stays_outside_with_a_wrong_password(bench: RunningBench) -> None:
    stranger = rws.RWS(bench.endpoint("robot").replace("tcp", "http"), password="guess")
    with pytest.raises(Exception, match="401"):
        stranger.get_operation_mode()
    stranger.close()
