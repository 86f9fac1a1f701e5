"""What is no file is written to, not replaced."""

import os
import stat
from pathlib import Path

from catseye.app.files.atomic import write_atomically


def test_a_pipe_takes_the_text_and_stays_one(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_atomically(pipe, "a result\n")
        assert os.read(reader, 100) == b"a result\n"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert os.listdir(tmp_path) == ["pipe"]
