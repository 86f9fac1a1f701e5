"""Fixtures of every test: nothing may be left behind."""

import asyncio
import gc
import inspect
import signal
from collections.abc import AsyncIterator, Generator, Iterator

import pytest
from pytest_asyncio import is_async_test

from tests.left_behind import nothing_left


@pytest.fixture(scope="session", autouse=True)
def ctrl_c_is_heard() -> None:
    """Undo what a shell does to what it runs in the background: the programs that tests start would ignore Ctrl-C."""
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def imported_modules_stay() -> None:
    """Take what importing has made out of the garbage collector's rounds, of which every test pays one."""
    gc.collect()
    gc.freeze()


@pytest.fixture(autouse=True)
def nothing_left_behind() -> Iterator[None]:
    """Fail a test that leaves a thread, a socket or an open file."""
    with nothing_left():
        yield


@pytest.fixture(autouse=True)
def coroutines_leave_no_task(
    nothing_left_behind: None,  # noqa: ARG001  # looks last, when the loop with its threads is closed
    request: pytest.FixtureRequest,
) -> None:
    """Look for tasks where there may be any: a loop for each of the other tests would cost more than most of them."""
    if is_async_test(request.node):
        request.getfixturevalue("no_task_left_behind")


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_fixture_setup(
    fixturedef: pytest.FixtureDef[object], request: pytest.FixtureRequest
) -> Generator[None, object, object]:
    """Look for tasks after a coroutine fixture too, whatever the test is that asks for it."""
    is_coroutine = inspect.iscoroutinefunction(fixturedef.func) or inspect.isasyncgenfunction(fixturedef.func)
    if is_coroutine and fixturedef.argname != "no_task_left_behind":
        request.getfixturevalue("no_task_left_behind")
    return (yield)


@pytest.fixture
async def no_task_left_behind(request: pytest.FixtureRequest) -> AsyncIterator[None]:
    """Fail a coroutine test, or one with a coroutine fixture, that leaves a task."""
    yield
    tasks = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
    names = [repr(task.get_coro()) for task in tasks]
    assert not names, f"tasks left running after {request.node.name}: {names}"
