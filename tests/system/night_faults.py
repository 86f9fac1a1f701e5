"""What goes wrong in a night, each at a random moment; see `tests.system.nights`."""

import os
import resource
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from unittest.mock import patch

from catseye.app.files.atomic import write_atomically
from tests.patience import HANG_S
from tests.system.nights import (
    DEADLINE_S,
    LATE_S,
    Call,
    Moment,
    Night,
    children,
    decided,
    descendants,
    is_alive,
    until,
)

Fault = Callable[[Night], None]


def kill_campaign(night: Night) -> None:
    """SIGKILL of the campaign; what it has started ends by itself, or the next call waits for it."""
    first = night.call()
    night.struck = first.until(night.moment)
    left = descendants(first.process.pid)
    first.process.kill()
    first.end()
    if night.rng.random() < 0.5:
        until(lambda: not any(map(is_alive, left)), HANG_S)
    night.require(first.code in {-signal.SIGKILL, 0}, f"killed campaign: code {first.code}")


def kill_stage(night: Night) -> None:
    """SIGKILL of the process of the stage."""
    night.moment = Moment.drawn(night.rng, (0, 3, 6, 1, 1))
    _strike(night, lambda pid: _kill(children(pid)), {3})


def kill_guard(night: Night) -> None:
    """SIGKILL of the guard of the run."""
    night.moment = Moment.drawn(night.rng, (0, 1, 2, 0, 0))
    _strike(
        night, lambda pid: _kill([each for child in children(pid) for each in descendants(child)]), {0, 3, 5}
    )


def kill_emulator(night: Night) -> None:
    """SIGKILL of the bench, which is back a little later, with the arm at zero instead of where it was: code 5."""

    def strike(_pid: int) -> bool:
        night.place.kill()
        time.sleep(night.rng.uniform(0.0, 5.0))
        night.place.restart()
        return True

    _strike(night, strike, {0, 3, 5})


def device_missing(night: Night) -> None:
    """No bench at the start."""
    night.place.kill()
    first = night.call()
    night.struck = True
    night.require(first.end() == 3, f"bench missing: code {first.code}")
    night.place.restart()


def device_lost(night: Night) -> None:
    """A device closes its links, or is silent for a time."""

    def strike(_pid: int) -> bool:
        device = night.rng.choice(["robot", "interferometer"])
        name = night.rng.choice(["drop", "stall"])
        more = {"duration_s": night.rng.uniform(1.0, 4000.0)} if name == "stall" else {}
        night.place.ask(op="fault", name=name, device=device, **more)
        return True

    _strike(night, strike, {0, 3})
    night.place.ask(op="fault", name="clear_faults")


def terminated(night: Night) -> None:
    """SIGTERM, and SIGKILL ten seconds later."""
    first = night.call()
    night.struck = first.until(night.moment)
    first.process.terminate()
    with suppress(subprocess.TimeoutExpired):
        first.process.wait(10.0)
    night.require(first.process.poll() is not None, "SIGTERM: not over after 10 s")
    first.process.kill()
    # Before it leads its job it dies by the signal itself.
    codes = {143, -signal.SIGTERM} if not night.moment.stage else {143}
    night.require(first.end() in codes | {0}, f"SIGTERM: code {first.code}")


def interrupted(night: Night) -> None:
    """Ctrl-C twice, or three times: the run stops, or aborts."""
    first = night.call()
    night.struck = first.until(night.moment)
    for _ in range(night.rng.randint(2, 3)):
        if first.process.poll() is None:
            first.process.send_signal(signal.SIGINT)
            time.sleep(night.rng.uniform(0.05, 0.5))
    codes = {130, -signal.SIGINT} if not night.moment.stage else {130}
    night.require(first.end() in codes | {0}, f"Ctrl-C: code {first.code}")


def quota(night: Night) -> None:
    """No file of the stage's process, or of the campaign's, may grow any more."""
    own = night.rng.random() < 0.3
    limit = (night.rng.choice([0, 1000, 100_000]),) * 2

    def strike(pid: int) -> bool:
        pids = [pid] if own else children(pid)
        for each in pids:
            with suppress(ProcessLookupError):
                resource.prlimit(each, resource.RLIMIT_FSIZE, limit)
        return bool(pids)

    _strike(night, strike, {0, 6})


