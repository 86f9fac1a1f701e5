"""The emulated server by bytes: who is let in, what is refused, and what resources say."""

import hashlib
import json
import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from catseye.simulators.config import Joints, Option
from catseye.simulators.control_port.faults import FailRequests
from catseye.simulators.control_port.operations import carry_out
from catseye.simulators.emulated_bench import EmulatedAbbBench
from catseye.simulators.emulator import sessions_of
from catseye.simulators.ports.session import Pending, Session
from tests.unit.simulators.abb.benches import BENT, abb_bench


def md5(text: str) -> str:
    return hashlib.md5(text.encode()).hexdigest()


@dataclass
class Said:
    """An answer, taken apart by hand."""

    status: int
    head: str
    body: bytes

    @property
    def state(self) -> dict[str, Any]:
        """The first state of an answer in JSON."""
        found: dict[str, Any] = json.loads(self.body)["_embedded"]["_state"][0]
        return found


@dataclass
class Client:
    """A client written by hand."""

    bench: EmulatedAbbBench
    password: str = "robotics"
    cookies: bool = True
    cookie: str = ""
    nonce: str = ""
    count: int = 0
    session: Session = field(init=False)

    def __post_init__(self) -> None:
        self.connect()

    def connect(self) -> None:
        device = self.bench.context.config.devices[0]
        note = self.bench.journal.add
        if not hasattr(self.bench, "new_session"):
            made = sessions_of(self.bench.context, device, lambda text: note("robot", "request", text))
            self.bench.new_session = made  # type: ignore[attr-defined]  # all clients share what it makes
        self.session = self.bench.new_session()  # type: ignore[attr-defined]  # see above

    def get(self, target: str) -> Said:
        return self.ask("GET", f"{target}{'&' if '?' in target else '?'}json=1")

    def post(self, target: str, form: str = "") -> Said:
        return self.ask("POST", f"{target}{'&' if '?' in target else '?'}json=1", form)

    def ask(self, method: str, target: str, body: str = "") -> Said:
        """Ask as digest authentication wants it: without a proof first, and again with one."""
        said = self.say(method, target, body, proven=bool(self.nonce))
        if said.status == 401:
            found = re.search(r'nonce="(\w+)"', said.head)
            assert found is not None
            self.nonce, self.count = found[1], 0
            said = self.say(method, target, body)
        if self.cookies and (found := re.search(r"Set-Cookie: (-http-session-=[^;]+)", said.head)):
            self.cookie = found[1]
        return said

    def say(self, method: str, target: str, body: str = "", *, proven: bool = True) -> Said:
        lines = [f"{method} {target} HTTP/1.1", "Host: h", f"Content-Length: {len(body)}"]
        lines += [f"Cookie: {self.cookie}"] if self.cookie else []
        if proven:
            self.count += 1
            lines.append(self.proof(method, target))
        self.session.feed(("\r\n".join(lines) + "\r\n\r\n" + body).encode())
        answer = self.session.answer()
        if isinstance(answer, Pending):
            due_s = answer.due()
            assert due_s is not None
            self.bench.bench.advance_to(due_s)
            answer = answer.reply()
        assert answer is not None
        head, _, rest = answer.partition(b"\r\n\r\n")
        if self.session.over:
            self.connect()
        return Said(int(head.split()[1]), head.decode(), rest)

    def proof(self, method: str, target: str) -> str:
        """Return the header that proves a request."""
        secret, count = md5(f"Default User:validusers@robapi.abb:{self.password}"), f"{self.count:08x}"
        response = md5(f"{secret}:{self.nonce}:{count}:c:auth:{md5(f'{method}:{target}')}")
        return (
            f'Authorization: Digest username="Default User", realm="validusers@robapi.abb", nonce="{self.nonce}", '
            f'uri="{target}", qop=auth, nc={count}, cnonce="c", response="{response}"'
        )


@pytest.fixture
def bench() -> EmulatedAbbBench:
    return abb_bench()


@pytest.fixture
def client(bench: EmulatedAbbBench) -> Client:
    return Client(bench)


def of(options: dict[str, Option]) -> Client:
    return Client(abb_bench(options=options))


def test_a_stranger_is_challenged(client: Client) -> None:
    said = client.say("GET", "/rw/panel/opmode", proven=False)
    assert said.status == 401
    assert 'WWW-Authenticate: Digest realm="validusers@robapi.abb"' in said.head
    assert 'qop="auth"' in said.head
    assert "Set-Cookie" not in said.head


def test_a_wrong_password_stays_outside(bench: EmulatedAbbBench) -> None:
    assert Client(bench, password="guess").get("/rw/panel/opmode").status == 401


