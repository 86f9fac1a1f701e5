"""A validation as a document, for who reads one."""

import subprocess
import sys

READ = """
import sys, catseye.app.results.scara.validation_document
print("catseye.app.results.scara.arm_report" in sys.modules)
"""


def test_reading_a_validation_loads_no_report() -> None:
    done = subprocess.run([sys.executable, "-c", READ], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
