"""Reading campaign files, and those that come with the program."""

import hashlib
import json
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Final

from pydantic import ValidationError

from catseye.app.campaign.deadline import require_deadline
from catseye.app.campaign.model import Campaign, StageEntry, Value, value_text
from catseye.app.cell.faults import faults_in
from catseye.app.errors import ConfigError, StorageError
from catseye.app.files.documents import document_text, is_file, parse_toml, read_document

_DAYS: Final = files("catseye.app.campaign") / "days"


@dataclass(frozen=True)
class LoadedCampaign:
    """A campaign file that has passed every check.

    Attributes:
        campaign: its values.
        path: where it was read.
        sha256: of its bytes.
    """

    campaign: Campaign
    path: Path
    sha256: str

    def file(self, text: str) -> Path:
        """Return a file that the campaign names: beside it, unless the path is whole or there is none there."""
        beside = self.path.parent / text
        return beside if is_file(beside) else Path(text)

    def text(self, value: Value) -> str:
        """Return a value as the command line takes it; of a file beside the campaign, its path."""
        text = value_text(value)
        return str(self.file(text)) if isinstance(value, str) else text

    def fingerprint(self, entry: StageEntry) -> str:
        """Return a sum over what a stage is done with: where it is another one, what was done before does not count.

        Limits and retries are left out: they judge and repeat the same work.

        Raises:
            StorageError: a file that it names cannot be read.
        """
        given = (entry.params, entry.options, entry.files, entry.command)
        texts = (
            word for values in given for word in (values.values() if isinstance(values, dict) else values)
        )
        named = (self.file(word) for word in texts if isinstance(word, str))
        sums = [_sum(path) for path in named if is_file(path)]
        return hashlib.sha256(json.dumps([*given, sums], sort_keys=True).encode()).hexdigest()


def _sum(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise StorageError(f"{path}: cannot be read: {error.strerror}; check the rights") from error


def shipped() -> dict[str, Path]:
    """Return the campaigns that come with the program, by their names."""
    found = (Path(str(entry)) for entry in _DAYS.iterdir() if entry.name.endswith(".toml"))
    return {path.stem: path for path in sorted(found)}


def load_campaign(file: Path) -> LoadedCampaign:
    """Read and check a campaign file, or one that comes with the program by its name.

    Raises:
        ConfigError: the file is missing, is no TOML, or a key or value is wrong; the faults are listed.
    """
    path = shipped().get(str(file), file)
    names = ", ".join(shipped())
    raw = read_document(path, f"there is no such campaign file; with the program come: {names}")
    text = document_text(raw, path)
    try:
        campaign = Campaign.model_validate(parse_toml(text, path))
    except ValidationError as error:
        faults = faults_in(Campaign, path, text, error)
        raise ConfigError(f"the campaign file cannot be used:\n{faults}") from error
    require_deadline(campaign.deadline, f"{path}: deadline")
    return LoadedCampaign(campaign, path, hashlib.sha256(raw).hexdigest())
