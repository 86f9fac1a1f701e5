"""What procedures declare: it is light, fits together, and refers to nothing that does not exist."""

import subprocess
import sys

from catseye.app.cli.commands import COMMANDS
from catseye.app.protocol.installed import procedure_names
from catseye.app.protocol.procedures import on_the_way, procedures
from catseye.procedures.kit.records import tables_of


def test_listing_procedures_imports_no_scipy() -> None:
    code = """
import sys
from catseye.app.protocol.procedures import procedures
procedures()
print('scipy' in sys.modules)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_the_way_has_an_order() -> None:
    orders = [each.stage.order for each in on_the_way() if each.stage]
    orders += [one.stage.order for one in {one for each in procedures() for one in each.analyses}]
    assert len(set(orders)) == len(orders) > 0


def test_declarations_name_procedures_that_exist() -> None:
    named: set[str] = set()
    for each in procedures():
        named |= {after.procedure for after in each.needs.after}
        if (basis := each.needs.basis) is not None:
            named |= {basis.procedure, *basis.overtaken_by}
        if (stage := each.stage) is not None:
            named |= {stage.since, stage.renewed_by, stage.covered_by}
    assert named - {""} <= set(procedure_names())


def test_analyses_are_commands() -> None:
    assert {one.command for each in procedures() for one in each.analyses} <= set(COMMANDS)


def test_every_procedure_declares_what_it_records() -> None:
    declared = {each.name: [table.name for table in tables_of(each.records)] for each in procedures()}
    assert all(declared.values())
    assert (
        declared.items()
        >= {
            "beam-level": ["records"],
            "beam-to-j4": ["records"],
            "open-loop": ["points", "records"],
            "reflector-search": ["search"],
            "repeatability": ["records"],
            "validation-path": ["path", "records"],
            "warmup": ["records"],
        }.items()
    )
