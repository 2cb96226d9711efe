"""``rulec draw``: scenes, graphs and traces as pictures."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from rulec.cli.arguments import (
    RULEBOOK_HELP,
    at_option,
    chosen,
    complete_rulebooks,
    graph_options,
    output_option,
    rulebook_option,
)

if TYPE_CHECKING:
    from rulec.automata.compiled import CompiledRulebook
    from rulec.maneuvers import Maneuvers
    from rulec.partition import NavigationGraph
    from rulec.report.pictures.files import Drawing
    from rulec.runtime.cheapest import Maneuver
    from rulec.trace import Trace

    Judged = tuple[NavigationGraph, Maneuvers | None, Maneuver | None]

Decorated = TypeVar("Decorated", bound=Callable[..., Any])


def _output_options(function: Decorated) -> Decorated:
    for decorate in (
        click.option(
            "--format",
            "form",
            type=click.Choice(["svg", "png", "html"]),
            help="The format of the picture.  [default: what the file's name ends with, else svg]",
        ),
        output_option,
    ):
        function = decorate(function)
    return function


def _judging_options(function: Decorated) -> Decorated:
    for decorate in (
        at_option,
        click.option(
            "--maneuver",
            "number",
            type=click.IntRange(min=1),
            metavar="N",
            help="Show the N-th cheapest satisfying maneuver.  [default: 1 if there is a rulebook]",
        ),
        click.option(
            "-r",
            "--rulebook",
            metavar="R",
            help=RULEBOOK_HELP + " Left out, nothing is judged.",
            shell_complete=complete_rulebooks,
        ),
    ):
        function = decorate(function)
    return function


@click.group()
def command() -> None:
    """Draw the scene over time, the navigation graph, or a trace: as SVG, PNG or a page (HTML).

    SVG and HTML need nothing else and come in light and dark, as the reader prefers; PNG takes
    `pip install 'rulec[pictures]'`.
    """


@command.command()
@graph_options
@_judging_options
@click.option(
    "--layer",
    "layers",
    multiple=True,
    type=click.IntRange(min=0),
    metavar="P",
    help="Draw layer P alone, counted from 0; may be repeated.  [default: all]",
)
@_output_options
def scene(layers: tuple[int, ...], output: Path, form: str | None, **options: Any) -> None:
    """Draw SCENARIO (a name or a file) over time: cells with signatures, obstacles, a maneuver.

    With a rulebook the cheapest maneuver that satisfies it is shown by its cells, whose bounds are
    its envelope. A page (HTML) has a slider for the time.
    """
    from rulec.report.pictures.files import Drawing
    from rulec.report.pictures.scene import scene_legend, scene_pictures
    from rulec.report.pictures.titles import scene_title

    graph, found, maneuver = _judged(**options)
    last = len(graph.layers) - 1
    if layers and max(layers) > last:
        raise click.UsageError(f"There is no layer {max(layers)}; they are 0 to {last}.")
    chosen = sorted(set(layers)) or range(last + 1)
    title = scene_title(graph, found, maneuver, options["number"] or 1)
    pictures = scene_pictures(graph, chosen, maneuver)
    _write(Drawing(title, pictures, scene_legend(graph, maneuver)), output, form)


@command.command()
@graph_options
@_judging_options
@_output_options
def graph(output: Path, form: str | None, **options: Any) -> None:
    """Draw the navigation graph of SCENARIO (a name or a file), layer by layer.

    With a rulebook the steps of satisfying maneuvers are told from those of rejected ones, and the
    cheapest satisfying maneuver is shown.
    """
    from rulec.report.pictures.files import Drawing
    from rulec.report.pictures.graph import graph_picture
    from rulec.report.pictures.titles import graph_title
    from rulec.runtime.effects import effects
    from rulec.runtime.passages import passages
    from rulec.runtime.product import explore

    cells, found, maneuver = _judged(**options)
    hard = found.hard if found else effects(cells.trace_graph(), ())
    product = found.product if found else explore(hard)
    ways = passages(hard, product)
    picture = graph_picture(cells, ways, maneuver, judged=found is not None)
    title = graph_title(cells, found, product.accepted)
    _write(Drawing(title, [picture]), output, form)


@command.command()
@click.argument("file")
@rulebook_option
@click.option(
    "--trace", "wanted", metavar="ID", help="Draw the trace with this id.  [default: the first]"
)
@click.option(
    "--rule",
    "patterns",
    multiple=True,
    metavar="PATTERN",
    help="Only what rules like PATTERN read; `*` and `?` are wild. May be given several times.",
)
@click.option(
    "--object",
    "objects",
    multiple=True,
    metavar="ID",
    help="Of the objects only this one. May be given several times.",
)
@at_option
@_output_options
def trace(
    file: str,
    rulebook: str,
    wanted: str | None,
    patterns: tuple[str, ...],
    objects: tuple[str, ...],
    at: str,
    output: Path,
    form: str | None,
) -> None:
    """Draw a trace of FILE (JSON Lines, CSV or Parquet): what a rulebook reads in it, over time.

    Violations are marked where they are decided, with the rule and its article.
    """
    from rulec.diagnostics import named
    from rulec.report.console import print_diagnostics
    from rulec.report.pictures.files import Drawing
    from rulec.report.pictures.ribbon import ribbon
    from rulec.report.pictures.ribbon_picture import ribbon_picture
    from rulec.report.pictures.titles import trace_title
    from rulec.runtime.verify import made_for, verify
    from rulec.settings import search_path
    from rulec.workflow import machines

    rules = machines(rulebook, search_path(), print_diagnostics, at)
    chosen = _trace(file, wanted)
    for item in objects:
        if item not in chosen.objects:
            raise click.UsageError(
                f"trace `{chosen.id}` has no object `{item}`; it has {named(list(chosen.objects))}."
            )
    used = _only(made_for(chosen, rules), patterns)
    verdict = verify(chosen, used)
    shown = ribbon(chosen, used, verdict, objects)
    title = trace_title(replace(verdict, violations=shown.violations), used, (*patterns, *objects))
    _write(Drawing(title, [ribbon_picture(shown, used)]), output, form)


def _only(rules: CompiledRulebook, patterns: tuple[str, ...]) -> CompiledRulebook:
    """The rulebook with the rules alone that one of the patterns matches, if there are any."""
    from fnmatch import fnmatchcase

    kept = tuple(
        rule
        for rule in rules.rules
        if not patterns or any(fnmatchcase(rule.name, pattern) for pattern in patterns)
    )
    if not kept:
        raise click.UsageError(
            f"{rules.name} has no rule like {' or '.join(f'`{one}`' for one in patterns)}."
        )
    return replace(rules, rules=kept)


def _judged(
    scenario: str, rulebook: str | None, number: int | None, at: str, **options: Any
) -> Judged:
    """The graph, with a rulebook its maneuvers, and the one that is to be shown."""
    from itertools import islice

    from rulec.report.console import print_diagnostics
    from rulec.report.counts import shown_count
    from rulec.runtime.cheapest import cheapest
    from rulec.scenario import load_scenario
    from rulec.settings import search_path
    from rulec.workflow import find_maneuvers, machines, navigation_graph

    if rulebook is None:
        if number is not None:
            raise click.UsageError("`--maneuver` takes a rulebook: give one with `-r R`.")
        scene = load_scenario(scenario, chosen(options))
        options["partition"] = options["partition"] or "paper"
        return navigation_graph(scene, **options), None, None
    rules = machines(rulebook, search_path(), print_diagnostics, at)
    scene = load_scenario(scenario, chosen(options))
    found = find_maneuvers(scene, rules, **options)
    wanted = number or 1
    maneuver = None
    if wanted <= min(found.satisfying, sys.maxsize):
        maneuver = next(islice(cheapest(found.product), wanted - 1, None))
    if maneuver is None and number is not None:
        raise click.UsageError(
            f"There is no maneuver {number}: {shown_count(found.satisfying)} satisfy the rulebook."
        )
    return found.graph, found, maneuver


def _trace(file: str, wanted: str | None) -> Trace:
    """The trace that is asked for. Raises RulecError if it, or one before it, cannot be read."""
    from rulec.diagnostics import RulecError
    from rulec.workflow import read_traces

    names: list[str] = []
    for one in read_traces(file):
        if isinstance(one, RulecError):
            raise one
        if wanted in (None, one.id):
            return one
        names.append(one.id)
    some = ", ".join(f"`{name}`" for name in names[:5]) + (", …" if len(names) > 5 else "")
    raise click.UsageError(f"`{file}` has no trace `{wanted}`; it has {some}.")


def _write(drawing: Drawing, output: Path, form: str | None) -> None:
    from rulec.files import written_whole
    from rulec.report.console import print_result
    from rulec.report.pictures.files import as_bytes, format_of

    data = as_bytes(drawing, form or format_of(str(output)), str(output))
    if str(output) == "-":
        sys.stdout.buffer.write(data)
        return
    with written_whole(output) as stream:
        stream.write(data)
    print_result(f"wrote {output}")
