"""Cell files with other values: exactly these values, and the comments of what stays."""

import tomllib
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.app.cell.rewriting import CommentsLostError, plain, rewritten
from catseye.app.cell.scara.template import TEMPLATE

TEXTS = st.text(st.characters(codec="utf-8"), max_size=12)
SCALARS = TEXTS | st.booleans() | st.integers(-(10**12), 10**12) | st.floats(allow_nan=False)
VALUES = st.recursive(SCALARS, lambda inner: st.lists(inner, max_size=3), max_leaves=6)
TABLES = st.dictionaries(TEXTS, VALUES, max_size=4)


@settings(max_examples=60)
@given(VALUES | TABLES)
def test_a_value_is_read_as_it_was(value: Any) -> None:
    assert tomllib.loads(plain({"key": value}))["key"] == value


@settings(max_examples=40)
@given(st.dictionaries(TEXTS, VALUES | TABLES | st.lists(TABLES, min_size=1, max_size=3), max_size=5))
def test_a_file_without_comments_has_the_wanted_values(data: dict[str, Any]) -> None:
    assert tomllib.loads(plain(data)) == data


@settings(max_examples=40)
@given(st.data())
def test_rewriting_the_template_yields_exactly_the_wanted_values(data: st.DataObject) -> None:
    wanted = tomllib.loads(TEMPLATE)
    for section in data.draw(
        st.lists(st.sampled_from([k for k, v in wanted.items() if isinstance(v, dict)]), max_size=4)
    ):
        table = wanted.get(section)
        if table is None or data.draw(st.booleans()):
            wanted.pop(section, None)
            continue
        if section != "uncertainty":  # its list has no header of its own
            table[data.draw(st.sampled_from(["new_key", *table]))] = data.draw(SCALARS)
    wanted["reflector"] = data.draw(
        st.permutations(wanted["reflector"]).flatmap(lambda all_: st.integers(1, 3).map(lambda n: all_[:n]))
    )
    wanted["device"] = data.draw(st.lists(TABLES, min_size=1, max_size=2))
    assert tomllib.loads(rewritten(TEMPLATE, wanted)) == wanted


@pytest.mark.parametrize("value", [True, "", [1.0, 2.0]])
def test_a_value_may_take_the_place_of_a_table(value: Any) -> None:
    wanted = tomllib.loads(TEMPLATE)
    assert isinstance(wanted["robot"]["limits_deg"], dict)
    wanted["robot"]["limits_deg"] = value
    assert tomllib.loads(rewritten(TEMPLATE, wanted)) == wanted


def test_what_stays_keeps_its_line_and_what_changes_its_comment() -> None:
    wanted = tomllib.loads(TEMPLATE)
    wanted["robot"]["override_cap_percent"] = 5
    new = rewritten(TEMPLATE, wanted).splitlines()
    changed = [(old, line) for old, line in zip(TEMPLATE.splitlines(), new, strict=True) if old != line]
    assert changed == [
        (
            "override_cap_percent = 20               # the program never drives faster",
            "override_cap_percent = 5                # the program never drives faster",
        )
    ]


def test_a_hash_in_a_text_is_no_comment() -> None:
    assert rewritten('name = "a#b"  # kept # too\n', {"name": "c#d"}).split("  ")[0] == 'name = "c#d"'
    assert rewritten('name = "a#b"  # kept # too\n', {"name": "c#d"}).endswith("# kept # too\n")


def test_values_over_several_lines_are_replaced_whole() -> None:
    text = "[m]\nnodes = [\n  1,\n  2,\n]  # deg\nmore = 1\n"
    new = rewritten(text, {"m": {"nodes": [1, 3], "more": 1}})
    assert new == "[m]\nnodes = [1, 3] # deg\nmore = 1\n"


def test_removing_a_reflector_keeps_the_lines_of_the_others() -> None:
    text = '# above\n[[reflector]]  # one\nname = "A"\nx = 1  # mm\n\n# two\n[[reflector]]\nname = "B"\nx = 2  # mm\n'
    assert rewritten(text, {"reflector": [{"name": "B", "x": 3}]}) == (
        '# above\n\n# two\n[[reflector]]\nname = "B"\nx = 3  # mm\n'
    )


def test_a_removed_table_takes_the_comments_above_it() -> None:
    text = "# head\n[a]\nx = 1\n\n# about b\n[b]\ny = 2\n\n# about c\n[c]\nz = 3\n"
    wanted = {"a": {"x": 1}, "c": {"z": 3}}
    assert rewritten(text, wanted) == "# head\n[a]\nx = 1\n\n# about c\n[c]\nz = 3\n"


def test_a_new_key_stands_with_those_of_its_table() -> None:
    text = "[a]\nx = 1\n\n# about b\n[b]\ny = 2\n"
    assert rewritten(text, {"a": {"x": 1, "new": 5}, "b": {"y": 2}}) == (
        "[a]\nx = 1\nnew = 5\n\n# about b\n[b]\ny = 2\n"
    )


@pytest.mark.parametrize(
    ("text", "wanted", "expected"),
    [
        (
            "robot.limits.j1 = [1, 2]  # deg\n",
            {"robot": {"limits": {"j1": [1, 3]}}},
            "robot.limits.j1 = [1, 3]  # deg\n",
        ),
        ('reflector = [{ name = "A" }]\n', {"reflector": [{"name": "B"}]}, '\n[[reflector]]\nname = "B"\n'),
        ("reflector = 5\n", {"reflector": [{"name": "B"}]}, '\n[[reflector]]\nname = "B"\n'),
        ('[[reflector]]\nname = "A"\n', {"reflector": "B"}, 'reflector = "B"\n'),
    ],
)
def test_any_form_of_a_value_is_changed(text: str, wanted: dict[str, Any], expected: str) -> None:
    assert rewritten(text, wanted) == expected


def test_line_ends_of_windows_stay() -> None:
    text = 'a = 1 # one\r\n[t]\r\nb = """x\r\ny"""\r\n'
    wanted = {"a": 2, "t": {"b": "x\ny", "c": 3}, "u": [{"d": 4}, {"d": 5}]}
    new = rewritten(text, wanted)
    assert new.count("\n") == new.count("\r\n") > 5
    assert tomllib.loads(new) == wanted
    mixed = "a = 1\r\nb = 2\n"
    assert rewritten(mixed, {"a": 1, "b": 3}) == "a = 1\r\nb = 3\n"


def test_a_table_in_several_parts_loses_its_comments() -> None:
    with pytest.raises(CommentsLostError, match="comments"):
        rewritten("[a.b]\nx = 1\n[c]\ny = 2\n[a.d]\nz = 3\n", {"a": {"b": {"x": 2}, "d": {}}, "c": {"y": 2}})
