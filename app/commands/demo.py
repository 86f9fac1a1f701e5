"""demo: the whole job, told as it goes and summed up at the end."""

import asyncio
import sys
from pathlib import Path

from catseye.app.commands.narrator import Narrator
from catseye.app.commands.output import emit, emit_json, say
from catseye.app.demo import DemoInterruptedError, DemoResult, evaluate, measure, prepare_folder
from catseye.app.engine.announcer import Publish
from catseye.app.files.documents import read_truth
from catseye.app.render.text import statement_lines, tables_text
from catseye.app.results.scara.identify import MODELS
from catseye.app.results.scara.job_summary import job_summary
from catseye.app.store.reader import RunReader


def demo_command(out: Path, speed: float, seed: int, truth: Path | None, as_json: bool) -> None:
    """Measure, evaluate, report, sum up."""
    prepare_folder(out, seed, truth)
    say(f"emulators at {speed:g} times real speed, seed {seed}; everything is written to {out}")

    def narrator(name: str) -> Publish:
        return Narrator(name, as_json=False).publish

    try:
        runs = asyncio.run(measure(out, speed, seed, truth, narrator))
    except DemoInterruptedError as ended:
        say(f"catseye: {ended}")
        sys.exit(int(ended.outcome.exit_code))
    say("identifying both models and comparing them with truth and validation path")
    result = evaluate(out, runs)
    say("drawing the report")
    report = _write_report(result)
    if as_json:
        emit_json(_summary(result, report))
    else:
        summary = job_summary(result.truth, result.results["error-map"].fit, result.validation)
        emit(tables_text(summary))
        emit("")
        for line in statement_lines(summary):
            emit(line)
        emit(f"report           {report}")
        emit(f"run              {result.runs['open-loop']}")


def _write_report(result: DemoResult) -> Path:
    from catseye.app.render.page import write_page
    from catseye.app.results.scara.run_content import job_content, truth_tables
    from catseye.app.results.scara.run_report import run_report

    path = result.folder / "report.html"
    content = job_content(
        "catseye demo: error map of an emulated SCARA arm",
        [RunReader(run) for run in result.runs.values()],
        RunReader(result.runs["open-loop"]),
        [result.results[model] for model in MODELS],
        truth_tables(result.identified["error-map"], read_truth(result.folder / "truth.json")),
        result.validation,
    )
    write_page(run_report(content), path)
    return path


def _summary(result: DemoResult, report: Path) -> dict[str, object]:
    truth = result.truth
    models = {
        model.model: {
            "e_yy_rms_um": model.comparison.rms_um[1],
            "e_xy_rms_um": model.comparison.rms_um[0],
            "rms_2d_um": model.comparison.rms_2d_um,
            "max_um": model.comparison.max_um,
        }
        for model in result.validation.models
    }
    return {
        "runs": {name: str(path) for name, path in result.runs.items()},
        "run": str(result.runs["open-loop"]),
        "report": str(report),
        "truth": str(result.folder / "truth.json"),
        "results": {model: str(result.folder / f"result-{model}.json") for model in result.results},
        "identified": [
            {"name": n, "unit": unit, "truth": float(t), "identified": float(i), "u": float(u)}
            for n, unit, t, i, u in zip(
                truth.names, truth.units, truth.truth, truth.identified, truth.u, strict=True
            )
        ],
        "rms_normalised_error": truth.rms_normalised,
        "fit": result.results["error-map"].fit.model_dump(exclude_none=True),
        "validation": {
            "models": models,
            "ratio": result.validation.ratio,
            "compared": int(result.validation.compared.sum()),
            "left_out": int((~result.validation.compared).sum()),
        },
    }