def test_a_proof_is_for_one_request_only(client: Client) -> None:
    client.get("/rw/panel/opmode")
    proof = client.proof("GET", "/rw/panel/opmode?json=1")  # of this very class
    client.session.feed(f"POST /rw/rapid/execution?action=stop HTTP/1.1\r\n{proof}\r\n\r\n".encode())
    answer = client.session.answer()
    assert isinstance(answer, Pending)
    client.bench.bench.advance(0.1)
    assert answer.reply().startswith(b"HTTP/1.1 401")


def test_a_proof_may_leave_the_part_of_a_resource_out(client: Client) -> None:
    # As `requests` of Python does, and with it rwsuis.
    target = "/rw/rapid/symbol/data/RAPID/T_ROB1/cats_seq"
    client.get(target)
    client.count += 1
    proof = client.proof("GET", f"{target}?json=1")  # of this very class
    client.session.feed(f"GET {target};value?json=1 HTTP/1.1\r\n{proof}\r\n\r\n".encode())
    answer = client.session.answer()
    assert isinstance(answer, Pending)
    client.bench.bench.advance(0.1)
    assert answer.reply().startswith(b"HTTP/1.1 200")


def test_a_count_is_not_taken_twice_where_strict() -> None:
    client = of({"strict_counts": True})
    assert client.get("/rw/panel/opmode").status == 200
    client.count -= 1
    said = client.say("GET", "/rw/panel/opmode?json=1")
    assert said.status == 401
    assert 'stale="TRUE"' in said.head


def test_a_nonce_grows_old(client: Client) -> None:
    client.get("/rw/panel/opmode")
    client.bench.bench.advance(301.0)
    said = client.say("GET", "/rw/panel/opmode?json=1")
    assert said.status == 401
    assert 'stale="TRUE"' in said.head


def test_sessions_are_given_by_cookies_and_are_seventy(bench: EmulatedAbbBench) -> None:
    careless = Client(bench, cookies=False)
    heads = [careless.get("/rw/panel/opmode").head for _ in range(70)]
    assert all("Set-Cookie: -http-session-=" in head and "Set-Cookie: ABBCX=" in head for head in heads)
    assert careless.get("/rw/panel/opmode").status == 503
    bench.bench.advance(301.0)
    assert careless.get("/rw/panel/opmode").status == 200


def test_a_session_that_logs_out_makes_room() -> None:
    first = of({"sessions": 1})
    second = Client(first.bench)
    assert first.get("/rw/panel/opmode").status == 200
    assert second.get("/rw/panel/opmode").status == 503
    assert first.get("/logout").status == 204
    assert second.get("/rw/panel/opmode").status == 200


def test_a_connection_ends_behind_its_last_request() -> None:
    client = of({"requests": 3})
    heads = [client.get("/rw/panel/opmode").head for _ in range(2)]
    assert [head.rpartition("Connection: ")[2].split("\r\n")[0] for head in heads] == ["keep-alive", "close"]


@pytest.mark.parametrize(
    ("target", "kind", "fields"),
    [
        ("/rw/panel/ctrlstate", "pnl-ctrlstate", {"ctrlstate": "motoron"}),
        ("/rw/panel/opmode", "pnl-opmode", {"opmode": "AUTO"}),
        ("/rw/panel/speedratio", "pnl-speedratio", {"speedratio": "100"}),
        ("/rw/rapid/execution", "rap-execution", {"ctrlexecstate": "running", "cycle": "forever"}),
        ("/rw/rapid/tasks", "rap-task-li", {"name": "T_ROB1", "active": "On", "motiontask": "TRUE"}),
        ("/rw/rapid/symbol/data/RAPID/T_ROB1/cats_seq", "rap-data", {"value": "0"}),
        ("/rw/rapid/symbol/data/RAPID/T_ROB1/CATSABB/cats_seq;value", "rap-data", {"value": "0"}),
        ("/rw/iosystem/signals/Local/DRV_1/do1", "ios-signal", {"lvalue": "0"}),
        ("/rw/elog/0", "elog-message-li", {"msgtype": "1"}),
    ],
)
def test_resources_have_the_sheets_fields(
    client: Client, target: str, kind: str, fields: dict[str, str]
) -> None:
    state = client.get(target).state
    assert state["_type"] == kind
    assert {name: state[name] for name in fields} == fields


def test_answers_are_xhtml_unless_json_is_wanted(client: Client) -> None:
    said = client.ask("GET", "/rw/panel/opmode")
    assert "Content-Type: application/xhtml+xml" in said.head
    assert b'<li class="pnl-opmode" title="opmode">' in said.body
    assert b'<span class="opmode">AUTO</span>' in said.body


def test_joints_are_those_of_the_bench(client: Client) -> None:
    state = client.get("/rw/motionsystem/mechunits/ROB_1/jointtarget").state
    assert [float(state[f"rax_{n}"]) for n in range(1, 7)] == pytest.approx(BENT, abs=1e-4)
    assert [float(state[f"eax_{letter}"]) for letter in "abcdef"] == [9e9] * 6


