"""``rulec compile``: compile a rulebook into automata files."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Literal

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, refuse_overwriting, refuse_standard_output
from rulec.cli.options.verb_class import option, verb
from rulec.cli.output import errors_told, open_session, rulebooks_named, told_apart
from rulec.diagnostics import SourceLocation, named
from rulec.diagnostics.fault_messages import contained
from rulec.files.written_files import refuse_unwritable
from rulec.logic.printing import number_in_words
from rulec.report.text.console import print_line, print_remark

_HEAD_CHARACTERS = 4000
_SOURCE = re.compile(
    r"/\* sha256 [0-9a-f]+ (.+?) \*/"
    r"|\bsource: (.+), SHA-256 "
    r'|"sources": \[\s*\{\s*"name": "(.+)"'
)
"""The first source that a written file names, which is the rulebook's own: of an automaton, of a
monitor in C or Rust, or of a compiled rulebook and the propositions of formulas."""

_WRITTEN = (".hoa", ".json")
_NAMING_SOURCES = (*_WRITTEN, ".c", ".rs")
_FILES = (*_WRITTEN, ".c", ".h", ".hpp", ".rs", ".csv", ".props", ".smv")


def _bounds(_: click.Context, __: click.Parameter, values: Sequence[str]) -> dict[str, int]:
    bounds: dict[str, int] = {}
    for value in values:
        kind, number = value.partition("=")[::2]
        if not kind or not number.isdecimal() or len(number) > 9:
            raise click.BadParameter(f"`{value}` is not TYPE=N, such as `vehicle=16`")
        if kind in bounds:
            raise click.BadParameter(f"`{kind}` has two bounds: give it one")
        bounds[kind] = int(number)
    return bounds


@verb
def command(
    *,
    rulebooks: tuple[str, ...] = shared.rulebooks_argument(),
    step_s: Fraction | None = shared.step_option(
        "The time step of the automata, in s: a decimal, or a fraction such as 1/3. It matters "
        "only for rules with bounds in seconds; the compiled rulebook judges traces of any step.  "
        "[default: the step of their examples]",
    ),
    output: str = option(
        "-o",
        "--output",
        required=True,
        metavar="DIR",
        help="The folder to write to; it is created if necessary.",
    ),
    emit: Literal["automata", "c", "rust", "ros2", "ltl"] = shared.choice_option(
        "--emit",
        ["automata", "c", "rust", "ros2", "ltl"],
        "What to write: automata and the compiled rulebook; a monitor in C, in Rust or for ROS 2; "
        "or formulas in linear temporal logic for other tools.",
    ),
    objects: Mapping[str, int] = option(
        "--objects",
        metavar="TYPE=N",
        multiple=True,
        callback=_bounds,
        help="The most objects of a type that a monitor watches at once; may be given several "
        "times.  [default: 16 of each top-level type]",
    ),
    prove: bool = option(
        "--prove",
        is_flag=True,
        help="Also compile the monitor with a C compiler, check it against its tables and "
        "write a report.",
    ),
    no_certificate: bool = option(
        "--no-certificate",
        is_flag=True,
        help="Skip the second, independent compilation that certifies the first; it takes about as "
        "long.",
    ),
    clocks: bool = option(
        "--clocks",
        is_flag=True,
        help="Write automata for any step: a bound in seconds is a clock, which their header "
        "defines. A tool has to know it.",
    ),
    at: str = shared.at_option,
) -> int:
    """Compile each RULEBOOK: a name, or the path of a source.

    Writes RULE.hoa for every rule, in the Hanoi Omega-Automata format, and the compiled rulebook
    RULEBOOK.json, from which the commands that judge, monitor and show work as from the source, and
    without Spot. Instead, `--emit c` writes a monitor in C99 with its Makefile and CMakeLists.txt,
    `--emit rust` a crate and `--emit ros2` a package around it, and `--emit ltl` all
    formulas for Spot, PRISM and nuXmv with the meaning of their propositions. Every file is written
    completely or not at all. If there are several rulebooks, each gets its own folder in DIR.
    """
    if (objects or prove) and emit in ("automata", "ltl"):
        name = "--objects" if objects else "--prove"
        raise click.UsageError(f"{name} is about monitors in C and Rust: add `--emit c`")
    if no_certificate and emit != "automata":
        raise click.UsageError(
            "--no-certificate is about the compiled rulebook: leave out `--emit`, or this option"
        )
    if clocks and emit != "automata":
        raise click.UsageError("--clocks is about automata: leave out `--emit`, or this option")
    if not output:
        raise click.UsageError("--output names no folder. For this one, write `-o .`")
    refuse_standard_output(output)
    _refuse_file(output)
    # Checked first, since compiling may take minutes.
    refuse_unwritable(Path(output), is_folder=True)
    session = open_session(at)
    books = rulebooks_named(rulebooks)
    # Several rulebooks may have rules of the same name.
    folders = {book: Path(output, name) for name, book in told_apart(books).items()}
    if books == rulebooks and len(books) == 1:
        folders = dict.fromkeys(books, Path(output))
    if emit == "automata":
        # Output files are named after rulebooks and rules, which are not known yet.
        files = [Path(folder, Path(book).name) for book, folder in folders.items()]
        compiled_files = [Output(str(file), "") for file in files if file.suffix in _WRITTEN]
        refuse_overwriting(compiled_files, books)
    written = 0
    for book, folder in folders.items():
        before = _sources_of_files(folder)
        with errors_told():
            if emit == "ltl":
                paths = session.write_ltl(book, folder, step_s)
            elif emit == "automata":
                compiled = session.compile_rulebook(book, step_s=step_s)
                several = len({rule.step_s for rule in compiled.rules} - {None}) > 1
                compiled = compiled.at_one_step()
                paths = session.write_compiled(
                    compiled, folder, certificate=not no_certificate, clocks=clocks
                )
                if several:
                    _tell_step(compiled)
                if clocks:
                    _tell_without_clocks(folder, compiled)
                _tell_others(folder, paths)
            else:
                compiled = session.compile_rulebook(book, step_s=step_s)
                with contained("no answer", SourceLocation(book)):
                    paths = session.write_monitor(
                        compiled, folder, objects, prove=prove, language=emit
                    )
                if step_s is None:
                    _tell_step(compiled)
            _tell_replaced(folder, before)
            for path in paths:
                print_line(f"wrote {path}")
                if prove and path.name.endswith("_proof.txt"):
                    print_line(_proved(path.read_text(encoding="utf-8")))
            written += 1
    return ExitStatus.after(answered=written == len(folders), failed=False)


def _proved(report: str) -> str:
    """How much of a monitor was compared, by its report, which is written only if all is equal."""
    numbers = [line.split()[0] for line in report.splitlines() if line.endswith(": 0 differ")]
    return f"proved: {sum(map(int, numbers)):,} comparisons, 0 differ"


def _refuse_file(output: str) -> None:
    """Refuse the name of one of the files to be written, where it would become their folder."""
    path = Path(output)
    if path.suffix in _FILES and not path.is_dir():
        raise click.UsageError(
            f"--output names a folder, for several files, and `{output}` reads like one of these: "
            f"write `-o {path.with_suffix('')}`"
        )


def _tell_others(folder: Path, written: Sequence[Path]) -> None:
    """Warn about other automata in the folder, which a reader could not distinguish from these."""
    others = sorted({path.name for path in folder.glob("*.hoa")} - {path.name for path in written})
    if others:
        print_remark(
            f"in {folder} stay automata of another rulebook or from before: {named(others)}"
        )


def _tell_without_clocks(folder: Path, compiled: lazy.CompiledRulebook) -> None:
    """Name the rules whose automata are for one step all the same."""
    names = [
        rule.name
        for rule in compiled.rules
        if rule.step_s is not None
        and "\nRulec-Clock: " not in (folder / f"{rule.name}.hoa").read_text(encoding="utf-8")
    ]
    if names:
        why = "a bound begins anywhere, or there is no Spot"
        print_remark(f"without clocks: {named(names)} ({why})")


def _sources_of_files(folder: Path) -> dict[str, str]:
    """For each written file in a folder, the source of its rulebook, as its head says."""
    found = {}
    for path in (*folder.glob("*.*"), *folder.glob("src/*.*")):
        if path.suffix not in _NAMING_SOURCES or not path.is_file():
            continue
        # What cannot be read is told when it is written.
        with suppress(OSError):
            with path.open(encoding="utf-8", errors="replace") as file:
                source = _SOURCE.search(file.read(_HEAD_CHARACTERS))
            if source or path.suffix == ".hoa":
                name = path.relative_to(folder).as_posix()
                found[name] = source[source.lastindex or 0] if source else ""
    return found


def _tell_replaced(folder: Path, before: Mapping[str, str]) -> None:
    """Warn about files of other rulebooks that were replaced: rules or rulebooks have one name."""
    now = _sources_of_files(folder)
    replaced = sorted(name for name, source in before.items() if now.get(name, source) != source)
    if replaced:
        sources = named(sorted({before[name] for name in replaced} - {""}))
        kind = "automata" if all(name.endswith(".hoa") for name in replaced) else "files"
        print_remark(
            f"in {folder} {kind} of another rulebook{f' ({sources})' if sources else ''} were "
            f"replaced: {named(replaced)}; give each rulebook a folder of its own"
        )


def _tell_step(compiled: lazy.CompiledRulebook) -> None:
    """Name the step of a monitor if a rule depends on it and the user did not give it."""
    steps = [rule.step_s for rule in compiled.at_one_step().rules if rule.step_s is not None]
    if steps:
        rules = "1 rule has" if len(steps) == 1 else f"{len(steps):,} rules have"
        step = number_in_words(steps[0])
        print_remark(f"for states {step} s apart, as {rules} bounds in seconds; `--step` says else")
