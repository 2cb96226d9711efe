"""A doubt has one type: words are truths, numbers and choices, not masks beside masks."""

import ast

from support.source_modules import PACKAGE

ROOMS = ("extraction/signals", "cell_words")

MOST_BY_HAND = 34
"""Names of masks that keep a doubt beside its value; these become fewer, and never more."""


def is_a_doubt(name: str) -> bool:
    return name in {"unknown", "perhaps", "surely"} or name.startswith("may_")


def bound_names(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg


def test_doubts_are_kept_by_their_type():
    modules = [module for room in ROOMS for module in (PACKAGE / room).rglob("*.py")]
    assert modules
    found = sum(
        is_a_doubt(name)
        for module in modules
        # The type itself says where its values are unknown
        if module.name != "signal_columns.py"
        for name in bound_names(ast.parse(module.read_text(encoding="utf-8")))
    )
    assert found <= MOST_BY_HAND, "a doubt belongs to the type of its value (Truth, Number)"
    assert found > MOST_BY_HAND - 5, f"lower MOST_BY_HAND to {found}"
