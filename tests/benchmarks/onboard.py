"""Monitors in C: nanoseconds a rule, a choice of objects and a step, every value new in each step.

Beside a walk over an explicit automaton with edges labelled by texts, which is how the rule monitor
of BARK goes (J. Bernhard, K. Esterle, P. Hart, T. Kessler, "BARK: Open behavior benchmarking in
multi-agent environments", IROS 2020): written for this comparison, not BARK itself. Callgrind
counts instructions.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

from figure import Figure, Result
from program import run
from timing import in_turns

import rulec
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.code_generation.input_fields import TYPE
from rulec.code_generation.monitor_layout import MonitorLayout, monitor_layout
from rulec.code_generation.written_names import prefix_of
from rulec.vocabulary import Declaration, Enumeration, Signal

HERE = Path(__file__).with_name("on_board")
VEHICLES = 16
STEPS = 20_000
STOPS = """\
rulebook watched
type car
signal stop(c: car)
signal standing(c: car)
hard rule stops (c: car) {
  require always (stop(c) implies eventually[<= 3 steps] standing(c))
}
"""


def measure(rounds: int) -> Iterator[Result]:
    """The whole of `de`, and one rule beside the walk."""
    with tempfile.TemporaryDirectory() as folder:
        yield whole("de", rounds, Path(folder))
        yield beside_walk(rounds, Path(folder))


def whole(name: str, rounds: int, folder: Path) -> Result:
    """All rules of a rulebook, with 16 cars."""
    layout = monitor_layout(rulec.compile_rulebook(name, step_s=1), {})
    program = driven(layout, "car", folder / name)
    n = pairs(layout, "car")
    taken = in_turns({name: timed(program, n)}, rounds)[name]
    figures = [taken.figure("a rule, a choice of cars, and a step", "ns", 10)]
    notes = []
    if shutil.which("valgrind"):
        notes.append(f"{instructions(program, folder) / n:.0f} instructions each (callgrind)")
    return Result(
        f"Monitor in C: {name}",
        f"{len(layout.rules)} rules and {VEHICLES} cars, {n} pairs of a rule and a choice of cars",
        figures,
        notes,
    )


def beside_walk(rounds: int, folder: Path) -> Result:
    """One rule of 16 cars, beside the walk over labelled edges."""
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(STOPS), step_s=1)
    ours = driven(monitor_layout(compiled, {}), "car", folder / "stops")
    (folder / "edges.h").write_text(edges(compiled))
    theirs = folder / "walk"
    command = ["c++", "-std=c++17", "-O2", "-I", str(folder), str(HERE / "walk.cpp")]
    subprocess.run([*command, "-o", str(theirs)], check=True)
    what = {"C": timed(ours, VEHICLES), "walk": timed(theirs, VEHICLES)}
    taken = in_turns(what, rounds)
    figures: list[Figure] = [
        taken["C"].against(taken["walk"], "labelled edges", "a car and a step", "ns")
    ]
    return Result("Monitor in C beside a walk over labelled edges", "one rule, 16 cars", figures)


def timed(program: Path, n: int) -> Callable[[], float]:
    """What a step takes by a program's own count, by ``n``."""

    def once() -> float:
        done = subprocess.run([program, str(STEPS)], check=True, capture_output=True, text=True)
        return float(done.stdout.split()[0]) / n

    return once


def pairs(layout: MonitorLayout, kind: str) -> int:
    """How many choices of 16 objects of a type all rules have."""
    vocabulary, n = layout.fields.vocabulary, 0
    for own in layout.rules:
        fits = [vocabulary.is_subtype(kind, variable.type) for variable in own.rule.variables]
        choices = 1
        for number, is_one in enumerate(fits):
            choices *= (VEHICLES - number) * is_one
        n += choices
    return n


def driven(layout: MonitorLayout, kind: str, folder: Path) -> Path:
    """A program that steps a monitor; it prints nanoseconds a step."""
    book, fields = layout.rulebook, layout.fields
    name = prefix_of(book.name)
    rulec.write_monitor(book, folder)
    calls = {
        "OBJECT": "object",
        "INPUT": "input",
        "STATE": "state",
        "VERDICT": "verdict",
        "INIT": "init",
        "STEP": "step",
        "UNKNOWN_OBJECT": "object_unknown",
    }
    lines = [f'#include "{name}.h"']
    lines += [f"#define {macro} {name}_{own}" for macro, own in calls.items()]
    lines.append(f"#define TYPE {name.upper()}_{fields.constants[TYPE, kind]}")
    for what, about in (("world", 0), ("object", 1)):
        lines.append(f"static void fill_{what}({name}_{'input' if about == 0 else what} *given)")
        drawn = [
            f"given->{fields.identifiers[one.name]} = {draw(one)};" for one in fields.about(about)
        ]
        lines.append("{ (void)given; " + " ".join(drawn) + " }")
    (folder / "fill.h").write_text("\n".join(lines) + "\n")
    program = folder / "drive"
    command = ["cc", "-O2", "-std=c99", "-D_POSIX_C_SOURCE=199309L", "-I", str(folder)]
    sources = [str(HERE / "drive.c"), str(folder / f"{name}.c")]
    subprocess.run([*command, *sources, "-o", str(program)], check=True)
    return program


def draw(item: Declaration) -> str:
    """A value drawn for a name, in C."""
    if isinstance(item, Signal):
        return "drawn() % 2u"
    if isinstance(item, Enumeration):
        return f"(uint8_t)(drawn() % {len(item.values)}u)"
    return "(double)(drawn() % 1200u) / 8.0"


def edges(compiled: CompiledRulebook) -> str:
    """The automaton of the only rule, in C++: every letter of a state is an edge."""
    machine = compiled.rules[0].machine
    names = [read.name for read in machine.reads]
    rows = []
    for targets, kept in zip(machine.successors, machine.outputs, strict=True):
        row = []
        for letter, digits in enumerate(product((0, 1), repeat=len(names))):
            by = machine.letters[letter]
            # The first read counts ones.
            labels = ", ".join(
                f'{{"{name}", {"true" if digit else "false"}}}'
                for name, digit in zip(names, reversed(digits), strict=True)
            )
            row.append(f"{{{{{labels}}}, {targets[by]}, {'true' if kept[by] else 'false'}}}")
        rows.append("{" + ", ".join(row) + "}")
    quoted = ", ".join(f'"{name}"' for name in names)
    return (
        f"static const std::vector<std::string> names{{{quoted}}};\n"
        f"static const std::vector<std::vector<Edge>> edges{{{', '.join(rows)}}};\n"
    )


def instructions(program: Path, folder: Path) -> float:
    """Instructions a step, by two runs of different length."""
    counted = []
    for steps in (100, 400):
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
        done = subprocess.run(
            [*command, str(program), str(steps)],
            cwd=folder,
            check=True,
            capture_output=True,
            text=True,
        )
        found = re.search(r"Collected : (\d+)", done.stderr)
        assert found is not None
        counted.append(int(found[1]))
    return (counted[1] - counted[0]) / 300


if __name__ == "__main__":
    run(measure, 5)
