"""Counter profiles: the built-in ones, and what is said about wrong ones."""

from pathlib import Path

import pytest

from catseye.drivers import counter
from catseye.drivers.counter.profile import built_in_profiles, load_profile, parse_profile
from catseye.drivers.roles.errors import ProfileError

GOOD = """
format = "catseye-counter/1"
title = "bench counter"
confirmed = true
compensated = "none"
[query]
command = "R"
reply = '(?P<value>[-+0-9.]+)'
[zero]
mode = "software"
[status]
command = "S"
reply = '(?P<bits>\\d+)'
[status.bits]
beam_lost = 0
[scale]
unit = "mm"
"""


def test_the_built_in_profiles_are_there() -> None:
    assert built_in_profiles() == ("default", "distax", "vacuum")


def test_the_default_profile_holds_the_defaults_of_the_sheet() -> None:
    """Interferometer sheet, section 9."""
    profile = load_profile("default")
    assert (profile.line.terminator, profile.line.encoding, profile.line.echo) == ("\r\n", "ascii", False)
    assert (profile.line.timeout_s, profile.line.gap_s) == (1.0, 0.0)
    assert profile.signal
    assert profile.identify
    assert profile.status
    commands = (profile.query.command, profile.zero.command, profile.status.command, profile.signal.command)
    assert (*commands, profile.identify.command) == ("R", "Z", "S", "L", "I")
    assert profile.status.bits.model_dump() == {
        "beam_lost": 0,
        "overspeed": 1,
        "beam_absent": 2,
        "laser_ready": 4,
    }
    assert profile.confirmed
    assert not profile.remark


def test_the_distax_template_claims_nothing() -> None:
    """Interferometer sheet, section 1: the protocol is not published; never say that it is supported."""
    profile = load_profile("distax")
    assert not profile.confirmed
    assert profile.title == "DISTAX via user profile"
    assert profile.remark == "protocol not published: complete and confirm the profile with the manual"


def test_every_value_of_the_distax_template_asks_to_be_confirmed() -> None:
    path = Path(counter.__file__).parent / "profiles" / "distax.toml"
    own = {"format", "title", "remark"}
    values = [
        line
        for line in path.read_text("utf-8").splitlines()
        if "=" in line and not line.startswith("#") and line.split(" =")[0] not in own
    ]
    assert len(values) > 20
    assert [line for line in values if "with the manual" not in line.partition("#")[2]] == []


def test_the_distax_template_differs_only_in_its_claims() -> None:
    claims = {"title", "remark", "confirmed", "compensated"}
    assert load_profile("distax").model_dump(exclude=claims) == load_profile("default").model_dump(
        exclude=claims
    )


def test_a_profile_file_is_read(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(GOOD)
    assert load_profile(str(file)).title == "bench counter"


def test_an_unknown_name_lists_the_built_in_profiles() -> None:
    with pytest.raises(ProfileError, match=r"'distacks' cannot be read .*built-in profiles: default, distax"):
        load_profile("distacks")


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ('unit = "mm"', 'units = "mm"', "key scale.units is unknown, the nearest valid key is 'unit'"),
        (
            "beam_lost = 0",
            "beam_lost = 0\nlaser_redy = 4",
            "key status.bits.laser_redy is unknown.*'laser_ready'",
        ),
        ("confirmed = true", "confirmed = true\ntitel = 'x'", "key titel is unknown.*'title'"),
        ("confirmed = true", 'confirmed = "yes"', "key confirmed: .*boolean"),
        ('unit = "mm"', 'unit = "cm"', "key scale.unit: .*'count', 'nm', 'um', 'mm' or 'inch'"),
        ('unit = "mm"', 'unit = "count"', "key scale: .*needs count_mm"),
        ('unit = "mm"', 'unit = "mm"\ncount_mm = 1e-5', "key scale: .*no other unit takes it"),
        ('unit = "mm"', 'unit = "mm"\nwrap_bits = 32', 'key scale: .*wrap_bits needs unit = "count"'),
        ("(?P<value>", "(?P<val>", r"key query: .*no group \(\?P<value>"),
        ("(?P<value>", "((?P<value>", "key query.reply: .*not a regular expression"),
        ("(?P<bits>", "(?P<word>", r"key status: .*no group \(\?P<bits>"),
        ('mode = "software"', 'mode = "device"', 'key zero: .*mode = "device" needs a command'),
        ('command = "R"', 'command = "R\\r\\n"', "key query.command: .*pattern"),
        ("beam_lost = 0", "beam_lost = 40", "key status.bits.beam_lost: .*less than or equal to 31"),
        ("beam_lost = 0", "overspeed = 1", "key status.bits.beam_lost: Field required"),
        ('title = "bench counter"', 'title = "bench', "not a TOML file"),
        ("catseye-counter/1", "catseye-counter/2", "key format: .*'catseye-counter/1'"),
    ],
)
def test_wrong_profiles_name_file_and_key(old: str, new: str, fault: str) -> None:
    assert old in GOOD
    with pytest.raises(ProfileError, match=f"mine.toml: .*{fault}"):
        parse_profile(GOOD.replace(old, new), "mine.toml")
