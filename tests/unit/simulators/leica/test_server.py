"""The emulated emScon server, byte by byte, as the sheet `trackers_ballbar` (section 1) has it."""

import math
import struct

import numpy as np
import pytest

from catseye.simulators.leica.coordinates import KINDS, Units
from tests.unit.simulators.trackers import Client, near, tracker_bench

OK, BUSY, NOT_INITIALISED, UNKNOWN, NO_DISTANCE = 0, 1, 39, 36, 37

SIZES = {
    0: (12, 16),
    1: (12, 56),
    2: (12, 20),
    5: (32, 16),
    6: (12, 36),
    12: (60, 16),
    13: (12, 64),
    14: (68, 16),
    15: (12, 72),
    20: (36, 16),
    21: (12, 40),
    22: (28, 16),
    23: (12, 32),
    24: (16, 16),
    25: (12, 20),
    28: (20, 16),
    29: (12, 24),
    30: (28, 16),
    31: (12, 32),
    32: (32, 16),
    33: (12, 36),
    40: (16, 16),
    41: (12, 20),
    43: (24, 16),
    44: (12, 28),
    47: (48, 16),
    48: (12, 52),
    52: (12, 16),
    66: (12, 32),
    80: (20, 16),
    81: (12, 24),
    98: (12, 20),
    120: (20, 16),
    121: (16, 24),
    122: (12, 24),
    124: (12, 40),
    127: (12, 24),
    130: (16, 16),
    132: (12, 164),
    139: (12, 92),
    142: (12, 80),
}
"""Bytes of commands and replies, as the sheet lists them."""

MOVES = {53: 12, 54: 12, 55: 40, 56: 40, 57: 28, 58: 36, 59: 36, 60: 20, 62: 12, 63: 20, 65: 44}
"""Bytes of commands that move the beam."""


def command(number: int, layout: str = "", *values: float) -> bytes:
    data = struct.pack(f"<{layout}", *values)
    return struct.pack("<iii", 12 + len(data), 0, number) + data


def packets(said: bytes) -> list[tuple[int, bytes]]:
    """Return types and bodies of packets."""
    found = []
    while said:
        size, kind = struct.unpack_from("<ii", said)
        found.append((kind, said[8:size]))
        said = said[size:]
    return found


def status(said: bytes) -> tuple[int, int]:
    """Return command and status of a reply."""
    ((kind, body),) = packets(said)
    assert kind == 0
    return struct.unpack_from("<ii", body)


def client(**options: bool | float) -> Client:
    """Return a client that has millimetres, degrees and right-handed coordinates."""
    one = Client(tracker_bench("leica-emscon", options={"initialised": True, **options}))
    one.say(command(5, "5i", 1, 1, 0, 1, 0) + command(26, "i", 0))
    one.say(command(47, "9i", 2, 0, 0, 1, 0, 0, 0, 1, 0))
    return one


def seen(one: Client, name: str) -> tuple[float, ...]:
    """Point at a nest and measure it for a second."""
    one.say(command(55, "3di", *near(one.bench, name), 1))
    assert status(one.wait(2.0)) == (55, OK)
    one.say(command(28, "2i", 1000, 1))
    assert status(one.say(command(49))) == (49, OK)
    ((kind, body),) = packets(one.wait(1.5))
    assert kind == 2
    assert len(body) == 148
    return struct.unpack_from("<3d", body, 12)


def test_the_status_request_of_the_sheet_is_answered() -> None:
    said = Client(tracker_bench("leica-emscon")).say(bytes.fromhex("0C 00 00 00 00 00 00 00 01 00 00 00"))
    assert said[4:16] == bytes.fromhex("00 00 00 00 01 00 00 00 00 00 00 00")
    assert len(said) == 56


@pytest.mark.parametrize("number", SIZES)
def test_sizes_are_those_of_the_sheet(number: int) -> None:
    asked, replied = SIZES[number]
    one = client()
    stored = one.say(command(number + 1 if number != 120 else 121, *(("i", 1) if number == 120 else ())))
    # What is set is what was there, where the sheet has a command that reads it.
    body = stored[16:].ljust(asked, b"\0")[: asked - 12] if asked > 16 else struct.pack("<i", 1)[: asked - 12]
    said = one.say(struct.pack("<iii", asked, 0, number) + body)
    ((kind, found),) = packets(said)
    assert kind == 0
    assert struct.unpack_from("<ii", found) == (number, OK)
    assert len(found) + 8 == replied


