"""Reports on a terminal."""

from dataclasses import replace

from catseye.app.protocol.banners import SIMULATION_TEXT
from catseye.app.render.text import block_lines, report_text, statement_lines, table_text, tables_text
from catseye.app.results.model import Bullets, Entries, Paragraph, Section
from tests.unit.app.render.reports import REPORT, TABLE


def test_numbers_are_flush_right_and_have_an_ascii_minus() -> None:
    assert table_text(TABLE).splitlines() == [
        "quantity  unit  value mm  rows",
        "--------  ----  --------  ----",
        "L1        mm     -1.2346     3",
        "L2 µ      mm           –    12",
    ]


def test_sentences_of_brief_sections_have_their_signs() -> None:
    assert list(statement_lines(REPORT)) == [
        "✓ A sentence that is good.",
        "warning: A sentence that is attention.",
        "✗ A sentence that is bad.",
        "A sentence that is neutral.",
    ]


def test_captions_distinguish_several_tables() -> None:
    assert tables_text(REPORT) == table_text(TABLE)
    twice = Section("two", "Two", (TABLE, replace(TABLE, caption="Others")), brief=True)
    first, second = tables_text(replace(REPORT, sections=(twice,))).split("\n\n")
    assert (first.splitlines()[0], second.splitlines()[0]) == ("Values", "Others")


def test_a_report_as_text_has_title_banners_and_brief_sections() -> None:
    origin = replace(REPORT.origin, simulated=True, unverified=("a run was changed",))
    lines = report_text(replace(REPORT, origin=origin)).splitlines()
    assert lines[:6] == [
        "Title",
        "  UNVERIFIED: a run was changed",
        f"  {SIMULATION_TEXT}",
        "",
        "Verdict",
        "  ✓ A sentence that is good.",
    ]
    assert "Values" in lines
    assert "More" not in lines


def test_entries_are_wrapped_beside_their_labels() -> None:
    first, *others = block_lines(Entries((("07:33:40", "word " * 40 + "\nsecond"), ("07:34:00", "short"))))
    assert first.startswith("07:33:40  word word")
    assert all(len(line) <= 118 for line in (first, *others))
    assert [line[:10] for line in others] == [" " * 10, " " * 10, "07:34:00  "]
    assert others[1] == " " * 10 + "second"


def test_bullets_stand_below_their_title_and_paragraphs_on_pages_only() -> None:
    assert block_lines(Bullets("Left out", ("one", "two"))) == ["Left out", "- one", "- two"]
    assert block_lines(Paragraph("explains")) == []
