"""Reports on a terminal."""

from dataclasses import replace

from catseye.app.render.text import statement_lines, table_text, tables_text
from catseye.app.results.model import Section
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


def test_captions_tell_several_tables_apart() -> None:
    assert tables_text(REPORT) == table_text(TABLE)
    twice = Section("two", "Two", (TABLE, replace(TABLE, caption="Others")), brief=True)
    first, second = tables_text(replace(REPORT, sections=(twice,))).split("\n\n")
    assert (first.splitlines()[0], second.splitlines()[0]) == ("Values", "Others")
