"""What every driver owes to its link, whatever the instrument."""

import asyncio
import re
import socket
import threading
import time
from collections.abc import Awaitable
from typing import Any

from catseye.app.testing.checks.check import Check
from catseye.app.testing.trial import NotConformingError, Trial, expect
from catseye.drivers.roles.errors import DeviceError, LinkError, LinkTimeoutError

_IN_FLIGHT_S = 0.05
_LONGEST_BLOCK_S = 0.5
_CLOSE_S = 5.0
_QUESTIONS = 20
_ADVICE = re.compile(
    r"\b(check|clear|close|choose|compare|connect|end|give|has to|look|must|open|press|raise|see|set|start|switch|use"
    r"|wait|write)\b"
)


async def connect_identifies_the_device(trial: Trial) -> None:
    """`connect` returns an identity: model, firmware, serial, and whether an emulator answers."""
    driver = trial.new_driver()
    try:
        identity = await trial.in_time(driver.connect(), "connect()")
    finally:
        await driver.close()
    texts = (identity.model, identity.firmware, identity.serial)
    expect(
        all(isinstance(text, str) for text in texts),
        f"model, firmware and serial have to be texts: {identity!r}",
    )
    expect(bool(identity.model), "the identity's model is empty: say what answers, or what it was taken for")
    expect(isinstance(identity.simulated, bool), "the identity's `simulated` has to be True or False")
    if trial.candidate.has_bench:
        expect(identity.simulated, f"an emulator answers, which the identity does not say: {identity!r}")


async def close_may_be_called_any_number_of_times(trial: Trial) -> None:
    """`close` before `connect` and twice in a row is harmless, and the driver can be connected again."""
    driver = trial.new_driver()
    await trial.in_time(driver.close(), "close() before connect()")
    for _ in range(2):
        await trial.in_time(driver.connect(), "connect()")
        await trial.ask(driver)
        await trial.in_time(driver.close(), "close()")
        await trial.in_time(driver.close(), "the second close()")


async def nothing_is_left_after_close(trial: Trial) -> None:
    """After `close` no task, no thread and no connection is left, also when the link broke before."""
    tasks, threads = asyncio.all_tasks(), set(threading.enumerate())
    async with trial.connected() as driver:
        await trial.ask(driver)
        trial.drop()
        await asyncio.sleep(_IN_FLIGHT_S)
        await trial.ask_after_trouble(driver)
    await _until(
        lambda: trial.connections == 0, f"connections are left open after close(): {trial.connections}"
    )
    left = [repr(task.get_coro()) for task in asyncio.all_tasks() - tasks]
    expect(not left, f"tasks are left running after close(): {left}")
    # Workers of asyncio's executor end with the loop.
    alive = [t.name for t in set(threading.enumerate()) - threads if not t.name.startswith("asyncio_")]
    expect(not alive, f"threads are left running after close(): {alive}")


