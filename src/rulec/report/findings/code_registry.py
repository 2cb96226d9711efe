"""All diagnostic codes of the package, from the modules that define them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path

from rulec.diagnostics.code import Code

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
"""The stages that speak, by the hundreds of their codes, from 1 on."""

_PACKAGE = Path(__file__).parents[2]


@cache
def all_codes() -> dict[str, Code]:
    """Every code by its text, in ascending order."""
    codes = [code for path in message_files() for code in _defined_in(path)]
    return {code.code: code for code in sorted(codes, key=lambda code: code.code)}


def code_named(text: str) -> Code | None:
    """The code with this text, such as ``R0104``; None if there is none."""
    # Imports the one module that defines it: all of them take several times as long.
    for path in message_files():
        if f'"{text}"' in path.read_text(encoding="utf-8"):
            return next((code for code in _defined_in(path) if code.code == text), None)
    return None


def codes_of_stage(stage: str) -> list[Code]:
    """The codes of a stage, in ascending order."""
    prefix = f"R0{STAGES.index(stage) + 1}"
    return [code for text, code in all_codes().items() if text.startswith(prefix)]


def message_files() -> Iterator[Path]:
    """The modules that define codes: ``..._messages.py``, and those in a folder ``messages``."""
    yield from sorted(_PACKAGE.rglob("*_messages.py"))
    yield from sorted(_PACKAGE.rglob("messages/*.py"))


def _defined_in(path: Path) -> list[Code]:
    name = ".".join(("rulec", *path.relative_to(_PACKAGE).with_suffix("").parts))
    module = import_module(name)
    text = path.read_text(encoding="utf-8")
    # Codes that a module only imports belong to another one.
    return [
        value
        for value in vars(module).values()
        if isinstance(value, Code) and f'"{value.code}"' in text
    ]
