"""Values that stored runs, answers files and rehearsals rely on, pinned for the cell of the template."""

import hashlib
import json
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.resolution.template import BY_ARM
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.engine.walked.register import geometry_digest
from catseye.app.protocol.procedures import load_procedure
from catseye.app.service.plan_digest import plan_digest
from catseye.app.service.running import plan_run, rehearse
from tests.declared_questions import undeclared


class Golden(NamedTuple):
    """What a procedure with its defaults gives; digests are the first digits of a SHA-256."""

    plan: str
    rehearsal: str
    total_s: float


GOLDEN = {
    "beam-level": Golden("b34c68fcd06633bf", "a6733266570b5b5f", 2.913),
    "beam-to-j4": Golden("56f226d65b68a819", "25e583da856fa109", 42.399),
    "open-loop": Golden("82d82b9ecce15b98", "62822ecd51eb12e5", 1489.834),
    "radial-error-motion": Golden("6a6c7f7cb2cc7554", "9b8a6cd66345dff2", 494.855),
    "reflector-search": Golden("956c7c353097831f", "6ba4c9f42baefb68", 42.82),
    "repeatability": Golden("2bd74117f992327a", "869bc51461a52682", 1342.062),
    "validation-path": Golden("ae29e73a8cbf355a", "18b8ab050fe23bc8", 114.38),
    "warmup": Golden("52a1f0addf793ccd", "b5dc20a7cf12bfd8", 1928.261),
}


RESOLUTION = {
    "backlash": Golden("a961721d9a51b22e", "5487475c89c0ebac", 21573.365),
    "resolution": Golden("8be41a4dbf7087f4", "aa50479a0ab3e4ef", 38760.363),
    "resolution-cartesian": Golden("ced7ebc46b78f24f", "9c20dd9d38b75957", 4377.747),
    "resolution-iso": Golden("f8679b440b475871", "382284f610c84e0c", 46524.389),
}
"""Of the KUKA's template; all joints and places, the tool at one pose."""

_CHOSEN: dict[str, dict[str, Any]] = {
    "resolution-cartesian": {"poses_deg": [[0.0, -80.0, 80.0, 0.0, 30.0, 0.0]]}
}


@pytest.fixture
def cell_file(tmp_path: Path) -> Path:
    path = tmp_path / "cell.toml"
    path.write_text(TEMPLATE, "utf-8")
    return path


@pytest.fixture
def resolution_cell(tmp_path: Path) -> Path:
    path = tmp_path / "resolution.toml"
    path.write_text(BY_ARM["kr210-r2700"], "utf-8")
    return path


async def found_of(cell: Path, name: str) -> Golden:
    procedure = load_procedure(name)
    params = procedure.params_type.model_validate(_CHOSEN.get(name, {}))
    planned = plan_run(load_cell(cell), procedure, params, cell.parent / "runs", "auto")
    dry = await rehearse(planned)
    assert undeclared(dry.prompts, procedure) == []
    return Golden(plan_digest(planned.plan)[:16], rehearsed(dry), round(dry.total_s, 3))


def digest(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:16]


def rehearsed(dry: DryRunContext) -> str:
    steps = [
        [
            step.step_id,
            step.moves,
            step.measurements,
            round(step.duration_s, 4),
            *(round(value, 4) + 0.0 for value in step.end),
            *(round(value, 4) for value in (step.speeds.joint_deg_s, step.speeds.tool_mm_s)),
            *(None if value is None else round(value, 6) + 0.0 for value in (step.beam_mm, step.miss_mm)),
        ]
        for step in dry.steps
    ]
    return digest([steps, [prompt.id for prompt in dry.prompts]])


def test_the_values_of_a_cell_file_stay(cell_file: Path) -> None:
    assert digest(load_cell(cell_file).cell.model_dump(mode="json")) == "ecbfee205c29a6d9"


def test_stored_walks_still_fit_their_cell(cell_file: Path) -> None:
    assert geometry_digest(load_cell(cell_file).cell)[:16] == "07db9f3374434d23"


@pytest.mark.parametrize("name", list(GOLDEN))
async def test_default_plans_and_rehearsals_stay(cell_file: Path, name: str) -> None:
    assert await found_of(cell_file, name) == GOLDEN[name]


@pytest.mark.parametrize("name", list(RESOLUTION))
async def test_plans_of_motion_resolution_stay(resolution_cell: Path, name: str) -> None:
    assert await found_of(resolution_cell, name) == RESOLUTION[name]
