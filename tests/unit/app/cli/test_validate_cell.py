"""A cell file that no run could use is refused by `config validate`, on the screen and as JSON."""

import json
import re
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.config import validate
from catseye.app.errors import ConfigError

EXTRA = '[[device]]\nname = "lamp"\nendpoint = "tcp://127.0.0.1:5000"\n'


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (
            ("[interferometer]\ndriver =", '[interferometer]\ndriver = "umx" #'),
            "no driver 'umx' is installed",
        ),
        (("[robot]\n", "[robot]\nnonsense = 1\n"), "nonsense"),
        (
            ("[robot]\n", f'{EXTRA}driver = "nonsense"\n[robot]\n'),
            r"\[lamp\] driver: no driver 'nonsense' is installed",
        ),
        (
            ("[robot]\n", f'{EXTRA}driver = "line-counter"\nsettings.profile = "none"\n[robot]\n'),
            r"\[lamp\]: counter profile 'none' cannot be read",
        ),
        (
            ('profile = "default"', 'profile = "none"'),
            r"\[interferometer\]: counter profile 'none' cannot be",
        ),
        (('map = "vaisala"', 'map = "none"'), r"\[environment\] map: Input should be 'vaisala'"),
    ],
)
def test_a_cell_that_no_run_could_use_is_refused(
    fault: tuple[str, str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "cell.toml"
    assert fault[0] in TEMPLATE
    path.write_text(TEMPLATE.replace(*fault), encoding="utf-8")
    with pytest.raises(ConfigError, match=said):
        validate(path, as_json=False)
    assert capsys.readouterr().out == ""
    with pytest.raises(ConfigError, match=said):
        validate(path, as_json=True)
    answer = json.loads(capsys.readouterr().out)
    assert answer["valid"] is False
    assert re.search(said, " ".join(answer["faults"]))
