"""Settings of our drivers with short time-outs, so that the checks that wait for them are quick."""

from pathlib import Path
from typing import Any

from catseye.app.testing.candidate import Candidate
from catseye.drivers import counter

TIMEOUT_S = 0.25
_OF_SLOW_STREAMS_S = {"lasertex-hpi": 0.5}
"""Twelve of its values: a busy machine loses no more time than that."""


def short_timeouts(candidate: Candidate, folder: Path) -> dict[str, Any]:
    """Return settings; the line counter has its time-out in the profile, of which a copy is written."""
    if candidate.name == "line-counter":
        default = Path(counter.__file__).parent / "profiles" / "default.toml"
        text = default.read_text(encoding="utf-8")
        assert "timeout_s = 1.0" in text
        profile = folder / "quick.toml"
        profile.write_text(text.replace("timeout_s = 1.0", f"timeout_s = {TIMEOUT_S}"), encoding="utf-8")
        return {"profile": str(profile)}
    fields = candidate.driver.Settings.model_fields
    timeout_s = _OF_SLOW_STREAMS_S.get(candidate.name, TIMEOUT_S)
    # Some are short already and take no longer one.
    return {
        name: min(timeout_s, fields[name].default)
        for name in ("answer_timeout_s", "timeout_s")
        if name in fields
    }