@pytest.mark.parametrize("number", MOVES)
def test_motions_are_answered_when_they_are_over(number: int) -> None:
    one = client()
    said = one.say(struct.pack("<iii", MOVES[number], 0, number).ljust(MOVES[number], b"\1"))
    ((kind, body),) = packets(said + one.wait(10.0))
    assert kind == 0
    assert struct.unpack_from("<i", body) == (number,)
    assert len(body) + 8 == (32 if number == 65 else 16)


def test_reflectors_come_in_a_packet_each() -> None:
    found = packets(client().say(command(42)))
    assert [len(body) + 8 for _, body in found] == [100] * len(found)
    totals, numbers = zip(*(struct.unpack_from("<ii", body, 8) for _, body in found), strict=True)
    assert set(totals) == {len(found)}
    assert sorted(numbers) == list(range(1, len(found) + 1))
    offset_mm = struct.unpack_from("<d", found[0][1], 20)[0]
    assert offset_mm == pytest.approx(19.05)


@pytest.mark.parametrize("number", [-1, 64, 143, 9999])
def test_an_unknown_command_is_answered_so(number: int) -> None:
    assert status(client().say(command(number))) == (number, UNKNOWN)


@pytest.mark.parametrize("number", [*(n for n in MOVES if n not in {65}), 49])
def test_nothing_moves_before_it_is_initialised(number: int) -> None:
    one = Client(tracker_bench("leica-emscon"))
    data = struct.pack("<iii", MOVES.get(number, 12), 0, number).ljust(MOVES.get(number, 12), b"\0")
    assert status(one.say(data)) == (number, NOT_INITIALISED)


def test_initialisation_takes_time_and_locks_on_the_bird_bath() -> None:
    one = Client(tracker_bench("leica-emscon"))
    one.say(command(47, "9i", 2, 0, 0, 1, 0, 0, 0, 1, 0))
    assert one.say(command(7)) == b""
    assert status(one.say(command(55, "3di", 1.0, 0.0, 0.0, 1))) == (55, BUSY)
    assert status(one.wait(60.0)) == (7, OK)
    assert struct.unpack_from("<i", one.say(command(2)), 16) == (2,)


def test_a_measured_nest_is_where_it_is() -> None:
    one = client()
    assert seen(one, "nest1") == pytest.approx(near(one.bench, "nest1"), abs=2e-3)


def test_the_extended_result_has_covariances() -> None:
    one = client()
    one.say(command(80, "2i", 1, 1))
    one.say(command(55, "3di", *near(one.bench, "nest1"), 1))
    one.wait(2.0)
    one.say(command(49))
    ((kind, body),) = packets(one.wait(5.0))
    assert (kind, len(body) + 8) == (9, 204)


def test_a_place_without_a_target_sets_no_distance() -> None:
    one = client()
    one.say(command(55, "3di", 300.0, 300.0, 900.0, 1))
    assert status(one.wait(2.0)) == (55, NO_DISTANCE)
    assert struct.unpack_from("<i", one.say(command(2)), 16) == (0,)


def test_a_broken_beam_ends_a_measurement_with_an_error() -> None:
    one = client()
    one.say(command(55, "3di", *near(one.bench, "nest1"), 1))
    one.wait(2.0)
    one.say(command(49))
    one.bench.bench.tracker.block(0.5)
    assert [(kind, struct.unpack("<ii", body)) for kind, body in packets(one.wait(5.0))] == [(1, (49, 10009))]


def test_a_stopped_measurement_has_no_result() -> None:
    one = client()
    seen(one, "nest1")
    one.say(command(49))
    assert status(one.say(command(52))) == (52, OK)
    assert one.wait(5.0) == b""


def test_a_stream_has_several_points_a_packet() -> None:
    one = client()
    seen(one, "nest1")
    one.say(command(24, "i", 1) + command(30, "4i", 50, 12, 0, 0))
    assert status(one.say(command(49))) == (49, OK)
    counts, times = [], []
    for kind, body in packets(one.wait(3.0)):
        assert kind == 3
        count = struct.unpack_from("<i", body, 4)[0]
        assert len(body) + 8 == 48 + 36 * count
        counts.append(count)
        for k in range(count):
            flag, seconds, microseconds = struct.unpack_from("<iii", body, 40 + 36 * k)
            assert flag == 0
            times.append(seconds + 1e-6 * microseconds)
            place = struct.unpack_from("<3d", body, 52 + 36 * k)
            assert place == pytest.approx(near(one.bench, "nest1"), abs=2e-3)
    assert sum(counts) == 12
    assert len(counts) > 1
    np.testing.assert_allclose(np.diff(times), 0.05, atol=1e-6)


