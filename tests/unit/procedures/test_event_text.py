"""Words of a procedure for its events."""

from catseye.procedures.kit.event_text import EventText


def test_an_event_has_the_sentence_of_its_procedure() -> None:
    text = EventText(lambda data: f"off by {data['off_deg']:.3f}°")
    assert text.sentence("off", {"off_deg": 0.05}) == "off by 0.050°"


def test_a_sentence_that_fails_leaves_the_names() -> None:
    text = EventText(lambda data: f"off by {data['off_deg']:.3f}°")
    assert text.sentence("off", {"off_mm": 0.5}) == "off: off_mm 0.5"
