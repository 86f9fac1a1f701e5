"""Documents that travel with a table come back, and no spreadsheet takes a part of them for a formula."""

import importlib
import json
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from catseye.app.files.attached import attached_documents, attached_metadata, document_comments
from catseye.app.files.columns import read_table
from catseye.app.files.csv_text import csv_text
from catseye.app.files.tabular import table_parquet
from catseye.procedures.kit.columns import ColumnRule, TableRule
from tests.unit.app.files.spreadsheet import formulas

TABLE = TableRule("numbers", "one number", ((ColumnRule("x"),),))
DOCUMENT = {"format": "catseye-test/1", "list": [{"name": "beam, J1; x", "value": 1e-06}], "sha256": "00ff"}
TRICKY = st.text(st.sampled_from("'\"=+-@#;,:\\{}\t\r\n aé1\u2028\uff1d"), max_size=12)


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_table_brings_its_document_along(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"table.{suffix}"
    if suffix == "csv":
        path.write_text(csv_text(["x"], [[1.5]], ["talk", *document_comments({"catseye-test": DOCUMENT})]))
    else:
        path.write_bytes(table_parquet([{"x": 1.5}], {"catseye-test": DOCUMENT, "other": 1}))
    attached = read_table(path, TABLE).attached
    assert {kind: json.loads(text) for kind, text in attached.items()} == {"catseye-test": DOCUMENT}


@example("-1, -2")
@example('\\"=1')
@given(TRICKY)
def test_any_text_comes_back_and_is_no_formula(text: str) -> None:
    document = {"name": text, "list": [text, -1.5, {text: 1e300}]}
    written = csv_text(["x"], [], document_comments({"catseye-test": document}))
    assert formulas(written) == []
    (found,) = attached_documents(written.splitlines()).values()
    assert json.loads(found) == document


def test_other_comments_and_metadata_are_passed_over() -> None:
    assert attached_documents(["# catseye export", "# {'a': 1}", "# catseye-x", "", "#catseye-a {}"]) == {
        "catseye-a": "{}"
    }
    assert attached_metadata({b"pandas": b"{}", b"\xff": b"\xff", b"catseye-a": b"{}"}) == {"catseye-a": "{}"}


def test_a_document_below_the_header_does_not_count(tmp_path: Path) -> None:
    (comment,) = document_comments({"catseye-test": DOCUMENT})
    (tmp_path / "t.csv").write_text(f"x\n# {comment}\n1\n")
    assert read_table(tmp_path / "t.csv", TABLE).attached == {}


def test_parquet_needs_no_metadata(tmp_path: Path) -> None:
    arrow, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    parquet.write_table(arrow.table({"x": [1.0]}), tmp_path / "t.parquet")
    assert read_table(tmp_path / "t.parquet", TABLE).attached == {}
