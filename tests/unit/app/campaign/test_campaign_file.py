"""A campaign file is checked before anything moves, and every fault is named."""

import tomllib
from pathlib import Path

import pytest

from catseye.app.campaign.checks import require_doable
from catseye.app.campaign.load import load_campaign, shipped
from catseye.app.campaign.model import Value, value_text
from catseye.app.cli.init import init
from catseye.app.cli.lazy import options_of_command
from catseye.app.errors import ConfigError, UsageError
from catseye.app.protocol.procedures import procedures
from catseye.app.results.readiness.stages import CellStage
from catseye.app.results.readiness.survey import survey_cell
from tests.unit.app.campaign.night import Night

HEAD = 'format = "catseye-campaign/1"\nname = "mine"\n'


def written(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(HEAD + text)
    return path


def ways(night: Night) -> list[CellStage]:
    return list(night.stages.values())


def complaint(night: Night, text: str) -> str:
    """Return what is wrong with a campaign on a cell; empty where nothing is."""
    loaded = load_campaign(written(night.folder, text))
    try:
        require_doable(loaded, ways(night), procedures(), options_of_command)
    except UsageError as error:
        return str(error)
    return ""


def refused(tmp_path: Path, text: str) -> str:
    said = complaint(Night(tmp_path), text)
    assert said
    return said


def test_an_unknown_key_is_named_with_its_line(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"mine.toml:5: .*retrys.*did you mean retries\?"):
        load_campaign(written(tmp_path, '[[stage]]\nname = "search"\nretrys = 2\n'))


@pytest.mark.parametrize("key", ["params.a", "options.a", "files.a", "command"])
def test_what_no_process_can_be_given_is_refused(key: str, tmp_path: Path) -> None:
    value = '["compare", "a\\u0000b"]' if key == "command" else '"a\\u0000b"'
    with pytest.raises(ConfigError, match=r"mine.toml:\d: stage\[1\]"):
        load_campaign(written(tmp_path, f'[[stage]]\nname = "search"\n{key} = {value}\n'))


def test_a_text_longer_than_a_file_name_is_taken(tmp_path: Path) -> None:
    loaded, reason = load_campaign(written(tmp_path, '[[stage]]\nname = "search"\n')), "because " * 100
    assert loaded.text(reason) == reason
    entry = loaded.campaign.stage[0].model_copy(update={"options": {"accept_implausible": reason}})
    assert loaded.fingerprint(entry)


def test_a_stage_stands_there_once(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"two .*stage.* are called search"):
        load_campaign(written(tmp_path, '[[stage]]\nname = "search"\n' * 2))


def test_a_missing_file_names_those_shipped(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="scara-day"):
        load_campaign(tmp_path / "none.toml")


def test_a_deadline_in_the_file_is_checked(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"mine\.toml: deadline 'soon'"):
        load_campaign(written(tmp_path, 'deadline = "soon"\n[[stage]]\nname = "search"\n'))


def test_a_stage_off_the_way_is_refused(tmp_path: Path) -> None:
    assert "stage serch: it is not on the way of this cell, which with these stages has search" in refused(
        tmp_path, '[[stage]]\nname = "serch"\n'
    )


def test_params_belong_to_procedures_alone(tmp_path: Path) -> None:
    assert "takes options and files" in refused(tmp_path, '[[stage]]\nname = "identify"\nparams.a = 1\n')


def test_an_own_command_moves_nothing(tmp_path: Path) -> None:
    said = refused(tmp_path, '[[stage]]\nname = "x"\ncommand = ["run", "open-loop"]\n')
    assert "'run' is no command on stored data" in said


def test_unknown_parameters_are_found_beforehand(tmp_path: Path) -> None:
    night = Night(tmp_path)
    night.stages["open-loop"] = CellStage("open-loop", True, "next", "", "", words=("run", "open-loop"))
    loaded = load_campaign(written(tmp_path, '[[stage]]\nname = "open-loop"\nparams.nonsense = 1\n'))
    with pytest.raises(UsageError, match="nonsense: unknown"):
        require_doable(loaded, ways(night), procedures(), options_of_command)


def test_files_beside_the_campaign_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir("/")
    (tmp_path / "path.csv").write_text("x_mm,y_mm\n")
    loaded = load_campaign(written(tmp_path, '[[stage]]\nname = "search"\n'))
    assert loaded.text("path.csv") == str(tmp_path / "path.csv")
    assert loaded.text("P1") == "P1"


@pytest.mark.parametrize("value", [[1, 2.5, "a b", True], 3, 2.5, True, ["a\\b", 'c"d', "\n\x7f"]])
def test_values_reach_the_command_line_unchanged(value: Value) -> None:
    assert tomllib.loads(f"value = {value_text(value)}")["value"] == value


@pytest.mark.parametrize("system", ["scara", "resolution", "six-axis"])
def test_shipped_days_are_the_list_of_the_day(system: str, tmp_path: Path) -> None:
    cell = tmp_path / "cell.toml"
    init(cell, system=system)
    night = Night(tmp_path)
    survey = survey_cell(cell, tmp_path / "runs", night.clock.now_utc())
    loaded = load_campaign(Path(f"{system}-day"))
    require_doable(loaded, survey.stages, survey.procedures, options_of_command)
    names = [entry.name for entry in loaded.campaign.stage]
    way = [stage.name for stage in survey.stages]
    assert [name for name in way if name in names] == names
    # What is left out is optional, wants hands or a file that only the user has.
    left = {name for name in way if name not in names}
    assert left <= {
        "radial-error-motion",
        "budget",
        "compensate",
        "predict-resolution",
        "resolution-cartesian",
        "ballbar",
    }
    assert set(shipped()) == {"scara-day", "resolution-day", "six-axis-day"}


@pytest.mark.parametrize(
    ("stage", "said"),
    [
        (
            'name = "x"\ncommand = ["show", "{runn}"]',
            "nothing is known as {runn}; its words may name {cell}, {folder}",
        ),
        (
            'name = "x"\ncommand = ["compare", "a", "b", "--limit-uu", "3"]',
            "compare has no option --limit-uu; it has ",
        ),
        (
            'name = "x"\ncommand = ["compare", "a", "b", "--limit-uu=3"]',
            "compare has no option --limit-uu; it has ",
        ),
        ('name = "x"\ncommand = ["show", "{run-id}"]', "nothing is known as {run-id}; "),
        ('name = "x"\ncommand = ["show", "{}"]', "nothing is known as {}; "),
        ('name = "x"\ncommand = ["report", "a", "-q", "b"]', "report has no option -q; it has "),
        ('name = "identify"\noptions.modell = "map"', "identify has no option --modell; it has "),
    ],
)
def test_unknown_words_are_found_beforehand(stage: str, said: str, tmp_path: Path) -> None:
    assert said in refused(tmp_path, f"[[stage]]\n{stage}\n")


def test_known_options_are_taken(tmp_path: Path) -> None:
    words = '"compare", "{folder}/a", "{result}", "--limit-u", "3", "--json", "-5"'
    assert complaint(Night(tmp_path), f'[[stage]]\nname = "x"\ncommand = [{words}]\n') == ""


@pytest.mark.parametrize(("reuse", "refused"), [("job", True), ("cell", False)])
def test_a_job_needs_what_its_stages_count_after(reuse: str, refused: bool, tmp_path: Path) -> None:
    night = Night(tmp_path)
    night.stages["open-loop"] = CellStage("open-loop", True, "next", "", "", words=("run", "open-loop"))
    said = complaint(night, f'reuse = "{reuse}"\n[[stage]]\nname = "open-loop"\n')
    assert ("counts only after reflector-search of the same job" in said) == refused
    assert bool(said) == refused
