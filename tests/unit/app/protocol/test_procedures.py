"""Procedures by name and their parameters as texts."""

import json
from importlib import metadata
from pathlib import Path

import pytest

from catseye.app.cli.procedures import procedures as list_procedures
from catseye.app.errors import UsageError
from catseye.app.protocol import installed, procedures
from catseye.app.protocol.installed import procedure_names
from catseye.app.protocol.procedures import load_procedure, parse_params
from catseye.procedures.scara.open_loop.open_loop import OpenLoopParams
from catseye.procedures.scara.path.validation_path import PathParams
from catseye.procedures.scara.search.reflector_search import SearchParams


def test_the_built_in_procedures_are_installed() -> None:
    assert {"reflector-search", "open-loop", "validation-path"} <= set(procedure_names())
    for name in procedure_names():
        assert load_procedure(name).name == name


def test_an_unknown_procedure_suggests_the_nearest() -> None:
    with pytest.raises(UsageError, match=r"'open-lop'; did you mean open-loop\? Installed are: "):
        load_procedure("open-lop")
    with pytest.raises(UsageError, match=r"there is no procedure 'xyz'\. Installed are: .*open-loop"):
        load_procedure("xyz")


def test_a_broken_procedure_harms_no_other(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    request: pytest.FixtureRequest,
) -> None:
    (tmp_path / "acme_walk.py").write_text("import acme_dll", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    group = installed.GROUP
    odd = metadata.EntryPoint("acme-walk", "acme_walk:Walk", group)
    entries = metadata.EntryPoints([*metadata.entry_points(group=group), odd])
    names = {entry.name for entry in entries} - {"acme-walk"}
    monkeypatch.setattr(metadata, "entry_points", lambda **chosen: entries.select(**chosen))
    request.addfinalizer(procedures.loadable.cache_clear)
    procedures.loadable.cache_clear()
    assert {each.name for each in procedures.procedures()} == names
    (said,) = procedures.broken_procedures()
    assert said == (
        "procedure acme-walk of acme_walk cannot be loaded: ModuleNotFoundError: No module named 'acme_dll'; "
        "install acme_walk again, or remove it"
    )
    with pytest.raises(UsageError, match="acme-walk of acme_walk cannot be loaded"):
        load_procedure("acme-walk")
    list_procedures(as_json=True)
    shown = capsys.readouterr()
    assert {json.loads(line)["name"] for line in shown.out.splitlines() if "name" in line} == names
    assert f"warning: {said}" in shown.err


def test_texts_become_values_of_their_type() -> None:
    params = parse_params(PathParams, ["x_mm=150", " y_to_mm = -2.5e1 ", "hand=left", "passes=3"])
    assert params == PathParams(x_mm=150.0, y_to_mm=-25.0, hand="left", passes=3)
    chosen = parse_params(OpenLoopParams, ['reflectors=["P1", "P3"]', "subdivide=false"])
    assert chosen == OpenLoopParams(reflectors=["P1", "P3"], subdivide=False)
    assert parse_params(SearchParams, []) == SearchParams()


@pytest.mark.parametrize(
    ("texts", "parts"),
    [
        (["poses"], ["'poses'", "name=value"]),
        (["poses=3"], ["--param poses: 3", "4 … 40"]),
        (["poses=many"], ["--param poses: many", "whole number"]),
        (["poses=4.5"], ["--param poses: 4.5", "whole number"]),
        (["half_range_deg=nan"], ["--param half_range_deg"]),
        (["half_range_deg=inf"], ["--param half_range_deg"]),
        (
            ["pose=4", "half=2"],
            ["--param pose: unknown; known are mode, poses, most_poses, half_range_deg", "--param half"],
        ),
        (["=4"], ["unknown; known are mode, poses"]),
    ],
)
def test_a_wrong_parameter_is_reported_with_its_remedy(texts: list[str], parts: list[str]) -> None:
    with pytest.raises(UsageError) as caught:
        parse_params(SearchParams, texts)
    for part in parts:
        assert part in str(caught.value)