def pipe_closed(night: Night) -> None:
    """Whoever reads stdout leaves."""
    first = night.call()
    night.struck = first.until(night.moment)
    first.close_stdout()
    night.require(first.end() == 0, f"pipe closed: code {first.code}: {''.join(first.said)[-300:]}")


def pipe_left(night: Night) -> None:
    """Whoever reads stdout stays, and reads no more."""
    first = night.call()
    night.struck = first.until(night.moment)
    first.leave_stdout()
    night.require(first.end() == 0, f"pipe left: code {first.code}: {''.join(first.said)[-300:]}")


def overlap(night: Night) -> None:
    """Another job of the cell begins meanwhile: it is refused, or waits and completes."""
    first = night.call()
    night.struck = first.until(night.moment)
    waits = night.rng.random() < 0.5
    second = night.call(*(("--wait-lock", f"{DEADLINE_S:g}") if waits else ()), job="next-night")
    night.require(second.end() == (0 if waits else 4), f"second job, waits {waits}: code {second.code}")
    night.require(first.end() == 0, f"first job: code {first.code}")


def same_instant(night: Night) -> None:
    """The job is called twice at the same instant."""
    both = [night.call(), night.call()]
    night.struck = True
    codes = sorted(each.end() for each in both)
    night.require(codes == [0, 4], f"called twice at once: codes {codes}")


def unanswered(night: Night) -> None:
    """A question that nobody answers."""
    first = night.call(file="asking.toml")
    night.struck = True
    night.require(first.end() == 4, f"nobody answers: code {first.code}")


def beam_blocked(night: Night) -> None:
    """Something stands in the beam until somebody takes it away."""

    def strike(_pid: int) -> bool:
        night.place.ask(op="fault", name="block_beam", duration_s=None)
        return True

    _strike(night, strike, {0, 1, 4})
    night.place.ask(op="clear_beam")


def short_deadline(night: Night) -> None:
    """The deadline comes while work is under way."""
    within_s = night.rng.uniform(1.0, 30.0)
    first = Call(night.place, "--deadline", f"{within_s:.1f}s")
    night.calls.append(first)
    early = first.end() == 0 and first.took_s < within_s
    night.struck = not early
    night.require(early or first.code == 4, f"deadline after {within_s:.0f} s: code {first.code}")
    night.require(first.took_s < within_s + LATE_S, f"deadline {within_s:.0f} s: took {first.took_s:.0f} s")


def clock_step(night: Night) -> None:
    """Somebody sets the clock of the computer, by up to a day; before the next call it is set right."""
    folder = night.place.folder
    step, library = folder / "clock-step", folder / "clock_step.so"
    step.write_text("0")
    source = Path(__file__).with_name("clock_step.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source], check=True)
    own = {"LD_PRELOAD": str(library), "CATSEYE_TEST_CLOCK": str(step)}

    def strike(_pid: int) -> bool:
        seconds = night.rng.choice([-86_400, -3600, -60, 60, 3600, 86_400])
        write_atomically(step, str(seconds))
        return True

    with patch.dict(os.environ, own):
        _strike(night, strike, {0})


FAULTS: tuple[Fault, ...] = (
    kill_campaign,
    kill_stage,
    kill_guard,
    kill_emulator,
    device_missing,
    device_lost,
    terminated,
    interrupted,
    quota,
    pipe_closed,
    pipe_left,
    overlap,
    same_instant,
    unanswered,
    beam_blocked,
    short_deadline,
    clock_step,
)


def _strike(night: Night, strike: Callable[[int], bool], codes: set[int]) -> None:
    """Strike at the moment of the night; the job ends with one of the codes, or well where that was too late."""
    first = night.call()
    if first.until(night.moment):
        night.struck = strike(first.process.pid)
    code = first.end()
    night.require(code in (codes if night.struck else {0}), f"code {code}: {decided(first)}")


def _kill(pids: list[int]) -> bool:
    for pid in pids:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    return bool(pids)
