"""The package's modules, parsed."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "src" / "rulec"


@dataclass(frozen=True)
class SourceModule:
    """A module: its path below the package, its lines, its tree."""

    name: str
    lines: tuple[str, ...]
    tree: ast.Module

    @property
    def stem(self) -> str:
        return Path(self.name).stem


@cache
def source_modules() -> tuple[SourceModule, ...]:
    """Every module of the package, by name."""
    texts = {
        str(path.relative_to(PACKAGE)): path.read_text(encoding="utf-8")
        for path in sorted(PACKAGE.rglob("*.py"))
    }
    return tuple(
        SourceModule(name, tuple(text.splitlines()), ast.parse(text))
        for name, text in texts.items()
    )


def rooms() -> Iterator[Path]:
    """Every folder of the package with modules in it."""
    return (path.parent for path in sorted(PACKAGE.rglob("__init__.py")))
