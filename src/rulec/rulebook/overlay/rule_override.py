"""The effect of an override on an inherited rule, and what it loses."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

from rulec.rulebook.names.referenced_names import chain_of, names_in, names_used
from rulec.syntax import tree

CLAUSES = (
    *("strength", "variables", "level", "weight", "cite", "says", "source", "certainty"),
    *("in_force", "topics", "require", "when", "unless", "examples"),
)
"""The fields of a rule's tree that an override may replace."""


def merged(base: tree.RuleItem, over: tree.RuleItem) -> tree.RuleItem:
    """The rule, with the clauses of the override replacing its own.

    The source and certainty of a provision are replaced together with the provision.
    """
    if over.cite:
        base = replace(base, source=None, certainty="")
    given = {clause: value for clause in CLAUSES if (value := getattr(over, clause))}
    if not _replaces_exceptions(over):
        given["unless"] = (*base.unless, *over.unless)
    complete = over.complete and base.complete
    return replace(base, name=over.name, span=over.span, complete=complete, **given)


def softened(rule: tree.RuleItem, item: tree.SoftenItem) -> tree.RuleItem:
    """The rule as a line softens it."""
    level, weight = item.level or rule.level, item.weight or rule.weight
    return replace(rule, strength="soft", level=level, weight=weight)


def lost_variables(base: tree.RuleItem, over: tree.RuleItem) -> list[tree.Parameter]:
    """Variables that an override omits although inherited clauses use them."""
    if not over.variables:
        return []
    inherited = replace(
        base,
        require=None if over.require else base.require,
        when=None if over.when else base.when,
        unless=() if _replaces_exceptions(over) else base.unless,
        examples=() if over.examples else base.examples,
    )
    names = {*names_used(inherited), *chain.from_iterable(map(names_in, inherited.examples))}
    kept = {variable.name.text for variable in over.variables}
    lost = (variable for variable in base.variables if variable.name.text not in kept)
    return [
        variable
        for variable in lost
        if variable.name.text in names
        or any(name.endswith(f"_{variable.name.text}") for name in names)
    ]


def changed_types(
    base: tree.RuleItem, over: tree.RuleItem
) -> list[tuple[tree.Parameter, tree.Parameter]]:
    """Variables to which an override gives another type: as inherited, and as they are now.

    An override that says anew what the rule is may be about others.
    """
    if over.require is not None or over.says is not None:
        return []
    known = {variable.name.text: variable for variable in base.variables}
    pairs = ((known.get(after.name.text), after) for after in over.variables)
    return [
        (before, after)
        for before, after in pairs
        if before and before.type and after.type and before.type.text != after.type.text
    ]


def _replaces_exceptions(over: tree.RuleItem) -> bool:
    return not all(exception.also for exception in over.unless)


def lost_exceptions(base: tree.RuleItem, over: tree.RuleItem) -> tuple[tree.Unless, ...]:
    """Inherited exceptions that an override replaces without repeating them.

    An override with a requirement of its own has its own exceptions, too.
    """
    if over.require is not None or not _replaces_exceptions(over):
        return ()
    kept = [
        (formula, exception.scope)
        for exception in over.unless
        for formula in (exception.formula, *chain_of("or", exception.formula))
    ]
    return tuple(
        unless
        for unless in base.unless
        if not all((formula, unless.scope) in kept for formula in chain_of("or", unless.formula))
    )
