"""A killed run stores what an uninterrupted one does, bit for bit; all places are a campaign's matter."""

from pathlib import Path

from tests.system.clocked_kills import whole


def test_a_twice_killed_run_has_the_same_bits(tmp_path: Path) -> None:
    assert whole(tmp_path / "killed", "before-commit:4", "after-motion:3") == whole(
        tmp_path / "uninterrupted"
    )
