"""A link that spoils a share of the answers."""

import pytest

from catseye.simulators.ports.lossy import Lossy


def test_a_share_of_the_answers_is_spoilt_in_three_ways() -> None:
    lossy = Lossy(0.05, seed=1)
    arrived = [lossy.passed(b"QoK\r") for _ in range(4000)]
    assert set(arrived) == {b"QoK\r", b"", b"QoK\rQoK\r", b"\xd1oK\r"}
    # 200 of 4000 with a standard deviation of 13.8.
    assert 140 < sum(lossy.spoilt.values()) < 260
    assert min(lossy.spoilt.values()) > 30
    assert sum(answer == b"QoK\r" for answer in arrived) == 4000 - sum(lossy.spoilt.values())


@pytest.mark.parametrize(("share", "unchanged"), [(0.0, True), (1.0, False)])
def test_none_or_all_are_spoilt(share: float, unchanged: bool) -> None:
    lossy = Lossy(share, seed=2)
    assert all((lossy.passed(b"12\n") == b"12\n") is unchanged for _ in range(100))
