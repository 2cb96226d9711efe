"""Proof of a rule's parts against its formula: what it requires, its exceptions, its condition.

The rule's trigger is derived from the parts, so they must be those of the formula. They are
combined again as docs/language.md describes, and must give the formula literally: equivalent ones
may have other triggers, such as `never (p and not q)` and `never (not q and p)`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeAlias

from rulec.validation.unprovable import require

SCOPES = ("initially", "at start", "at end", "throughout", "at some point")
_GUARDING = ("always", "never")
_MOST_PHASES = 64
"""Exceptions that hold throughout say each phase several times; more phases are not proved."""


def prove_parts(rule: Mapping[str, Any]) -> None:
    """Raise UnprovableError unless a rule's parts, if it has any, make up its formula."""
    parts = rule.get("parts")
    if parts is None:
        return
    built = _put_together(
        parts["required"], parts.get("exemptions", []), parts.get("condition", True)
    )
    require(rule["tree"] == built, "its parts do not make up its formula")


def _put_together(required: Any, exemptions: Iterable[tuple[str, Any]], condition: Any) -> Any:
    """The formula of a rule; its condition becomes an exception that applies when it is false."""
    named = list(exemptions)
    require(all(scope in SCOPES for scope, _ in named), "it has an exception with an unknown scope")
    initially = [tree for scope, tree in named if scope == "initially"]
    inside = [(scope, tree) for scope, tree in named if scope != "initially"]
    formula = required
    if condition is not True:
        if _operator(required) in _GUARDING:
            inside.append(("at some point", _not(condition)))
        else:
            formula = ["implies", condition, required]
    if inside:
        require(_operator(formula) in _GUARDING, "it has exceptions but guards nothing")
        operator, operand, *bound = formula
        if operator == "always":
            operand = _any([_any(tree for _, tree in inside), operand])
        else:
            operand = _counted(_phases(operand), inside)
        formula = [operator, operand, *bound]
    return _any([*initially, formula])


def _operator(tree: Any) -> Any:
    return tree[0] if isinstance(tree, list) and tree else None


def _not(tree: Any) -> Any:
    if isinstance(tree, bool):
        return not tree
    return tree[1] if _operator(tree) == "not" else ["not", tree]


def _joined(operator: str, neutral: bool, trees: Iterable[Any]) -> Any:
    whole: Any = neutral
    for tree in trees:
        if tree is (not neutral):
            return tree
        if tree is not neutral:
            whole = tree if whole is neutral else [operator, whole, tree]
    return whole


def _all(trees: Iterable[Any]) -> Any:
    return _joined("and", True, trees)


def _any(trees: Iterable[Any]) -> Any:
    return _joined("or", False, trees)


Phase: TypeAlias = tuple[Any, list[Any]]
"""The tree of a phase, and its bound in a list, empty without one."""


def _phases(tree: Any) -> list[Phase]:
    phases: list[Phase] = []
    while _operator(tree) == "then":
        _, first, rest, *bound = tree
        phases.append((first, bound))
        tree = rest
    return [*phases, (tree, [])]


def _counted(phases: Sequence[Phase], exemptions: Sequence[tuple[str, Any]]) -> Any:
    """The sequences that no exception exempts.

    What is guarded is the stretch between the first and the last phase; with two phases, the last
    instant of the first and the first instant of the second.
    """
    if len(phases) == 1:
        return _all([phases[0][0], *(_not(tree) for _, tree in exemptions)])
    denied = {scope: [_not(tree) for own, tree in exemptions if own == scope] for scope in SCOPES}
    start, end = _all(denied["at start"]), _all(denied["at end"])
    all_along, failing = _all(denied["at some point"]), denied["throughout"]
    failing = [part for number, part in enumerate(failing) if part not in failing[:number]]
    if failing:
        require(not any(bound for _, bound in phases), "it bounds a phase that exceptions divide")
        require(len(phases) <= _MOST_PHASES, "its phases are too many for this checker")
    if len(phases) == 2:
        return _border(phases, _all([start, all_along]), _all([end, all_along]), failing)
    (first, bound), last = phases[0], len(phases) - 1

    def entered(number: int, due: Sequence[Any]) -> Any:
        """The formula from a phase's start on; what is ``due`` must still fail at some point."""
        if number == last:
            return phases[number][0]
        here = within(number, due)
        return _all([start, here]) if number == 1 else here

    def within(number: int, due: Sequence[Any]) -> Any:
        tree, own = phases[number]
        phase, is_last = _all([tree, all_along]), number == last - 1
        at_last = end if is_last else True
        if not due:
            return _remainder((phase, own), at_last, entered(number + 1, ()))
        onward = [_all([at_last, ["next", entered(number + 1, ())]]), ["next", within(number, ())]]
        later = [] if is_last else [["next", entered(number + 1, due)]]
        ways = [*later, _all([*due, _any(onward)])]
        return ["until", phase, _all([phase, _any(ways)])]

    # Each fails up to an end of its own; up to the last of these ends, all of them do.
    each: list[list[Any]] = [[part] for part in failing] or [[]]
    return ["then", first, _all([entered(1, due) for due in each]), *bound]


def _border(phases: Sequence[Phase], before: Any, behind: Any, failing: Sequence[Any]) -> Any:
    """The two instants around the border of two phases."""
    (first, _), (second, _) = phases
    behind = _all([second, behind])
    if not failing:
        return _remainder(phases[0], before, behind)
    each = [_any([part, ["next", part]]) for part in failing]
    return ["until", first, _all([first, before, ["next", behind], *each])]


def _remainder(phase: Phase, at_last: Any, behind: Any) -> Any:
    """The rest of a phase and the instant after it; ``at_last`` holds in its last instant."""
    tree, bound = phase
    if at_last is True:
        return ["then", tree, behind, *bound]
    if bound:
        return ["then", tree, _all([["previously", at_last], behind]), *bound]
    return ["until", tree, _all([tree, at_last, ["next", behind]])]
