"""Which flags speak against a result."""

from catseye.calibration.resolution.flags import Flag, doubts

FOLLOWED = range(1, 61)


def test_faults_of_the_data_speak_against_a_result() -> None:
    flags = [Flag("outlier", "3 samples"), Flag("scale", "1.07"), Flag("missed", "gap", (80,))]
    assert doubts(flags, FOLLOWED) == flags


def test_what_every_good_test_has_speaks_against_none() -> None:
    flags = [Flag("partial-mean", "ends", (1, 2, 109)), Flag("drift", "subtracted"), Flag("torque", "none")]
    assert doubts(flags, FOLLOWED) == []


def test_only_steps_that_the_joint_should_follow_count() -> None:
    large, small = Flag("no-motion", "stood", (60, 61)), Flag("no-motion", "stood", (61, 70))
    behind = Flag("unexpected-motion", "behind the last move")
    assert doubts([large, small, behind], FOLLOWED) == [large, behind]
