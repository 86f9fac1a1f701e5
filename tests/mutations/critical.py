"""The faults: each would lose data, move an arm that should stand, or take a wrong number for a right one."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Edit:
    """A change of one place in a file.

    Attributes:
        path: file, from the root of the repository.
        old: text that stands there exactly once.
        new: what takes its place.
    """

    path: str
    old: str
    new: str


@dataclass(frozen=True)
class Mutation:
    """A fault, and the tests of which one has to fail.

    Attributes:
        name: what is wrong.
        edits: how it is put in.
        tests: arguments of pytest.
    """

    name: str
    edits: tuple[Edit, ...]
    tests: tuple[str, ...]


def _one(name: str, path: str, old: str, new: str, *tests: str) -> Mutation:
    return Mutation(name, (Edit(path, old, new),), tests)


_STORE: Final = "tests/unit/app/store"
_LINK: Final = "tests/unit/drivers/test_link.py"
_GATE: Final = (
    "tests/unit/app/engine/test_conditions.py",
    "tests/unit/app/engine/test_host.py",
    "tests/unit/app/engine/test_first_motion.py",
    "tests/unit/app/engine/test_door.py",
)
_SCARA: Final = "procedures/scara/motion/approach.py"

STORING: Final = (
    _one(
        "acknowledged-before-commit",
        "app/store/writer.py",
        """            with connection:
                connection.execute("BEGIN IMMEDIATE")
                result = job(connection)
""",
        """            connection.execute("BEGIN IMMEDIATE")
            result = job(connection)
            self._thread.submit(connection.commit)
""",
        _STORE,
    ),
    Mutation(
        "writer-goes-on-after-a-failure",
        (
            Edit(
                "app/store/writer.py",
                """        if self.failure is not None:
            raise self.failure
        if self._closed:
""",
                """        if self._closed:
""",
            ),
            Edit(
                "app/store/writer.py",
                """        if self.failure is not None:
            raise self.failure
        connection = self._opened()
""",
                """        connection = self._opened()
