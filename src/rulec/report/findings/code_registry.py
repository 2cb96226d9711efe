"""All diagnostic codes, from the modules that define them, explained as text and Markdown."""

from __future__ import annotations

import ast
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from textwrap import indent

from rulec.diagnostics.code import Code, ExampleKind
from rulec.report.text.terminal_text import broken

STAGES = (
    "Syntax",
    "Names",
    "Types and meaning",
    "Compiling and examples",
    "Traces",
    "Scenarios and graphs",
    "Files",
    "Analysis",
)
"""The stages that report codes, by the hundreds digit of the codes, from 1 on."""

_PACKAGE = Path(__file__).parents[2]


@cache
def all_codes() -> dict[str, Code]:
    """Every code by its text, in ascending order."""
    codes = [code for path in message_files() for code in _defined_in(path)]
    return {code.code: code for code in sorted(codes, key=lambda code: code.code)}


def code_named(text: str) -> Code | None:
    """The code with a text such as ``R0104``; None if there is none."""
    for path in message_files():
        if f'"{text}"' in path.read_text(encoding="utf-8"):
            return next((code for code in _defined_in(path) if code.code == text), None)
    return None


def codes_of_stage(stage: str) -> list[Code]:
    """The codes of a stage, in ascending order."""
    prefix = f"R0{STAGES.index(stage) + 1}"
    return [code for text, code in all_codes().items() if text.startswith(prefix)]


def message_files() -> Iterator[Path]:
    """The modules that define codes: ``..._messages.py``, and those in folders ``messages``."""
    for folder, folders, files in os.walk(_PACKAGE):
        folders.sort()
        ending = ".py" if folder.endswith(f"{os.sep}messages") else "_messages.py"
        yield from (Path(folder, name) for name in sorted(files) if name.endswith(ending))


def _defined_in(path: Path) -> list[Code]:
    """The codes defined in a module, without importing it.

    Codes are defined before anything that uses them, and only from texts. Importing the modules
    would load parser, compiler and scenarios: `rulec explain --all` took three times as long.
    """
    text = path.read_text(encoding="utf-8")
    last = text.rfind(" = Code(\n")
    if last < 0:
        return []
    beginning = ast.parse(text[: text.index("\n)\n", last) + 3])
    assignments = [node for node in beginning.body if isinstance(node, ast.Assign)]
    names: dict[str, object] = {"Code": Code}
    exec(compile(ast.Module([*assignments], []), str(path), "exec"), names)
    return [value for value in names.values() if isinstance(value, Code)]


_KINDS: dict[ExampleKind, tuple[str, str]] = {
    "rules": ("to check", "rulec"),
    "compiled": ("to compile", "rulec"),
    "analyzed": ("to analyze", "rulec"),
    "examples": ("to test", "rulec"),
    "maneuvers": ("to judge the maneuvers of `s1` by", "rulec"),
    "trace": ("a trace, to judge by `esterle2019`", "json"),
    "scenario": ("a scenario, to build the graph of", "toml"),
    "command": ("in a shell", "sh"),
    "python": ("from Python", "python"),
}
"""What is done with an example, and its language."""


def as_text(code: Code, width: int = 80) -> str:
    """An explanation for a terminal; its examples keep their lines, however wide."""
    parts = ["\n".join(broken(text, width)) for text in (f"{code.code}: {code.title}", code.why)]
    for head, example in _examples(code):
        parts.append(f"{head}:\n\n{indent(example, '    ')}")
    return "\n\n".join(parts)


def as_plain_text(code: Code) -> str:
    """The explanation without its title, for a format that has that elsewhere."""
    return as_text(code).partition("\n\n")[2]


def as_markdown(code: Code) -> str:
    """The explanation without its title, in Markdown."""
    parts = ["\n".join(broken(code.why, 100, at_hyphens=False))]
    for head, example in _examples(code):
        # The word after the language marks samples of mistakes, so that they are not read as
        # correct ones.
        parts.append(
            f"{head}:\n\n```{_KINDS[code.kind][1]} {head.split()[0].lower()}\n{example}\n```"
        )
    return "\n\n".join(parts)


def as_sections() -> str:
    """All explanations in Markdown, a section a stage."""
    parts = []
    for number, stage in enumerate(STAGES, 1):
        parts.append(f"## R0{number}: {stage.lower()}\n")
        parts += [
            f"### {code.code}: {code.title}\n\n{as_markdown(code)}\n"
            for code in codes_of_stage(stage)
        ]
    return "\n".join(parts).rstrip("\n")


def _examples(code: Code) -> Iterator[tuple[str, str]]:
    if code.kind != "circumstance":
        yield f"Wrong ({_KINDS[code.kind][0]})", code.bad.rstrip("\n")
        yield "Corrected", code.good.rstrip("\n")