@pytest.mark.parametrize(
    ("joints", "place_mm", "quaternion"),
    [
        # The arm's description names the first; the others follow from it by turns about one axis.
        ((0.0,) * 6, (374.0, 0.0, 630.0), (0.5**0.5, 0.0, 0.5**0.5, 0.0)),
        ((90.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 374.0, 630.0), (0.5, -0.5, 0.5, 0.5)),
        (BENT, (302.0 + 72.0 * 0.75**0.5, 0.0, 594.0), (0.5, 0.0, 0.75**0.5, 0.0)),
    ],
)
def test_the_robtarget_is_that_of_the_description(
    joints: Joints, place_mm: tuple[float, ...], quaternion: tuple[float, ...]
) -> None:
    bench = abb_bench()
    bench.bench.move_to(joints)
    bench.bench.advance(10.0)
    state = Client(bench).get("/rw/motionsystem/mechunits/ROB_1/robtarget?tool=tool0&wobj=wobj0").state
    assert [float(state[axis]) for axis in "xyz"] == pytest.approx(place_mm, abs=1e-3)
    found = np.array([float(state[f"q{n}"]) for n in range(1, 5)])
    assert found * np.sign(found @ quaternion) == pytest.approx(np.array(quaternion), abs=1e-5)


@pytest.mark.parametrize(
    ("target", "form", "status"),
    [
        ("/rw/panel/nothing", None, 404),
        ("/rw/rapid/symbol/data/RAPID/T_ROB1/nothing", None, 404),
        ("/rw/rapid/symbol/data/RAPID/T_ROB1/cats_seq?action=set", "value=x", 400),
        ("/rw/rapid/symbol/data/RAPID/T_ROB1/cats_seq?action=set", "", 400),
        ("/rw/panel/speedratio?action=setspeedratio", "speed-ratio=101", 400),
        ("/rw/panel/ctrlstate?action=setctrlstate", "ctrl-state=init", 400),
        ("/rw/rapid/execution?action=start", "cycle=asis", 403),
        ("/rw/rapid/execution?action=resetpp", "", 403),
        ("/rw/rapid/tasks/T_ROB9?action=activate", "", 404),
        ("/rw/mastership/rapid?action=release", "", 403),
    ],
)
def test_what_is_refused_says_so_with_a_number(
    client: Client, target: str, form: str | None, status: int
) -> None:
    said = client.get(target) if form is None else client.post(target, form)
    refused = json.loads(said.body)["_embedded"]["status"]
    assert said.status == status
    assert refused["code"] < -1_073_000_000
    assert refused["msg"]


def test_execution_stops_and_starts_from_main(client: Client) -> None:
    assert client.post("/rw/rapid/execution?action=stop", "stopmode=stop").status == 204
    assert client.get("/rw/rapid/execution").state["ctrlexecstate"] == "stopped"
    assert client.get("/rw/rapid/tasks").state["excstate"] == "stopped"
    assert client.post("/rw/rapid/execution?action=resetpp").status == 204
    assert client.post("/rw/rapid/tasks/T_ROB1?action=deactivate").status == 204
    assert client.post("/rw/rapid/execution?action=start", "cycle=once").status == 403
    assert client.post("/rw/rapid/tasks/T_ROB1?action=activate").status == 204
    assert client.post("/rw/rapid/execution?action=start", "cycle=once").status == 204
    assert client.get("/rw/rapid/execution").state["cycle"] == "once"


def test_mastership_of_one_client_keeps_another_from_writing(bench: EmulatedAbbBench) -> None:
    first, second = Client(bench), Client(bench)
    seq = "/rw/rapid/symbol/data/RAPID/T_ROB1/cats_beat?action=set"
    assert second.post(seq, "value=1").status == 204
    assert first.post("/rw/mastership?action=request").status == 204
    assert second.post(seq, "value=2").status == 403
    assert second.post("/rw/mastership/rapid?action=request").status == 403
    assert first.post(seq, "value=2").status == 204
    assert second.post("/rw/rapid/execution?action=stop").status == 204
    assert first.post("/rw/mastership?action=release").status == 204
    assert second.post(seq, "value=3").status == 204


def test_nothing_is_written_without_mastership_where_strict() -> None:
    client = of({"explicit_mastership": True})
    seq = "/rw/rapid/symbol/data/RAPID/T_ROB1/cats_beat?action=set"
    assert client.post(seq, "value=1").status == 403
    assert client.post("/rw/mastership/rapid?action=request").status == 204
    assert client.post(seq, "value=1").status == 204


