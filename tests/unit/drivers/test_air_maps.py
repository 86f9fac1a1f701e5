"""Register maps of air sensors against the sheet of the environmental sensors."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from catseye.drivers.air.maps import AirSettings, Quantity, RegisterMap, check_plausible, decode, resolve
from catseye.drivers.roles.errors import ProfileError, ProtocolError


def resolved(**settings: object) -> RegisterMap:
    return resolve(AirSettings.model_validate(settings))


def test_the_float_of_the_sheet() -> None:
    """Section 1a, from the Indigo520 manual: 30.56 %RH = 0x41F47AE1 -> registers 7AE1 41F4."""
    assert decode([0x7AE1, 0x41F4], Quantity(0), "little") == pytest.approx(30.56, abs=1e-5)


def test_missing_values() -> None:
    """Section 1a: float = quiet NaN (0000 7FC0 in CDAB, section 5), int16 = 0x8000."""
    assert decode([0x0000, 0x7FC0], Quantity(0), "little") is None
    assert decode([0x8000], Quantity(0, "int16", 0.1), "big") is None
    assert decode([0x8001], Quantity(0, "int16"), "big") == -32767.0


def test_integers_are_scaled() -> None:
    """Section 2: Comet, int16 x10."""
    assert decode([0xFFF6], Quantity(0x31, "int16", 0.1), "big") == pytest.approx(-1.0)
    assert decode([10132], Quantity(0x34, "uint16", 0.1), "big") == pytest.approx(1013.2)
    assert decode([0x0001, 0x0000], Quantity(0, "int32"), "big") == 65536.0


@given(value=st.floats(width=32, allow_nan=False), little=st.booleans())
def test_floats_in_both_word_orders(value: float, little: bool) -> None:
    high, low = struct.unpack(">HH", struct.pack(">f", value))
    words = [low, high] if little else [high, low]
    assert decode(words, Quantity(0), "little" if little else "big") == value


def test_vaisala_has_no_pressure_until_its_address_is_given() -> None:
    """Section 1a: the PTU300's pressure register is unknown; the DPT145 has it at 45-46, PDU 0x2C."""
    vaisala = resolved()
    assert (vaisala.word_order, vaisala.function, vaisala.pressure) == ("little", 3, None)
    assert vaisala.temperature == Quantity(0x0002)
    assert vaisala.humidity == Quantity(0x0000)
    assert resolved(pressure_address=0x2C).pressure == Quantity(0x2C)


def test_comet() -> None:
    """Section 2: 0x0031 T, 0x0032 RH, 0x0034 pressure in hPa, int16 x10; the base is 1 in RTU documents."""
    comet = resolved(map="comet_web")
    assert comet.temperature == Quantity(0x31, "int16", 0.1)
    assert comet.humidity == Quantity(0x32, "int16", 0.1)
    assert comet.pressure == Quantity(0x34, "int16", 0.1)
    assert comet.wire_address(Quantity(0x31)) == 0x31
    assert resolved(map="comet_rtu").wire_address(Quantity(0x31)) == 0x30


def test_a_generic_sensor_is_described_by_settings() -> None:
    """Section 3: Campbell MetSENS300, 40001 P, 40003 RH, 40005 T, floats."""
    campbell = resolved(
        map="generic",
        points=[
            {"name": "pressure", "address": 1},
            {"name": "humidity", "address": 3},
            {"name": "temperature", "address": 5},
        ],
        address_base=1,
        function=4,
    )
    assert campbell.function == 4
    assert [campbell.wire_address(q) for q in campbell.quantities().values()] == [
        4,
        0,
        2,
    ]  # temperature, pressure, humidity


def test_settings_replace_what_the_map_says() -> None:
    kpa = resolved(
        map="comet_web",
        points=[{"name": "pressure", "address": 0x34, "type": "uint16", "scale": 0.1, "invalid": [65535]}],
        word_order="little",
    )
    assert kpa.pressure == Quantity(0x34, "uint16", 0.1, invalid=(65535,))
    assert kpa.temperature == Quantity(0x31, "int16", 0.1)
    assert kpa.word_order == "little"


def test_offset_and_the_sensors_own_numbers_for_no_value() -> None:
    kelvin = Quantity(0, "uint16", 0.1, -273.15, invalid=(9999.0,))
    assert decode([2932], kelvin, "big") == pytest.approx(20.05)
    assert decode([9999], kelvin, "big") is None


def test_a_quantity_twice_is_refused() -> None:
    twice = [{"name": "pressure", "address": 1}, {"name": "pressure", "address": 3}]
    with pytest.raises(ProfileError, match="points name pressure twice"):
        resolved(points=twice)


def test_a_map_without_quantities_is_refused() -> None:
    with pytest.raises(ProfileError, match="no quantity has a register: write"):
        resolved(map="generic")


def test_an_address_before_the_first_register_is_refused() -> None:
    with pytest.raises(ProfileError, match="humidity: address 0 lies before address_base = 1"):
        resolved(address_base=1)


def test_unknown_settings_are_refused() -> None:
    with pytest.raises(ValidationError, match="slave"):
        AirSettings.model_validate({"slave": 1})


@pytest.mark.parametrize(
    ("name", "value"),
    [("temperature", 60.1), ("temperature", -41.0), ("humidity", 101.0), ("humidity", -1e30)],
)
def test_values_that_no_air_has_name_register_and_remedy(name: str, value: float) -> None:
    with pytest.raises(
        ProtocolError, match=rf"{name} \(float32 at register 0x000\d.*check word_order \(now 'little'\)"
    ):
        check_plausible(name, value, resolved())  # type: ignore[arg-type]  # any name of the table


@pytest.mark.parametrize("value", [500.0, 1200.0, None])
def test_limits_belong_to_what_is_plausible(value: float | None) -> None:
    check_plausible("pressure", value, resolved(pressure_address=0x2C))
    with pytest.raises(ProtocolError, match="hPa"):
        check_plausible("pressure", float("inf"), resolved(pressure_address=0x2C))


@pytest.mark.parametrize("temperature_c", [20.123, 20.25, 20.0])
def test_a_wrong_word_order_is_found(temperature_c: float) -> None:
    """A temperature read in the other word order is no air temperature, a round one next to nothing."""
    high, low = struct.unpack(">HH", struct.pack(">f", temperature_c))
    value = decode([high, low], Quantity(2), "little")
    with pytest.raises(ProtocolError, match="word_order"):
        check_plausible("temperature", value, resolved())
