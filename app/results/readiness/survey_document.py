"""Procedures, and what a cell is ready for, as `catseye procedures --json` writes them."""

import json
import shlex
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from typing import Any

from pydantic import BaseModel

from catseye.app.results.numbers import age_text
from catseye.app.results.readiness.cell_runs import CellRun
from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.stages import CellStage
from catseye.app.results.readiness.survey import Survey
from catseye.procedures.kit.procedure import Procedure


class LastRun(BaseModel):
    """The newest run of a procedure; see `CellRun`, whose age is a text here too."""

    name: str
    procedure: str
    status: str
    age_s: float
    resumable: bool
    void: str = ""
    id: str
    age: str


class ProcedureEntry(BaseModel):
    """A procedure.

    Attributes:
        name: as on the command line.
        title: one line for people.
        about: what it does, in a paragraph.
        sketch: its set-up, drawn with characters.
        example: a command that runs it.
        needs_aim: a search has to find the reflectors before.
        params: JSON schema of each parameter.
        needs: of the cell.
        last: its newest run on the cell.
    """

    name: str
    title: str
    needs_aim: bool
    about: str = ""
    sketch: str = ""
    example: str = ""
    params: dict[str, dict[str, Any]]
    needs: tuple[Need, ...] = ()
    last: LastRun | None = None


class StagesLine(BaseModel):
    """The stages of a cell on the way to a validated result.

    Attributes:
        cell: its name.
        stages: in their order.
    """

    cell: str
    stages: tuple[CellStage, ...]


class SurveyDocument(BaseModel):
    """All procedures on one cell.

    Attributes:
        cell: its name; empty where no cell file was given.
        procedures: that are installed.
        stages: on the way to a validated result.
    """

    cell: str = ""
    procedures: tuple[ProcedureEntry, ...] = ()
    stages: tuple[CellStage, ...] = ()

    @property
    def next(self) -> CellStage | None:
        """The next sensible stage."""
        return next((stage for stage in self.stages if stage.state == "next"), None)

    def procedure(self, name: str) -> ProcedureEntry | None:
        """Return a procedure by its name."""
        return next((entry for entry in self.procedures if entry.name == name), None)

    def lines(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield what the command writes, by names of documents: the procedures; of a cell its stages, last."""
        left_out = set() if self.cell else {"needs", "last"}
        for entry in self.procedures:
            yield "procedure", entry.model_dump(mode="json", exclude=left_out)
        if self.cell:
            yield "stages", StagesLine(cell=self.cell, stages=self.stages).model_dump(mode="json")

    @classmethod
    def of_lines(cls, text: str) -> "SurveyDocument":
        """Return what the command wrote."""
        entries: list[dict[str, Any]] = [json.loads(line) for line in text.splitlines() if line.strip()]
        cell = next((entry for entry in entries if "stages" in entry), {})
        return cls.model_validate(
            {**cell, "procedures": [entry for entry in entries if "stages" not in entry]}
        )


def survey_document(survey: Survey, *common: Need) -> SurveyDocument:
    """Return what is known about a cell.

    Args:
        common: needs of every procedure, beside its own.
    """
    entries = tuple(
        procedure_entry(procedure).model_copy(
            update={
                "needs": (*survey.needs[procedure.name], *common),
                "last": _last_run(survey.runs.last(procedure.name)),
            }
        )
        for procedure in survey.procedures
    )
    return SurveyDocument(cell=survey.cell, procedures=entries, stages=tuple(survey.stages))


def procedures_document(procedures: Iterable[Procedure]) -> SurveyDocument:
    """Return procedures without any cell."""
    return SurveyDocument(procedures=tuple(map(procedure_entry, procedures)))


def procedure_entry(procedure: Procedure) -> ProcedureEntry:
    """Return a procedure and the schema of its parameters."""
    return ProcedureEntry(
        name=procedure.name,
        title=procedure.title,
        about=procedure.explanation.text,
        sketch=procedure.explanation.sketch,
        example=_example(procedure),
        needs_aim=procedure.needs.basis is not None,
        params=procedure.params_type.model_json_schema()["properties"],
    )


def _example(procedure: Procedure) -> str:
    given = (part for text in procedure.explanation.example for part in ("--param", text))
    return shlex.join(("catseye", "run", procedure.name, "--cell", "cell.toml", *given))


def _last_run(run: CellRun | None) -> LastRun | None:
    return None if run is None else LastRun(**asdict(run), id=run.id, age=age_text(run.age_s))