""",
            ),
        ),
        (_STORE,),
    ),
    _one(
        "replaced-database-not-noticed",
        "app/store/writer.py",
        "            self._require_same_files()\n",
        "",
        _STORE,
    ),
    _one(
        "seal-without-fsync-of-files",
        "app/store/seal.py",
        "            os.fsync(descriptor)\n            _read_only(descriptor)\n",
        "            _read_only(descriptor)\n",
        f"{_STORE}/test_seal.py",
    ),
    _one(
        "seal-without-fsync-of-the-manifest",
        "app/store/seal.py",
        "        os.fsync(file.fileno())\n",
        "",
        f"{_STORE}/test_seal.py",
    ),
    _one(
        "seal-without-fsync-of-the-folder",
        "app/store/seal.py",
        "    marker.rename(directory / MANIFEST)\n    _sync(directory)\n",
        "    marker.rename(directory / MANIFEST)\n",
        f"{_STORE}/test_seal.py",
    ),
    _one(
        "files-written-plainly",
        "app/files/atomic.py",
        "        target = Path(os.path.realpath(path))\n",
        "        path.write_bytes(raw)\n        return\n        target = Path(os.path.realpath(path))\n",
        "tests/unit/app/files/test_atomic.py",
    ),
    _one(
        "atomic-write-without-fsync",
        "app/files/atomic.py",
        "            os.fsync(file.fileno())\n",
        "",
        "tests/unit/app/files/test_atomic.py",
    ),
)

LINKS: Final = (
    Mutation(
        "link-no-drain",
        (
            Edit(
                "drivers/links/link.py",
                "        self.greeting = await self._drain()\n",
                '        self.greeting = b""\n',
            ),
            Edit(
                "drivers/links/link.py",
                "                await self._drain()\n                await self._identify()\n",
                "                await self._identify()\n",
            ),
        ),
        (_LINK, "tests/unit/drivers/test_healing.py"),
    ),
    Mutation(
        "drain-without-bound",
        (
            Edit(
                "drivers/links/link.py",
                "            async with asyncio.timeout(_DRAIN_TIMEOUT_S) as whole:\n"
                "                while count <= _FLOOD_BYTES:\n",
                "            async with asyncio.timeout(None) as whole:\n                while True:\n",
            ),
        ),
        (_LINK, "tests/unit/drivers/test_healing.py", "tests/unit/drivers/test_melfa_stop_and_heal.py"),
    ),
    _one(
        "late-answer-taken-for-the-next",
        "drivers/links/link.py",
        "        self._doubt = self._doubt or self._unasked()\n",
        '        self._doubt = ""\n',
        _LINK,
    ),
    _one(
        "motion-sent-twice",
        "drivers/melfa/joint_motion.py",
        "            timeout_s=self._settings.move_timeout_s,\n            repeat=Repeat.BOUND,\n",
        "            timeout_s=self._settings.move_timeout_s,\n            repeat=Repeat.HARMLESS,\n",
        "tests/unit/drivers/test_melfa_motion.py",
    ),
    _one(
        "lost-beam-forgotten",
        "drivers/links/latches.py",
        "        self.beam_lost |= beam_lost\n",
        "        self.beam_lost = beam_lost\n",
        "tests/unit/drivers/interferometers",
    ),
    _one(
        "count-trusted-after-a-reconnect",
        "drivers/links/latches.py",
        "        self.beam_lost |= self._was_greeted\n",
        "",
        "tests/unit/drivers/interferometers",
    ),
)

MOTION: Final = (
    _one(
        "emulated-aim-on-a-real-arm",
        "app/engine/host.py",
        "        if aim is not None and aim != simulated:\n",
        "        if False:\n",
        "tests/unit/app/engine",
    ),
    _one(
        "emulated-and-real-devices-mixed",
        "app/engine/devices.py",
        "    if any(kinds.values()):\n",
        "    if False:\n",
        "tests/unit/app/engine",
    ),
    _one(
        "another-cells-arm",
        "app/engine/devices.py",
        "    if arm != cell:\n",
        "    if False:\n",
        "tests/unit/app/engine",
    ),
    _one(
        "jog-by-no-number",
        "app/protocol/requests.py",
        "    by: float = Field(ge=-90.0, le=90.0, allow_inf_nan=False)\n",
        "    by: float\n",
        "tests/unit/app/protocol/test_recorded_lines.py",
    ),
    _one(
        "target-that-is-no-number",
        "drivers/roles/pose.py",
        "        return math.isfinite(value) and self.low <= value <= self.high\n",
        "        return not (value < self.low or value > self.high)\n",
        "tests/unit/app/engine/test_limits.py",
    ),
    _one(
        "target-out-of-range",
        "app/engine/gate.py",
        "            require_in_range(self._axes, target)\n",
        "            pass\n",
        "tests/unit/app/engine",
    ),
    _one(
        "bodies-in-the-way-not-seen",
        "app/engine/gate.py",
        "        if (blocked := self._blocked(way)) is not None:\n",
        "        if (blocked := self._blocked(way)) is not None and False:\n",
        "tests/unit/app/engine",
    ),
    _one(
        "override-above-the-cap",
        "app/engine/gate.py",
        "        if not percent <= self._cap_percent + _OVERRIDE_TOLERANCE_PERCENT:\n",
        "        if False:\n",
        *_GATE,
    ),
    _one(
        "override-not-brought-down",
        "app/engine/gate.py",
        "        if percent > self._cap_percent:\n            percent = await",
        "        if False:\n            percent = await",
        *_GATE,
    ),
    _one(
        "motion-in-teach-mode",
        "app/engine/gate.py",
        "    if status.teach_mode:\n",
        "    if False:\n",
        "tests/unit/app/engine",
    ),
    _one(
        "motion-on-a-locked-machine",
        "app/engine/gate.py",
        "    if status.machine_locked:\n",
        "    if False:\n",
        "tests/unit/app/engine",
    ),
    _one(
        "arrival-on-a-locked-machine",
        "drivers/melfa/motion.py",
        "    if state.machine_locked:\n",
        "    if False:\n",
        "tests/unit/drivers/test_melfa_motion.py",
    ),
    _one(
        "motion-with-an-open-door",
        "app/engine/gate.py",
        "        if self._door is not None and self._door.trouble is not None:\n",
        "        if False:\n",
        *_GATE,
    ),
    _one(
        "motion-that-was-not-walked",
        "app/engine/gate.py",
        "        if self.walk_rule is not None and self.walk_rule.in_force:\n",
        "        if False:\n",
        "tests/unit/app/engine/walked",
    ),
    _one(
        "no-take-up",
        _SCARA,
        "    return target - wanted * take_up\n",
        "    return target\n",
        "tests/unit/procedures/test_approach.py",
    ),
    _one(
        "take-up-from-the-wrong-side",
        _SCARA,
        "    return target - wanted * take_up\n",
        "    return target + wanted * take_up\n",
        "tests/unit/procedures/test_approach.py",
    ),
    _one(
        "direction-forgotten-after-a-reversal",
        _SCARA,
        "        if travel >= take_up or (state == wanted and travel >= 0.0):\n",
        "        if travel >= take_up or travel >= 0.0:\n",
        "tests/unit/procedures/test_approach.py",
    ),
    _one(
        "file-consents-to-motion-of-a-real-arm",
        "app/engine/operator.py",
        "        return text is not None and (self._simulated or not prompt.moves_after(text))\n",
        "        return text is not None\n",
        "tests/unit/app/engine/test_consent.py",
        "tests/unit/app/engine/test_operator.py",
    ),
    _one(
        "emulated-operator-answers-for-a-real-arm",
        "app/engine/operator.py",
        "        if not self._simulated or prompt.by_person:\n",
        "        if prompt.by_person:\n",
        "tests/unit/app/engine/test_consent.py",
        "tests/unit/app/engine/test_operator.py",
    ),
)

STOPPING: Final = (
    _one(
        "stop-written-on-one-connection-only",
        "drivers/melfa/halt.py",
        '            session.send_urgent("STOP")\n',
        '            if session is self._connections.all[0]:\n                session.send_urgent("STOP")\n',
        "tests/unit/drivers/test_melfa_stop_and_heal.py",
    ),
    _one(
        "silent-program-not-noticed",
        "app/guard/guard.py",
        "        return self.moving and self.elapsed_s >= SILENCE_S\n",
        "        return False\n",
        "tests/unit/app/guard",
    ),
    _one(
        "silence-counted-while-nothing-moves",
        "app/guard/guard.py",
        "        return self.moving and self.elapsed_s >= SILENCE_S\n",
        "        return self.elapsed_s >= SILENCE_S\n",
        "tests/unit/app/guard",
    ),
)

ALL: Final = STORING + LINKS + MOTION + STOPPING
