"""The critical faults of `make mutations` can still be put in, each in its place."""

import shutil
from pathlib import Path

import pytest

from tests.mutations.critical import ALL, Edit, Mutation
from tests.mutations.trial import ROOT, Outcome, passes, put_in


@pytest.mark.parametrize("mutation", ALL, ids=lambda each: each.name)
def test_a_fault_finds_its_place_and_its_tests(mutation: Mutation, tmp_path: Path) -> None:
    for edit in mutation.edits:
        (tmp_path / edit.path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / edit.path, tmp_path / edit.path)
    with put_in(mutation, tmp_path):
        for edit in mutation.edits:
            changed = (tmp_path / edit.path).read_text(encoding="utf-8")
            compile(changed, edit.path, "exec")
            assert changed != (ROOT / edit.path).read_text(encoding="utf-8")
    for edit in mutation.edits:
        assert (tmp_path / edit.path).read_bytes() == (ROOT / edit.path).read_bytes()
    assert all((ROOT / test).exists() for test in mutation.tests)


def test_names_of_faults_differ() -> None:
    assert len({each.name for each in ALL}) == len(ALL)


def test_a_text_that_stands_twice_is_refused(tmp_path: Path) -> None:
    (tmp_path / "one.py").write_text("x = 1\nx = 1\n")
    twice = Mutation("twice", (Edit("one.py", "x = 1", "x = 2"),), ())
    with pytest.raises(ValueError, match="2 ×"), put_in(twice, tmp_path):
        pass


@pytest.mark.parametrize(
    ("test", "outcome"),
    [
        ("def test_one() -> None: pass", Outcome.SURVIVED),
        ("def test_one() -> None: assert False", Outcome.CAUGHT),
        ("no python", Outcome.BROKEN),
    ],
)
def test_only_a_failing_test_catches_a_fault(tmp_path: Path, test: str, outcome: Outcome) -> None:
    (tmp_path / "pyproject.toml").write_text("")
    (tmp_path / "test_one.py").write_text(test)
    assert passes(tmp_path, ["test_one.py"]) is outcome
