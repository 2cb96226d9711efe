"""All diagnostic codes of the package, from the modules that define them."""

from __future__ import annotations

import ast
import os
from collections.abc import Iterator
from functools import cache
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
    """The code with a text such as ``R0104``, or None."""
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
    for folder, folders, files in os.walk(_PACKAGE):
        folders.sort()
        ending = ".py" if folder.endswith(f"{os.sep}messages") else "_messages.py"
        yield from (Path(folder, name) for name in sorted(files) if name.endswith(ending))


def _defined_in(path: Path) -> list[Code]:
    """The codes of a module, without importing it.

    They stand before all that speaks of them, and are made of texts alone. Importing the modules
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