async def a_dead_endpoint_is_a_link_error(trial: Trial) -> None:
    """`connect` to a port where nobody listens fails in time, with where and what to do."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
        driver = trial.new_driver(f"tcp://127.0.0.1:{port}")
        error = await _failure(trial.in_time(driver.connect(), "connect()"))
    await driver.close()
    expect(isinstance(error, LinkError), f"nobody listens, and connect() answers {error!r}: raise LinkError")
    _check_text(error, port)


async def a_silent_endpoint_is_a_link_error(trial: Trial) -> None:
    """`connect` to a port that takes everything and says nothing fails in time, with where and what to do."""
    with trial.threads.proxy(None) as silent:
        driver = trial.new_driver(silent.endpoint)
        error = await _failure(trial.in_time(driver.connect(), "connect()"))
        await driver.close()
    expect(
        isinstance(error, LinkError), f"nothing is answered, and connect() answers {error!r}: raise LinkError"
    )
    _check_text(error, int(silent.endpoint.rpartition(":")[2]))


async def a_stranger_is_a_device_error(trial: Trial) -> None:
    """`connect` to something that speaks another protocol fails in time with a DeviceError, never another error."""
    for says in (b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n", bytes(range(256)) * 4):
        with trial.threads.proxy(None, says) as stranger:
            driver = trial.new_driver(stranger.endpoint)
            error = await _failure(trial.in_time(driver.connect(), "connect()"))
            await driver.close()
        expect(
            isinstance(error, DeviceError), f"{says[:16]!r}... was answered, and connect() answers {error!r}"
        )
        _check_text(error, int(stranger.endpoint.rpartition(":")[2]))


async def a_stalled_device_times_out_and_is_healed(trial: Trial) -> None:
    """A question without answer ends in LinkTimeoutError in time; after the stall the next one is answered."""
    async with trial.connected() as driver:
        await trial.ask(driver)
        trial.stall()
        error = await _failure(trial.ask(driver))
        expect(
            isinstance(error, LinkTimeoutError),
            f"the device does not answer, and the driver answers {error!r}: raise LinkTimeoutError",
        )
        trial.release()
        await trial.ask_after_trouble(driver)


async def a_late_answer_answers_no_later_question(trial: Trial) -> None:
    """After a time-out the answer to the old question is never taken for that to a new one."""
    async with trial.connected() as driver:
        await trial.ask(driver)
        trial.stall()
        await _failure(trial.ask(driver))
        await _expect_late_answer_ignored(trial, driver, "a late answer")


async def a_dropped_connection_is_healed(trial: Trial) -> None:
    """After the device has dropped the connection the driver opens it again by itself."""
    async with trial.connected() as driver:
        await trial.ask(driver)
        trial.drop()
        await asyncio.sleep(_IN_FLIGHT_S)
        await trial.ask_after_trouble(driver)


async def a_connection_that_drops_under_a_question_is_healed(trial: Trial) -> None:
    """A connection that breaks while an answer is due ends that question with a DeviceError; the next is answered."""
    async with trial.connected() as driver:
        await trial.ask(driver)
        trial.stall()
        asked = asyncio.create_task(trial.ask(driver))
        await asyncio.sleep(_IN_FLIGHT_S)
        trial.release()
        trial.drop()
        # A driver may ask once more on a new connection, so an answer is as good.
        await _failure(asked, or_nothing=True)
        await trial.ask_after_trouble(driver)


async def a_cancelled_question_leaves_the_link_usable(trial: Trial) -> None:
    """A question that is cancelled while its answer is due ends at once and spoils nothing."""
    async with trial.connected() as driver:
        trial.stall()
        asked = asyncio.create_task(trial.ask(driver))
        await asyncio.sleep(_IN_FLIGHT_S)
        asked.cancel()
        done, _ = await asyncio.wait({asked}, timeout=_CLOSE_S)
        trial.release()
        expect(bool(done), f"a cancelled question still runs after {_CLOSE_S:g} s")
        expect(asked.cancelled(), "a cancelled question swallowed the cancellation: let CancelledError pass")
        await trial.ask_after_trouble(driver)


async def a_cancelled_question_answers_no_later_one(trial: Trial) -> None:
    """The answer to a question that was cancelled is never taken for that to a new one."""
    async with trial.connected() as driver:
        await trial.ask(driver)
        trial.stall()
        asked = asyncio.create_task(trial.ask(driver))
        await asyncio.sleep(_IN_FLIGHT_S)
        asked.cancel()
        await asyncio.wait({asked}, timeout=_CLOSE_S)
        await _expect_late_answer_ignored(trial, driver, "the answer to a cancelled question")


async def close_ends_a_question_in_flight(trial: Trial) -> None:
    """`close` does not wait for an answer that does not come; the question ends with an error."""
    driver = trial.new_driver()
    await trial.in_time(driver.connect(), "connect()")
    trial.stall()
    asked = asyncio.create_task(trial.ask(driver))
    await asyncio.sleep(_IN_FLIGHT_S)
    started_s = time.monotonic()
    await trial.in_time(driver.close(), "close()")
    took_s = time.monotonic() - started_s
    error = await _failure(trial.in_time(asked, "the question in flight"))
    expect(took_s < _CLOSE_S, f"close() took {took_s:.1f} s with a question in flight")
    expect(isinstance(error, DeviceError), f"the question in flight ended with {error!r}: raise LinkError")


async def answers_may_come_byte_by_byte(trial: Trial) -> None:
    """However the network cuts the answers, they are the same."""
    trial.one_by_one()
    async with trial.connected() as driver:
        for _ in range(3):
            await trial.ask(driver)


async def a_device_left_streaming_is_connected(trial: Trial) -> None:
    """A device that another client left sending without being asked is silenced, then asked as usual."""
    trial.begin_with(trial.candidate.streaming)
    try:
        async with trial.connected() as driver:
            for _ in range(_QUESTIONS):
                await trial.ask(driver)
                await asyncio.sleep(_IN_FLIGHT_S)
    except DeviceError as error:
        raise NotConformingError(
            f"the device sends without being asked, and the driver raises {error!r}: end that by a first command, "
            "before the link is drained"
        ) from error


async def questions_at_once_take_turns(trial: Trial) -> None:
    """Questions that several tasks ask at the same time are all answered."""
    async with trial.connected() as driver:
        await trial.in_time(asyncio.gather(*(trial.ask(driver) for _ in range(5))), "five questions at once")


async def the_loop_is_never_blocked(trial: Trial) -> None:
    """While an answer is due the event loop goes on with other work."""
    longest_s = 0.0

    async def watch() -> None:
        nonlocal longest_s
        while True:
            started_s = time.monotonic()
            await asyncio.sleep(0.01)
            longest_s = max(longest_s, time.monotonic() - started_s)

    async with trial.connected() as driver:
        watcher = asyncio.create_task(watch())
        await asyncio.sleep(0)
        trial.stall()
        await _failure(trial.ask(driver))
        trial.release()
        watcher.cancel()
        await asyncio.wait({watcher})
    expect(
        longest_s < _LONGEST_BLOCK_S,
        f"the event loop stood still for {longest_s:.2f} s: no blocking call on it",
    )


async def _expect_late_answer_ignored(trial: Trial, driver: Any, late: str) -> None:
    """Let an answer come late, and no other one: the next question is not answered by it."""
    trial.release_then_mute()
    await asyncio.sleep(_IN_FLIGHT_S)
    error = await _failure(trial.ask(driver))
    expect(isinstance(error, DeviceError), f"{late} came and no other, and the driver answers {error!r}")
    trial.release()
    await trial.ask_after_trouble(driver)


async def _failure(work: Awaitable[Any], *, or_nothing: bool = False) -> BaseException | None:
    """Return the error of the driver that a piece of work ends with."""
    try:
        result = await work
    except NotConformingError:
        raise
    except Exception as error:  # noqa: BLE001  # any error of the driver is what is examined
        return error
    expect(or_nothing, f"an error was due, {result!r} came: never answer from memory")
    return None


def _check_text(error: BaseException | None, port: int) -> None:
    text = str(error)
    expect(str(port) in text, f"the text does not say where (port {port}): {text}")
    expect(_ADVICE.search(text) is not None, f"the text does not say what to do: {text}")


async def _until(condition: Any, text: str) -> None:
    deadline_s = time.monotonic() + 1.0
    while not condition():
        expect(time.monotonic() < deadline_s, text)
        await asyncio.sleep(0.01)


CHECKS = (
    Check(connect_identifies_the_device),
    Check(close_may_be_called_any_number_of_times),
    Check(nothing_is_left_after_close, needs=("proxy",)),
    Check(a_dead_endpoint_is_a_link_error, needs=("proxy",)),
    Check(a_silent_endpoint_is_a_link_error, needs=("proxy",)),
    Check(a_stranger_is_a_device_error, needs=("proxy",)),
    Check(a_stalled_device_times_out_and_is_healed, needs=("proxy",)),
    Check(a_late_answer_answers_no_later_question, needs=("proxy",)),
    Check(a_dropped_connection_is_healed, needs=("proxy",)),
    Check(a_connection_that_drops_under_a_question_is_healed, needs=("proxy",)),
    Check(a_cancelled_question_leaves_the_link_usable, needs=("proxy",)),
    Check(a_cancelled_question_answers_no_later_one, needs=("proxy",)),
    Check(close_ends_a_question_in_flight, needs=("proxy",)),
    Check(answers_may_come_byte_by_byte, needs=("proxy",)),
    Check(a_device_left_streaming_is_connected, needs=("proxy", "streaming")),
    Check(questions_at_once_take_turns),
    Check(the_loop_is_never_blocked, needs=("proxy",)),
)