def test_mastership_ends_with_its_session(bench: EmulatedAbbBench) -> None:
    first, second = Client(bench), Client(bench)
    first.post("/rw/mastership/rapid?action=request")
    first.get("/logout")
    assert second.post("/rw/mastership/rapid?action=request").status == 204


def test_manual_mode_takes_writes_once_the_pendant_grants_them(client: Client) -> None:
    client.bench.controller.press("MANR")
    seq = "/rw/rapid/symbol/data/RAPID/T_ROB1/cats_beat?action=set"
    assert client.get("/rw/panel/opmode").state["opmode"] == "MANR"
    assert client.post(seq, "value=1").status == 403
    assert client.post("/rw/mastership?action=request").status == 403
    assert client.post("/users/rmmp", "privilege=modify").status == 204
    assert client.get("/users/rmmp/poll").state["status"] == "PENDING"
    client.bench.bench.advance(1.1)
    assert client.get("/users/rmmp/poll").state["status"] == "GRANTED"
    assert client.post(seq, "value=1").status == 204


@pytest.mark.parametrize(
    ("key", "state"), [("guard", "guardstop"), ("MANR", "guardstop"), ("AUTO", "motoron")]
)
def test_the_panel_is_seen(client: Client, key: str, state: str) -> None:
    client.bench.controller.press(key)
    assert client.get("/rw/panel/ctrlstate").state["ctrlstate"] == state


def test_an_emergency_stop_is_released_and_confirmed(client: Client) -> None:
    controller = client.bench.controller

    def state() -> object:
        return client.get("/rw/panel/ctrlstate").state["ctrlstate"]

    controller.set_emergency_stop(on=True)
    assert state() == "emergencystop"
    assert client.post("/rw/panel/ctrlstate?action=setctrlstate", "ctrl-state=motoron").status == 403
    controller.set_emergency_stop(on=False)
    assert state() == "emergencystopreset"
    controller.press("confirm")
    assert state() == "motoroff"
    assert client.post("/rw/panel/ctrlstate?action=setctrlstate", "ctrl-state=motoron").status == 204
    assert state() == "motoron"


def test_symbols_are_found_in_their_block(client: Client) -> None:
    def found(form: str) -> list[str]:
        said = client.post("/rw/rapid/symbols?action=search-symbols", form)
        return [state["symburl"] for state in json.loads(said.body)["_embedded"]["_state"]]

    assert "RAPID/T_ROB1/CATSABB/cats_goal" in found("blockurl=RAPID%2FT_ROB1&symtyp=per")
    assert found("blockurl=RAPID%2FT_ROB1&symtyp=prc&regexp=%5Emain%24") == ["RAPID/T_ROB1/CATSABB/main"]
    assert found("blockurl=RAPID%2FT_ROB2&symtyp=any") == []


def test_files_are_written_listed_read_and_deleted(client: Client) -> None:
    assert client.ask("PUT", "/fileservice/$HOME/cats/a.mod", "MODULE a").status == 201
    assert client.get("/fileservice/$HOME").state["_title"] == "cats"
    assert client.ask("GET", "/fileservice/%24HOME/cats/a.mod").body == b"MODULE a"
    assert client.ask("DELETE", "/fileservice/$HOME/cats/a.mod").status == 204
    assert client.get("/fileservice/$HOME/cats/a.mod").status == 404
    assert client.get("/ctrl/$RAMDISK").state["_value"].startswith("/")


def test_what_is_no_request_ends_the_connection(client: Client) -> None:
    client.session.feed(b"SSH-2.0\r\n\r\n")
    answer = client.session.answer()
    assert isinstance(answer, bytes)
    assert answer.startswith(b"HTTP/1.1 400")
    assert client.session.over


def test_what_was_sent_is_carried_out_without_its_client(client: Client) -> None:
    client.get("/rw/panel/opmode")
    client.count += 1
    target = "/rw/rapid/execution?action=stop"
    client.session.feed(f"POST {target} HTTP/1.1\r\n{client.proof('POST', target)}\r\n\r\n".encode())
    client.session.close()
    client.bench.bench.advance(0.1)
    assert not client.bench.controller.program.running


def test_requests_fail_and_may_take_effect(client: Client) -> None:
    carry_out(FailRequests(pattern="POST .*action=stop", carried_out=True), client.bench.reach)
    assert client.post("/rw/rapid/execution?action=stop").status == 503
    assert not client.bench.controller.program.running
    carry_out(FailRequests(pattern="GET .*opmode", count=2), client.bench.reach)
    assert [client.get("/rw/panel/opmode").status for _ in range(3)] == [503, 503, 200]


def test_a_session_has_another_key_than_the_nonce(client: Client) -> None:
    client.get("/rw/panel/opmode")
    assert client.cookie.rpartition("::")[2] != client.nonce
