"""Formulas in which temporal operators apply to less than it seems.

They are well-formed and read as written, but hardly anyone means them, so they deserve a warning.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from rulec.diagnostics import Diagnostic, Fix, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import offering
from rulec.rulebook.elaborate.elaboration_messages import parentheses_behind, short
from rulec.rulebook.names.referenced_names import atoms_in, parts_of
from rulec.rulebook.names.symbol_table import SymbolTable
from rulec.rulebook.overlay.rulebook_overlay import Overlay
from rulec.syntax import tree
from rulec.syntax.keywords import BINDS_NARROWLY, JOINS_ALIKE, LOOKS_BACK, OF_ONE_STATE, PRECEDENCE

FIRST_STATE_ONLY = Code(
    "R0360",
    title="a rule requires something only in the first state",
    why="Without a temporal operator such as `always` or `never`, a formula is only about the "
    "first state of a trace: a vehicle that starts slowly satisfies `require speed <= limit`. "
    "The same holds for a condition outside of it: `require red_light implies eventually halted` "
    "is only about a light that is red as the trace begins. Operators of the past do not help, "
    "since the first state has no past. `rulec check --fix` puts `always`, or `never` in place "
    "of `not`, before it. If you mean the first state, write `always (previously true or p)`, "
    "which requires `p` only in the state that has none before it.",
    bad="rulebook example\nquantity speed in km/h default 0\n"
    "hard rule r { require speed <= 50 km/h }\n",
    good="rulebook example\nquantity speed in km/h default 0\n"
    "hard rule r { require always (speed <= 50 km/h) }\n",
)

NARROW_OPERATOR = Code(
    "R0361",
    title="a temporal operator applies to less than what follows it",
    why="The operators `never`, `always` and `eventually` bind tighter than `and`, `or` and "
    "`implies`: `never a and b` means `(never a) and b`, which requires `b` only in the first "
    "state. `rulec check --fix` puts what follows in parentheses, except before `until` and its "
    "kin: what is forbidden until a sign is written `not a until b`, for `never (a until b)` would "
    "forbid the sign itself. If you mean the other reading, put the parentheses around the "
    "operator, as `rulec fmt` does, to make it visible.",
    bad="rulebook example\nsignal a, b\nhard rule r { require always a implies b }\n",
    good="rulebook example\nsignal a, b\nhard rule r { require always (a implies b) }\n",
)

TWO_READINGS = Code(
    "R0362",
    title="an `and` or `or` beside `until` can be read in two ways",
    why="The operators `until`, `release`, `weak until`, `strong release` and `since` bind "
    "tighter than `and`, `or` and `xor`: `a until b and c` means `(a until b) and c`, which "
    "requires `c` immediately, not when `b` occurs. Many read it the other way. Parentheses "
    "around one part or the other make the meaning clear; the message shows both.",
    bad="rulebook example\nsignal a, b, c default false\n"
    "hard rule r { require always (a implies b until c and not a) }\n",
    good="rulebook example\nsignal a, b, c default false\n"
    "hard rule r { require always (a implies b until (c and not a)) }\n",
)

_LASTING = ("until", "weak until", "release", "strong release", "since")
"""Operators that say themselves how long something lasts."""


def requirement_warnings(
    node: tree.Formula, symbols: SymbolTable, overlay: Overlay
) -> Iterator[Diagnostic]:
    """Warnings for the parts of a requirement that apply to the first state only."""
    parts = [*_conjuncts(node)]
    for part in parts:
        asked_once = _asked_once(part, overlay.definitions)
        if asked_once is not None and _changes(asked_once, symbols, overlay):
            yield _first_state_only(part, asked_once, alone=len(parts) == 1)


def _asked_once(
    node: tree.Formula, definitions: Mapping[str, tree.DefineItem]
) -> tree.Formula | None:
    """The part of a requirement that is evaluated in the first state and in no other.

    It is all of a formula without an operator that looks ahead, the condition of a duty, or what a
    forbidden sequence begins with.
    """
    if not _looks_ahead(node, definitions):
        return node
    match node:
        case tree.Infix("implies", left, right) if not _looks_ahead(left, definitions):
            # `congested implies always p` is about whole traces, by how they begin.
            return None if all(map(_is_of_all_states, _conjuncts(right))) else left
        case tree.Prefix("not", tree.Infix("then", left, _)):
            return left
    return None


def _is_of_all_states(node: tree.Formula) -> bool:
    match node:
        case tree.Prefix("always" | "never", bound=None):
            return True
    return False


def operator_warnings(node: tree.Formula, overlay: Overlay) -> Iterator[Diagnostic]:
    """Warnings for temporal operators in a formula that apply to less than it may seem."""
    narrow = [*_narrow(node, (), overlay.definitions)]
    yield from narrow
    for warning in until_warnings(node):
        if not any(covers(diagnostic, warning) for diagnostic in narrow):
            yield warning


def covers(first: Diagnostic, warning: Diagnostic) -> bool:
    """Whether the place, or the fix, of one warning covers the place of another one.

    What stands behind an operator with two possible reaches is left until its author has chosen.
    """
    place = first.place if first.fix is None else first.fix.place
    if place is None or warning.place is None or place.file != warning.place.file:
        return False
    if _leaves_reach_open(first):
        return place.start <= warning.place.start
    return place.start <= warning.place.start < (place.end_line or 0, place.end_column or 0)


def _conjuncts(node: tree.Formula) -> Iterator[tree.Formula]:
    if isinstance(node, tree.Infix) and node.operator == "and":
        yield from _conjuncts(node.left)
        yield from _conjuncts(node.right)
    else:
        yield node


def _narrow(
    node: tree.Formula,
    behind: Sequence[tree.Infix],
    definitions: Mapping[str, tree.DefineItem],
) -> Iterator[Diagnostic]:
    """Walk through a formula.

    ``behind`` are the operations that continue after it, nearest first.
    """
    if isinstance(node, tree.Grouping) and node.grouped:
        behind = ()
    match node:
        case tree.Infix(_, left, right):
            yield from _narrow(left, (node, *behind), definitions)
            yield from _narrow(right, behind, definitions)
        case tree.Prefix(operator, operand):
            grouped = isinstance(operand, tree.Grouping) and operand.grouped
            if operator in BINDS_NARROWLY and behind and not grouped:
                nearest = behind[0]
                joins = nearest.operator in JOINS_ALIKE
                alike = joins and _looks_ahead(nearest.right, definitions)
                # `then` has a warning of its own, and `eventually p implies q` reads as it is.
                if not alike and nearest.operator != "then" and (joins or operator != "eventually"):
                    until = _reach(node, behind, definitions)
                    yield _narrow_operator(node, nearest.operator, until)
                    behind = ()
            yield from _narrow(operand, behind, definitions)
        case _:
            for part in parts_of(node):
                yield from _narrow(part, (), definitions)


def _reach(
    prefix: tree.Prefix,
    behind: Sequence[tree.Infix],
    definitions: Mapping[str, tree.DefineItem],
) -> int:
    """The end of what the operator was probably meant to apply to, as a character position."""
    end = prefix.span.end
    for operation in behind:
        alike = operation.operator in JOINS_ALIKE
        if alike and _looks_ahead(operation.right, definitions):
            break
        end = operation.span.end
    return end


def _looks_ahead(node: tree.Formula, definitions: Mapping[str, tree.DefineItem]) -> bool:
    """Whether a formula has an operator about later states, also in definitions that it uses."""
    pending, seen = [node], set[str]()
    while pending:
        part = pending.pop()
        if (
            isinstance(part, tree.Prefix | tree.Infix)
            and part.operator not in OF_ONE_STATE | LOOKS_BACK
        ):
            return True
        if isinstance(part, tree.AtomUse):
            names = {part.name.text, *(argument.text for argument in part.arguments)} - seen
            seen |= names
            pending += (definitions[name].body for name in names if name in definitions)
        pending += parts_of(part)
    return False


def _changes(node: tree.Formula, symbols: SymbolTable, overlay: Overlay) -> bool:
    """Whether a formula reads something that may change within a trace."""
    pending, seen = [node], set[str]()
    while pending:
        for use in atoms_in(pending.pop()):
            name = use.name.text
            if name in overlay.definitions and name not in seen:
                seen.add(name)
                pending.append(overlay.definitions[name].body)
            item = symbols.items.get(name) or symbols.value_of.get(name)
            if item is not None and not item.constant:
                return True
    return False


def until_warnings(
    node: tree.Formula, before: tree.Infix | None = None, behind: tree.Infix | None = None
) -> Iterator[Diagnostic]:
    """Warnings for operators like `until` in a formula that can be read in two ways.

    ``a until b and c`` means ``(a until b) and c``, but half of its readers take it for ``a until
    (b and c)``, so `and` and `or` beside such an operator deserve parentheses.

    ``before`` is the nearest operation whose right operand begins with the formula, ``behind`` the
    nearest one whose left operand ends with it.
    """
    if isinstance(node, tree.Grouping) and node.grouped:
        before = behind = None
    if not isinstance(node, tree.Infix):
        for part in parts_of(node):
            yield from until_warnings(part)
        return
    if _is_until(node):
        before = before if _misleads(before, node.left, right=False) else None
        behind = behind if _misleads(behind, _last(node), right=True) else None
        if before is not None or behind is not None:
            yield _two_readings(node, before, behind)
        before = behind = None
    yield from until_warnings(node.left, before, node)
    yield from until_warnings(node.right, node, behind)


def _is_until(node: tree.Infix) -> bool:
    return PRECEDENCE[node.operator] > max(PRECEDENCE[join] for join in JOINS_ALIKE)


def _last(node: tree.Infix) -> tree.Formula:
    """The last operand of a chain: `c` of `a until b until c`."""
    last = node.right
    while isinstance(last, tree.Infix) and _is_until(last) and not last.grouped:
        last = last.right
    return last


def _misleads(join: tree.Infix | None, nearest: tree.Formula, *, right: bool) -> bool:
    """Whether a join may seem to join its neighbour only to the ``nearest`` operand."""
    if join is None or join.operator not in JOINS_ALIKE:
        return False
    grouped = isinstance(nearest, tree.Grouping) and nearest.grouped
    # `a until (b or c) and d` needs its parentheses in either reading; `(b and c)` shows where the
    # operand ends.
    if grouped and not (isinstance(nearest, tree.Infix) and nearest.operator != join.operator):
        return False
    # What both sides have is read alike: `a until b and c until d`.
    beside = join.right if right else join.left
    while isinstance(beside, tree.Infix) and beside.operator in JOINS_ALIKE and not beside.grouped:
        beside = beside.left if right else beside.right
    return not (isinstance(beside, tree.Infix) and _is_until(beside) and not beside.grouped)


def _first_state_only(node: tree.Formula, asked_once: tree.Formula, *, alone: bool) -> Diagnostic:
    """A requirement, or a part of one if not ``alone``, with a part outside of every `always`.

    ``asked_once`` is that part, or the whole.
    """
    text = node.span.text
    bare = isinstance(node, tree.AtomUse | tree.Aggregate)
    if isinstance(node, tree.Prefix) and node.operator == "not":
        wider = f"never {text[len(node.sign) :].lstrip()}"
    else:
        wider = f"always {text}" if bare else f"always ({text})"
    looks_back = _is_false_at_first(node)
    spoken = f"write `{wider if len(wider) <= 60 else f'{wider[:59]}…'}` to speak of all states"
    if looks_back:
        spoken = (
            "`previously` is false in the first state: say in which states this is asked for, as "
            "in `always (p implies previously q)`, or write `always` and `weak previously`"
        )
    asker = "the rule asks" if alone else "this part of the rule asks"
    asked = "for" if asked_once is node else "whether there is"
    return FIRST_STATE_ONLY.at(
        node.span,
        f"{asker} {asked} `{short(asked_once)}` in the first state only",
        expected="nothing here speaks of later states"
        if asked_once is node
        else "no operator of time is about the whole of this",
        help=spoken,
        severity="warning",
        fix=None if looks_back else Fix(node.span.place, wider),
    )


def _is_false_at_first(node: tree.Formula) -> bool:
    """Whether a formula is false in the first state whatever is there: nothing was before it."""
    match node:
        case tree.Prefix("previously"):
            return True
        case tree.Infix("and", left, right):
            return _is_false_at_first(left) or _is_false_at_first(right)
        case tree.Infix("or", left, right):
            return _is_false_at_first(left) and _is_false_at_first(right)
    return False


def _narrow_operator(prefix: tree.Prefix, follows: str, until: int) -> Diagnostic:
    """``never a and b``, where ``never (a and b)`` is probably meant, up to a position.

    Of ``never a implies b`` that would be false: what is meant there is rather ``a and b``.
    """
    is_denial = prefix.operator == "never" and follows == "implies"
    lasts = follows in _LASTING
    way_out = f"write `{prefix.operator} (… {'and' if is_denial else follows} …)`"
    if lasts:
        way_out = _only_so_long(prefix.operator, short(prefix.operand), follows)
    return NARROW_OPERATOR.at(
        prefix.span,
        f"`{prefix.operator}` speaks of this alone, not of what `{follows}` joins to it",
        expected=f"`{prefix.operator}` binds tighter than `{follows}`",
        help=f"{way_out}, or put parentheses around this",
        severity="warning",
        fix=None if is_denial or lasts else parentheses_behind(prefix, until),
    )


def _leaves_reach_open(diagnostic: Diagnostic) -> bool:
    """Whether it is about an operator before `until` or its kin, which has no fix."""
    return diagnostic.code == NARROW_OPERATOR.code and "says how long" in diagnostic.help


def _only_so_long(operator: str, what: str, follows: str) -> str:
    """How ``never a until b`` is written, which would forbid `b`, too, with parentheses around."""
    no = "not " if operator == "never" else ""
    either = f"`{no}{what} {follows} …`"
    if follows == "until":
        either += f", or `{no}{what} weak until …` if that need not come"
    return f"`{follows}` says how long: write {either}"


def _two_readings(
    node: tree.Infix, before: tree.Infix | None, behind: tree.Infix | None
) -> Diagnostic:
    """``a until b and c``, with what is joined to its front or its end, or both."""
    start, end = node.span.start, node.span.end
    operator = _sign(node) + (node.bound.span.text if node.bound else "")
    left, right = _operand_text(node.left), _operand_text(node.right)
    now, other, other_end = f"({left} {operator} {right})", left, right
    if before is not None:
        start, ahead = before.span.start, f"{_operand_text(before.left)} {_sign(before)}"
        now, other = f"{ahead} {now}", f"({ahead} {left})"
    if behind is not None:
        end, rest = behind.span.end, f"{_sign(behind)} {_operand_text(behind.right)}"
        now, other_end = f"{now} {rest}", f"({right} {rest})"
    later = f"{other} {operator} {other_end}"
    readings = () if "…" in now + later else (now, later)
    (join, *_) = [infix.operator for infix in (behind, before) if infix is not None]
    return TWO_READINGS.at(
        Span(node.span.source, start, end),
        f"`{join}` beside `{node.operator}` can be read in two ways",
        expected=f"this means `{now}`",
        help=offering(f"write the one you mean: `{now}`, or `{later}`", *readings),
        severity="warning",
    )


def _sign(node: tree.Infix) -> str:
    return " ".join((node.sign or node.operator).split())


def _operand_text(node: tree.Formula) -> str:
    """A short operand on one line, in its parentheses if it has some."""
    grouped = isinstance(node, tree.Grouping) and node.grouped
    return f"({short(node)})" if grouped else short(node)
