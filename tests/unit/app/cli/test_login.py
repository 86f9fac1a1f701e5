"""User and password, typed before a command begins."""

import pytest

from catseye.app.cli.login import ask_logins, logins
from catseye.app.errors import UsageError
from catseye.drivers.abb.settings import login_of

USER, PASSWORD = "CATSEYE_ABB_USER", "CATSEYE_ABB_PASSWORD"


class Typed:
    """Somebody at the keys."""

    def __init__(self, *texts: str) -> None:
        self.texts = list(texts)
        self.asked: list[str] = []

    def __call__(self, question: str) -> str:
        self.asked.append(question)
        return self.texts.pop(0)


def test_only_controllers_with_users_are_asked_for() -> None:
    assert {name: (one.user, one.password) for name, one in logins().items()} == {"abb-rws": (USER, PASSWORD)}


def test_the_driver_takes_what_was_typed() -> None:
    environment: dict[str, str] = {}
    users, passwords = Typed(" ada "), Typed("s ecret ")
    ask_logins(environment, users, passwords, at_terminal=True)
    login = login_of(environment)
    assert (login.user, login.password) == ("ada", "s ecret ")
    assert passwords.asked == ["abb-rws, password of ada: "]
    assert "s ecret" not in "".join(users.asked + passwords.asked)


@pytest.mark.parametrize(
    ("environment", "user"), [({}, "Default User"), ({USER: "bob"}, "bob")], ids=["factory", "environment"]
)
def test_return_keeps_the_known_user(environment: dict[str, str], user: str) -> None:
    users = Typed("")
    ask_logins(environment, users, Typed("x"), at_terminal=True)
    assert environment[USER] == user
    assert user in users.asked[0]


@pytest.mark.parametrize("typed", ["", "bob"])
@pytest.mark.parametrize("known", [{}, {PASSWORD: "kept"}])
def test_return_keeps_the_known_password(known: dict[str, str], typed: str) -> None:
    environment, passwords = {USER: "bob", **known}, Typed("")
    ask_logins(environment, Typed(typed), passwords, at_terminal=True)
    assert environment == {USER: "bob", **known}
    assert passwords.asked == ["abb-rws, password of bob [unchanged]: "]


def test_another_user_never_has_the_known_password() -> None:
    environment = {USER: "bob", PASSWORD: "bobs"}
    ask_logins(environment, Typed("ada"), Typed(""), at_terminal=True)
    assert environment == {USER: "ada", PASSWORD: ""}


def test_without_a_terminal_the_variables_are_named() -> None:
    with pytest.raises(UsageError, match=f"set {USER}, {PASSWORD} instead"):
        ask_logins({}, Typed(), Typed(), at_terminal=False)