def test_the_bird_bath_is_always_there() -> None:
    one = client()
    one.say(command(55, "3di", 300.0, 300.0, 900.0, 1))
    one.wait(2.0)
    one.say(command(54))
    assert status(one.wait(2.0)) == (54, OK)
    assert struct.unpack_from("<i", one.say(command(2)), 16) == (2,)


def test_the_inclination_comes_as_a_packet_of_its_own() -> None:
    one = client()
    assert status(one.say(command(51))) == (51, OK)
    ((kind, body),) = packets(one.wait(2.0))
    assert (kind, len(body) + 8) == (6, 40)
    assert status(client(has_nivel=False).say(command(51))) == (51, 31)


def test_news_come_only_where_settings_say_so() -> None:
    one = client()
    seen(one, "nest1")
    one.say(command(53))
    assert [kind for kind, _ in packets(one.wait(5.0))] == [0]
    one.say(command(47, "9i", 2, 0, 0, 1, 1, 0, 0, 1, 0))
    one.say(command(53))
    codes = [struct.unpack("<i", body)[0] for kind, body in packets(one.wait(5.0)) if kind == 8]
    assert {26, 27, 30} <= set(codes)


def test_reflector_positions_come_only_where_settings_say_so() -> None:
    one = client()
    seen(one, "nest1")
    one.say(command(47, "9i", 2, 0, 0, 1, 0, 1, 0, 1, 0))
    found = packets(one.wait(1.0))
    assert {(kind, len(body) + 8) for kind, body in found} == {(7, 36)}
    assert struct.unpack_from("<3d", found[0][1], 4) == pytest.approx(near(one.bench, "nest1"), abs=1e-3)


def test_units_change_what_is_measured() -> None:
    one = client()
    in_mm = seen(one, "nest1")
    one.say(command(5, "5i", 5, 0, 0, 0, 0))
    one.say(command(49))
    ((_, body),) = packets(one.wait(2.0))
    assert np.multiply(struct.unpack_from("<3d", body, 12), 25.4) == pytest.approx(in_mm, abs=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_coordinates_are_turned_there_and_back(kind: int) -> None:
    units = Units((1, 1, 0, 1, 0), kind)
    place = (1234.0, -321.0, 55.0)
    assert units.to_place_mm(units.place(place)) == pytest.approx(place)


def test_a_left_handed_frame_is_a_mirror() -> None:
    place = np.array(Units((1, 0, 0, 0, 0), 2).place((1.0, 2.0, 3.0)))
    assert place.tolist() == [1.0, -2.0, 3.0]


def test_spherical_coordinates_are_angles_and_distance() -> None:
    turn, zenith, distance = Units((1, 1, 0, 0, 0), 7).place((0.0, 1000.0, 1000.0))
    assert (turn, zenith) == pytest.approx((90.0, 45.0))
    assert distance == pytest.approx(1000.0 * math.sqrt(2.0))


def test_a_refractive_index_out_of_range_is_refused() -> None:
    one = client()
    assert status(one.say(command(22, "2d", 1.0002, 1.0005))) == (22, 12)
    one.say(command(47, "9i", 0, 0, 0, 1, 0, 0, 0, 1, 0))
    assert status(one.say(command(22, "2d", 1.00025, 1.00025))) == (22, OK)


def test_a_wrong_air_lengthens_distances() -> None:
    one = client(has_weather=False)
    one.say(command(20, "3d", 20.0, 1013.25, 50.0))
    right = np.linalg.norm(seen(one, "nest1"))
    one.say(command(20, "3d", 30.0, 1013.25, 50.0))
    wrong = np.linalg.norm(seen(one, "nest1"))
    # Ten kelvin are some 9 µm in a metre: the air is taken for thinner than it is.
    assert (wrong - right) / right == pytest.approx(9.3e-6, abs=1e-6)


def test_a_cold_laser_measures_nothing() -> None:
    one = Client(tracker_bench("leica-emscon", options={"initialised": True, "warm_up_s": 100.0}))
    assert struct.unpack_from("<4i", one.say(command(1)), 16)[2] == 2
    assert status(one.say(command(49))) == (49, 10012)
    one.bench.bench.advance(101.0)
    assert struct.unpack_from("<4i", one.say(command(1)), 16)[2] == 3


def test_commands_may_come_cut_and_joined() -> None:
    one = client()
    data = command(98) + command(2)
    said = b"".join(one.say(bytes([byte])) for byte in data)
    assert said == one.say(data)
