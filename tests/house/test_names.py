"""A name means one thing, and it is the field's: docs/glossary.md."""

import re
from collections import defaultdict
from pathlib import Path

import rulec
from support.source_modules import PACKAGE, source_modules

ROOT = Path(__file__).resolve().parents[2]
GLOSSARY = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")

LITERARY = """
    told said meant spelled gathered wanted company crowd team standing scene floors outline room
    gate everyone whereabouts ways placed telling view nearness ground witness objects effects
    places dwelling classes rejections passages before moment numbers letters facts edges exercise
    repair checking terms prefix memory saved past answering meaning spelling gathering tabled
    naming codes leaping long truth judged judging tasks staging situation columns joint distinct
    reasons family history inheritance violation search triggers older_audit alike otherwise lost
    applying answers chances events exceptions declared extent numerals counts uses finding bases
    recollection provisions descriptions asked one_state comparing constants data timing deciding
    difference differences explanation explanations folding conditions judge judge_chunk
    judge_items judge_columns judge_cells
"""
PRIVATE_WORDS = frozenset(LITERARY.split())
"""Modules were called so, and nobody could tell what was in them."""

KEPT = {
    "explanation": "the explanation of a violation, as in the literature on counterexamples",
    "columns": "monitoring/batch keeps many traces in columns, as engines of tables do",
}
"""At most ten of them stay, with their reasons."""

REPEATED_MODULES = {
    "lazy_imports": "the doors of cli and of api",
    "maneuvers": "cli/commands has a file for each command",
    "tree": "likewise",
    "verify": "likewise",
}


def modules_and_folders():
    """The names in the package, as one reads them in the tree."""
    folders = {path.parent.name for path in PACKAGE.rglob("__init__.py")}
    return folders | {path.stem for path in PACKAGE.rglob("*.py")}


def test_no_private_word_is_a_module():
    assert modules_and_folders() & PRIVATE_WORDS <= KEPT.keys()
    assert len(KEPT) <= 10


def test_a_module_name_occurs_once():
    seen = defaultdict(list)
    for module in source_modules():
        if module.stem != "__init__":
            seen[module.stem].append(module.name)
    repeated = {stem for stem, names in seen.items() if len(names) > 1}
    assert repeated - REPEATED_MODULES.keys() == set()


def public_classes():
    """Public class -> the modules that define it."""
    seen = defaultdict(list)
    for module in source_modules():
        for name in module.classes:
            seen[name].append(module.name)
    return seen


def test_a_class_name_occurs_once():
    repeated = {name for name, homes in public_classes().items() if len(homes) > 1}
    assert repeated == set()


def glossary_names():
    """The names in the glossary's column `in code`."""
    rows = [line.split(" | ") for line in GLOSSARY.splitlines() if line.startswith("| **")]
    return {name for row in rows for name in re.findall(r"`([^`]+)`", row[2])}


def names_in_code():
    """Modules, folders, and whatever is defined or annotated in the package."""
    return modules_and_folders().union(*(module.named for module in source_modules()))


def test_what_the_glossary_names_is_in_the_code():
    assert glossary_names() - names_in_code() == set()


def test_every_public_type_is_in_the_glossary():
    types = {name for name in rulec.__all__ if name[0].isupper()}
    assert types - glossary_names() == set()


def test_a_term_stands_once_with_its_meaning_and_its_source():
    rows = [line.strip("| ").split(" | ") for line in GLOSSARY.splitlines()]
    rows = [row for row in rows if row[0].startswith("**")]
    assert len(rows) >= 40
    terms = [row[0] for row in rows]
    assert sorted(set(terms)) == sorted(terms)
    for row in rows:
        assert len(row) == 4, row[0]
        assert row[1].endswith("."), row[0]
        assert row[3], row[0]
