"""docs/emulators.md: its example runs as it stands."""

import re
import subprocess
import sys
from pathlib import Path

from tests.patience import HANG_S

PAGE = Path(__file__).parents[2] / "docs" / "emulators.md"


def test_the_example_of_the_page_passes(tmp_path: Path) -> None:
    (example,) = re.findall(
        r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )
    (tmp_path / "test_example.py").write_text(example, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:asyncio", "-W", "error"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=HANG_S,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 passed" in done.stdout
