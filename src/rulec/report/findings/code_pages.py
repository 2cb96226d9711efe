"""Explanations of codes as text and Markdown, and the page docs/codes.md."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import fill, indent

from rulec.diagnostics.code import Code, ExampleKind
from rulec.report.findings.code_registry import STAGES, codes_of_stage

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
"""What an example is for, and its language."""

_HEAD = """\
# Codes

Every message of rulec has a code. `rulec explain CODE` shows in the terminal what is said here:
what the code means, a small example that gets it, and the same example, mended. All of them are run
by the tests. `rulec explain --all --output-format markdown` writes this page.
"""


def as_text(code: Code) -> str:
    """An explanation for a terminal."""
    parts = [f"{code.code}: {code.title}", fill(code.why, 80)]
    for head, example in _examples(code):
        parts.append(f"{head}:\n\n{indent(example, '    ')}")
    return "\n\n".join(parts)


def as_plain_text(code: Code) -> str:
    """The explanation without its title, for a format that has that elsewhere."""
    return as_text(code).partition("\n\n")[2]


def as_markdown(code: Code) -> str:
    """The explanation without its title, in Markdown."""
    parts = [fill(code.why, 100, break_on_hyphens=False)]
    for head, example in _examples(code):
        # What follows the language's name keeps the samples of mistakes from being taken for good.
        parts.append(
            f"{head}:\n\n```{_KINDS[code.kind][1]} {head.split()[0].lower()}\n{example}\n```"
        )
    return "\n\n".join(parts)


def as_page() -> str:
    """docs/codes.md."""
    parts = [_HEAD]
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
        yield "Mended", code.good.rstrip("\n")
