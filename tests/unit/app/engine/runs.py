"""Whole runs on scripted instruments."""

from functools import partial

from catseye.app.engine.host import run_procedure
from catseye.app.engine.request import RunOutcome
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.records import Row
from tests.unit.app.engine.fakes import AWAY, HOME, FakeBench, Script, distance


async def run(bench: FakeBench, procedure: Script, **changes: object) -> RunOutcome:
    request = bench.request(procedure, **changes)
    return await run_procedure(request, bench.build, bench.clock, bench.publish, bench.install)


def measuring(*numbers: int) -> Script:
    """Return a procedure with a step for each number."""

    async def body(ctx: Context) -> None:
        for number in numbers:
            await ctx.step(f"p{number}", f"point {number}", partial(one, ctx, number))

    async def one(ctx: Context, number: int) -> Row:
        await ctx.move(AWAY if number % 2 else HOME)
        measured = await ctx.measure(0.5, 0.5, 3)
        ctx.record(distance(number, displacement_mm=measured.displacement_mm))
        return {"number": number}

    return Script(body)
