"""Modules whose imports are made at their first use, while type checkers see ordinary imports."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ast import stmt


def lazy_names(module: str) -> Callable[[str], Any]:
    """The ``__getattr__`` of a module whose imports stand under ``if TYPE_CHECKING:`` alone.

    Each name there is imported when it is asked for, and not stored: whatever replaces it in its
    own module is found here, too. The module's source is read for it, once. Raises AttributeError
    for other names.
    """

    def lazy_name(name: str) -> Any:
        home = homes(module).get(name)
        if home is None:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        source, own = home
        found = import_module(source)
        if not own:
            return found
        return getattr(found, own) if hasattr(found, own) else import_module(f"{source}.{own}")

    return lazy_name


@cache
def homes(module: str) -> Mapping[str, tuple[str, str]]:
    """Name -> its module and its name there, which is empty for the module itself."""
    import ast  # 3 ms, not for `rulec --version`

    def statements(name: str) -> list[stmt]:
        source: Any = import_module(name)
        tree: ast.Module = ast.parse(source.__loader__.get_data(source.__file__))
        return tree.body

    def imported(node: stmt) -> Iterator[tuple[str, tuple[str, str]]]:
        match node:
            case ast.ImportFrom(module=str(source), names=[ast.alias(name="*")]):
                for own in statements(source):
                    match own:
                        case ast.FunctionDef(name=name) | ast.Assign(targets=[ast.Name(id=name)]):
                            if not name.startswith("_"):
                                yield name, (source, name)
            case ast.ImportFrom(module=str(source), names=names):
                yield from ((one.asname or one.name, (source, one.name)) for one in names)
            case ast.Import(names=names):
                yield from ((one.name, (one.name, "")) for one in names)

    (block,) = [node for node in statements(module) if isinstance(node, ast.If)]
    return {name: home for node in block.body for name, home in imported(node)}
