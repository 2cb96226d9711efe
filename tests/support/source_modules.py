"""What tests ask about the package's modules; each is parsed once in a run, and its tree let go."""

import ast
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from support.kept_for_a_run import kept_for_a_run

PACKAGE = Path(__file__).resolve().parents[2] / "src" / "rulec"

MOST_POSITIONAL = 5


@dataclass(frozen=True)
class SourceModule:
    """A module: its path below the package, its lines, and what its tree says.

    ``classes``: the public ones at its top. ``named``: classes, functions and what is annotated,
    wherever it is. ``loaded``: names that are read. ``called``: how often which name is, however
    it is used in a call. ``codes``: code -> the name that it is bound to. ``wide``: what is defined
    or called with many positional parameters. ``laid_out``: what is called with a tuple laid out
    in the call. ``inner_imports``: lines of imports within functions.
    """

    name: str
    lines: tuple[str, ...]
    classes: tuple[str, ...]
    named: frozenset[str]
    loaded: frozenset[str]
    called: Mapping[str, int]
    codes: Mapping[str, str]
    wide: tuple[str, ...]
    laid_out: tuple[str, ...]
    inner_imports: frozenset[int]

    @property
    def stem(self) -> str:
        return Path(self.name).stem


def read_module(name: str, text: str) -> SourceModule:
    """What a module's text says."""
    tree = ast.parse(text)
    named, loaded, inner_imports = set(), set(), set()
    called, wide, laid_out = Counter(), [], []
    for node, in_function in _nodes(tree):
        match node:
            case ast.Name(id=word, ctx=ast.Load()) | ast.Attribute(attr=word, ctx=ast.Load()):
                loaded.add(word)
            case ast.Call(func=func, args=arguments):
                if isinstance(func, ast.Name):
                    called[func.id] += 1
                plain = [part for part in arguments if not isinstance(part, ast.Starred)]
                if len(plain) > MOST_POSITIONAL:
                    wide.append(ast.unparse(func))
                if any(isinstance(part.value, ast.Tuple) for part in {*arguments} - {*plain}):
                    laid_out.append(ast.unparse(func))
            case ast.ClassDef(name=word):
                named.add(word)
            case ast.FunctionDef(name=word):
                named.add(word)
                if _is_wide(node):
                    wide.append(word)
            case ast.AnnAssign(target=ast.Name(id=word)):
                named.add(word)
            case ast.Import() | ast.ImportFrom() if in_function:
                inner_imports.add(node.lineno)
    classes = [node.name for node in tree.body if isinstance(node, ast.ClassDef)]
    return SourceModule(
        name,
        tuple(text.splitlines()),
        tuple(word for word in classes if not word.startswith("_")),
        frozenset(named),
        frozenset(loaded),
        dict(called),
        dict(_codes(tree)),
        tuple(wide),
        tuple(laid_out),
        frozenset(inner_imports),
    )


def _is_wide(node: ast.FunctionDef) -> bool:
    """Whether a function has many positional parameters; click passes all of a command by name."""
    names = [own.arg for own in (*node.args.posonlyargs, *node.args.args)]
    is_command = any("command(" in ast.unparse(own) for own in node.decorator_list)
    return not is_command and len(names) - (names[:1] in (["self"], ["cls"])) > MOST_POSITIONAL


def _nodes(tree: ast.Module) -> Iterator[tuple[ast.AST, bool]]:
    """Every node, and whether it is within a function."""
    left = [(tree, False)]
    while left:
        node, in_function = left.pop()
        yield node, in_function
        below = in_function or isinstance(node, ast.FunctionDef)
        left += [(child, below) for child in ast.iter_child_nodes(node)]


def _codes(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Codes that are bound to a name at the top of a module, each with the name."""
    for node in tree.body:
        match node:
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.Call(func=ast.Name(id="Code"), args=[ast.Constant(value=text), *_]),
            ):
                yield text, name


@cache
def source_modules() -> tuple[SourceModule, ...]:
    """Every module of the package, by name."""

    def read() -> tuple[SourceModule, ...]:
        return tuple(
            read_module(str(path.relative_to(PACKAGE)), path.read_text(encoding="utf-8"))
            for path in sorted(PACKAGE.rglob("*.py"))
        )

    return kept_for_a_run("source modules", read)


def rooms() -> Iterator[Path]:
    """Every folder of the package with modules in it."""
    return (path.parent for path in sorted(PACKAGE.rglob("__init__.py")))
