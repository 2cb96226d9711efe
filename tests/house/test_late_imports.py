"""Imports stand at the top of a module; commands and verbs have a door each for what is late."""

import re
from importlib import import_module

import pytest

from rulec.lazy_loading import homes
from support.source_modules import PACKAGE, source_modules

DOORS = ("rulec.api.lazy_imports", "rulec.cli.lazy_imports")
SURFACES = ("rulec", "rulec.scenario", "rulec.trace.formats.arrow")
"""Packages whose names are imported at first use, in the way of the doors."""

NUMPY = "NumPy takes 0.1 s, and what is known or small does without"
COMPILER = "compilers take 30 to 200 ms, where the cache has the answer"
FORMAT = "a format takes 5 to 100 ms, and only one is asked for"
MESSAGE = "only for a message"
OPTIONAL = "an optional package"
PARSER = "the parser takes 60 ms, where the cache has the answer"
EXPLAINED = "explanations take 20 ms, only where something is violated or asked for"
UNKNOWN = "what judges the unknown takes 5 to 100 ms, only where something is"
POOL = "worker processes take 15 ms, only where there are several"

LATE = {
    "__init__.py": (1, "importing the package imports nothing"),
    "automata/bundle/required_signature.py": (2, OPTIONAL),
    "automata/compiled_cache.py": (2, COMPILER),
    "automata/outcome_machine.py": (1, NUMPY),
    "automata/worker/worker_answers.py": (2, "Spot is optional; one compiler is chosen"),
    "batch/recording_judge.py": (1, EXPLAINED),
    "batch/worker_pool.py": (1, POOL),
    "code_generation/monitor_files.py": (1, "a proof takes 170 ms to import, if asked for"),
    "diagnostics/fault_messages.py": (1, MESSAGE),
    "diagnostics/phrases.py": (1, MESSAGE),
    "enforced_limits.py": (1, "NumPy is loaded before memory is limited"),
    "files/read_files.py": (1, FORMAT),
    "fleet/runs/fleet_run.py": (2, OPTIONAL),
    "resources.py": (1, MESSAGE),
    "lazy_loading.py": (1, "ast takes 3 ms, not for `rulec --version`"),
    "monitoring/batch/stacked/stacked_run.py": (1, UNKNOWN),
    "monitoring/batch/verify_arrays.py": (1, "engines for states, which few recordings need"),
    "monitoring/unfitting_values.py": (2, MESSAGE),
    "monitoring/rulebook_edition.py": (1, FORMAT),
    "partition/cell_graph.py": (1, OPTIONAL),
    "partition/cells/cell_model.py": (1, "Shapely takes 0.1 s, and is rarely needed"),
    "partition/navigation_graph.py": (1, NUMPY),
    "planning/maneuvers.py": (1, UNKNOWN),
    "planning/rule_instances.py": (1, UNKNOWN),
    "rates/exact_intervals.py": (1, OPTIONAL),
    "recordings/recording_files.py": (1, NUMPY),
    "report/pictures/drawing/picture_formats.py": (1, OPTIONAL),
    "report/text/console.py": (2, "rich takes 40 ms, only for a terminal"),
    "report/text/html_page.py": (1, "markdown-it and Pygments take 30 ms, only for pages"),
    "rulebook/batch/batch_check.py": (1, PARSER),
    "rulebook/batch/batch_format.py": (1, PARSER),
    "rulebook/batch/shipped_lock.py": (1, "rulebooks take 50 ms, not for each check"),
    "rulebook/names/word_meanings.py": (1, MESSAGE),
    "rulebook/reading/rulebook_reader.py": (1, PARSER),
    "scenario/scenario_files.py": (1, NUMPY),
    "syntax/parser.py": (1, MESSAGE),
    "trace/formats/arrow/parquet.py": (1, OPTIONAL),
    "vocabulary/pint_units.py": (1, "Pint takes 0.2 s, only for units that are not listed"),
}
"""Module -> how many imports stand in its functions, and why."""

MOST_LATE = 44
"""A bound that only falls."""


def late_imports():
    """Module -> the number of imports in its functions."""
    return {one.name: len(one.inner_imports) for one in source_modules() if one.inner_imports}


def test_imports_in_functions_are_those_with_a_reason():
    assert late_imports() == {name: number for name, (number, _) in LATE.items()}
    assert sum(late_imports().values()) == MOST_LATE, "lower it where one leaves"


def test_commands_and_verbs_have_none():
    assert [name for name in late_imports() if name.startswith(("api/", "cli/"))] == []


@pytest.mark.parametrize("door", DOORS + SURFACES)
def test_what_is_listed_is_there(door):
    names = {name for name, (home, _) in homes(door).items() if home.startswith("rulec.")}
    assert names
    for name in names:
        assert getattr(import_module(door), name) is not None


@pytest.mark.parametrize("door", DOORS)
def test_a_door_lists_what_is_taken_from_it(door):
    room = door.removesuffix(".lazy_imports")
    texts = (module.read_text(encoding="utf-8") for module in PACKAGE.rglob("*.py"))
    own = [text for text in texts if f"from {room} import lazy_imports as lazy" in text]
    taken = {name for text in own for name in re.findall(r"\blazy\.(\w+)", text)}
    assert set(homes(door)) == taken


def test_other_names_are_not_there():
    for module in (*DOORS, *SURFACES):
        with pytest.raises(AttributeError, match=f"{module}' has no attribute 'nothing'"):
            _ = import_module(module).nothing


def test_a_replaced_function_is_the_one_found(monkeypatch):
    lazy = import_module("rulec.cli.lazy_imports")
    assert lazy.read_rulebook("esterle2019").rulebook.name == "esterle2019"
    monkeypatch.setattr("rulec.rulebook.reading.rulebook_reader.read_rulebook", str.upper)
    assert lazy.read_rulebook("name") == "NAME"
