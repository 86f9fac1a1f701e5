"""Numbers in the free columns of anchors and priors are finite and written in digits."""

from collections.abc import Callable
from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.anchors import read_anchors
from catseye.app.results.serial_arm.priors import read_priors

TABLES: dict[str, tuple[Callable[[Path], object], str]] = {
    "anchors": (read_anchors, "anchor,x_mm,y_mm,z_mm,u_mm\ncup1,{},2.0,3.0,0.01\n"),
    "priors": (read_priors, "name,u,value\nJ2.a_mm,0.1,{}\n"),
}


@pytest.mark.parametrize("number", ["nan", "inf", "-Infinity", "1e999", "1_0"])
@pytest.mark.parametrize(("read", "text"), TABLES.values(), ids=TABLES)
def test_what_is_no_finite_number_is_refused(
    tmp_path: Path, read: Callable[[Path], object], text: str, number: str
) -> None:
    path = tmp_path / "table.csv"
    path.write_text(text.format(number), "utf-8")
    with pytest.raises(UsageError, match=r"table\.csv:2: "):
        read(path)
