"""The public names: one table, and everything that repeats it agrees."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import rulec
import rulec.api.verbs
import rulec.fleet

SOURCE = Path(rulec.__file__)


def checked_imports():
    """What type checkers see: name -> module, from the block under TYPE_CHECKING."""
    tree = ast.parse(SOURCE.read_text(encoding="utf-8"))
    (block,) = [node for node in tree.body if isinstance(node, ast.If)]
    imports = [node for node in block.body if isinstance(node, ast.ImportFrom)]
    return {
        name: node.module
        for node in imports
        for alias in node.names
        if alias.name == "*" or alias.asname  # what is not called anew is not public
        for name in (exported(node.module) if alias.name == "*" else [alias.asname])
    }


def exported(module):
    """The names that ``import *`` takes from a module: its own, not what it imports itself."""
    statements = ast.parse(Path(sys.modules[module].__file__).read_text(encoding="utf-8")).body
    named = [node.targets[0].id for node in statements if isinstance(node, ast.Assign)]
    named += [node.name for node in statements if isinstance(node, ast.FunctionDef)]
    return [name for name in named if not name.startswith("_")]


def test_type_checkers_and_python_see_the_same():
    assert set(rulec.__all__) == checked_imports().keys()
    assert set(dir(rulec)) >= set(rulec.__all__)
    assert len(rulec.__all__) == len(set(rulec.__all__))


@pytest.mark.parametrize("name", rulec.__all__)
def test_every_name_is_there_and_says_what_it_is(name):
    value = getattr(rulec, name)
    assert name == "__version__" or (value.__doc__ or "").strip()


def test_an_unknown_name():
    with pytest.raises(AttributeError, match="no attribute 'verfy'"):
        _ = rulec.verfy


def test_importing_it_imports_no_room():
    program = "import sys, rulec; print(sorted(name for name in sys.modules if 'rulec' in name))"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert ast.literal_eval(done.stdout) == ["rulec"]


def session_verbs():
    return {
        name
        for name, value in inspect.getmembers(rulec.Session, inspect.isfunction)
        if not name.startswith("_") and name != "on_warning"
    }


def test_every_verb_of_a_session_is_a_function():
    functions = {name for name, home in checked_imports().items() if home == "rulec.api.verbs"}
    assert functions == session_verbs()


COMMANDS = {
    "compile_check": "verify_compiled",
    "fmt": "format",
    "maneuvers": "find_maneuvers",
    "monitor": "Monitor",
    "new": "new_rulebook",
    "rates": "rates_of_findings",
}


def test_every_command_can_be_called():
    folder = SOURCE.parent / "cli" / "commands"
    commands = {file.stem for file in folder.rglob("*.py")} - {
        "__init__",
        "completion",
        "help",
        "man",
    }
    # Engines of many machines have a surface of their own, as they take Arrow.
    assert rulec.fleet.run_fleet is not None
    commands.remove("fleet")
    # A server of editors, which they start; what it answers is what the others are called for.
    commands.remove("lsp")
    assert {COMMANDS.get(name, name) for name in commands} <= set(rulec.__all__)


def annotated(function):
    signature = inspect.signature(function)
    return [
        *(p.annotation for p in signature.parameters.values() if p.name != "self"),
        signature.return_annotation,
    ]


@pytest.mark.parametrize("name", sorted(session_verbs()))
def test_every_verb_is_typed(name):
    assert inspect.Signature.empty not in annotated(getattr(rulec.Session, name))


def test_what_verbs_return_is_public():
    """Every class that a verb's signature names is exported."""
    words = set()
    for name in session_verbs():
        for annotation in annotated(getattr(rulec.Session, name)):
            words |= {
                node.id for node in ast.walk(ast.parse(annotation)) if isinstance(node, ast.Name)
            }
    names = {word for word in words if word[0].isupper()}
    helpers = {
        "ArrayLike",
        "Before",
        "Callable",
        "Fraction",
        "GraphOptions",
        "GroupKey",
        "Iterable",
        "Iterator",
        "Kind",
        "LanguageCode",
    }
    helpers |= {
        "Literal",
        "Mapping",
        "Path",
        "PictureFormat",
        "Rules",
        "Sequence",
        "Spread",
        "Theme",
        "Unpack",
    }
    assert names - helpers <= set(rulec.__all__)


def test_the_reference_names_all():
    page = Path("docs/python.md").read_text(encoding="utf-8")
    assert {name for name in rulec.__all__ if f"`{name}" not in page} == {"__version__"}


def test_the_fleet_is_there_without_an_import_of_its_own():
    program = "import rulec; print(rulec.fleet.FleetJudge.__name__)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert done.stdout == b"FleetJudge\n"
