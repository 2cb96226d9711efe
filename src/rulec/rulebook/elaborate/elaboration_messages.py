"""Messages about a number, truth value or object where another kind is needed."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.diagnostics import Diagnostic, Fix, Label, Span, any_of, nearest_name
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, offering, write
from rulec.logic.formula import Formula
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.arithmetic.size_messages import FORMULA_TOO_LARGE
from rulec.rulebook.elaborate.scope import SIDES, Scope
from rulec.rulebook.names.atom_messages import NOT_BOOLEAN, NUMBER_OR_FORMULA
from rulec.syntax import tree
from rulec.syntax.messages.larger_edits import operator_outside
from rulec.syntax.messages.literal_values import NUMBER_TOO_LARGE
from rulec.syntax.tree_printer import print_formula
from rulec.vocabulary import Enumeration
from rulec.vocabulary.dimensions import TIME, Dimension
from rulec.vocabulary.units import hour_in_another_language

POINT_OF_THOUSANDS = Code("R0365")

OPERATOR_BEFORE_THEN = Code("R0311")

DIVIDED_BY_ZERO = Code("R0314")

MISPLACED_TEMPORAL_OPERATOR = Code("R0319")


def kind_of(dimension: Dimension | None) -> str:
    name = "number" if dimension is None else dimension.name
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def short(node: tree.Formula) -> str:
    text = print_formula(node, "written")
    return text if len(text) <= 40 else f"{text[:39]}…"


def hour_meant(number: tree.NumberLiteral) -> Help:
    """Help for a number in km/h with another language's hour, such as `km/t`; else empty."""
    end = number.span.end
    unit = Span(number.span.source, end - len(number.unit), end)
    way_out = hour_in_another_language(number.unit)
    return offering(way_out, write("km/h", unit)) if way_out else ""


def what_of(operand: object) -> str:
    if isinstance(operand, NumberByCases):
        return kind_of(operand.dimension)
    return "true or false" if isinstance(operand, Formula) else "an object"


def origins(scope: Scope, *nodes: tree.Formula) -> tuple[Label, ...]:
    return tuple(dict.fromkeys(label for node in nodes for label in _origins(node, scope)))


def _origins(node: tree.Formula, scope: Scope) -> Iterator[Label]:
    match node:
        case tree.AtomUse(name):
            overlay = scope.constants.overlay
            changed = overlay.changed_at.get(name.text) or overlay.declared_at.get(name.text)
            span = scope.symbols.spans.get(name.text) or (changed.span if changed else None)
            if span is not None:
                yield Label(span.place, f"`{name.text}` is declared here")
        case tree.Arithmetic(_, left, right):
            yield from _origins(left, scope)
            yield from _origins(right, scope)
        case tree.Minus(operand):
            yield from _origins(operand, scope)


def number_for_truth(node: tree.Formula, number: NumberByCases, scope: Scope) -> Diagnostic:
    unit = scope.symbols.unit_text(node.name.text) if isinstance(node, tree.AtomUse) else ""
    inside = f" (in {unit})" if unit else ""
    way_out = "how long is written as a bound, such as `historically[<= 3 s] p`"
    test = f"< 5 {unit}" if unit else ">= 1" if isinstance(node, tree.Aggregate) else "< …"
    if not isinstance(node, tree.NumberLiteral) or number.dimension != TIME:
        way_out = f"compare it, such as `{short(node)} {test}`"
    return NUMBER_OR_FORMULA.at(
        node.span,
        f"`{short(node)}` is {kind_of(number.dimension)}{inside} and cannot be true or false",
        expected="expected something that is true or false",
        help=way_out,
        labels=origins(scope, node),
    )


def object_for_truth(node: tree.Formula, scope: Scope) -> Diagnostic:
    example = next(iter(scope.symbols.about_one()), "p")
    return NOT_BOOLEAN.at(
        node.span,
        f"`{short(node)}` is an object and cannot be true or false",
        expected="expected a signal or a value",
        help=f"say something about it, such as `{example}({short(node)})`",
    )


_COMPARED = "only numbers are compared, and whether two objects are the same one"


def no_number(
    node: tree.Formula, operand: object, scope: Scope, around: tree.Compare | None
) -> Diagnostic:
    if around is None:
        expected = "expected a number"
        way_out = "a number is a quantity, a parameter, a count, or such as `1.5 m`"
    else:
        expected = "expected a number, as it is compared"
        way_out = _COMPARED
        if isinstance(node, tree.AtomUse) and what_of(operand) == "true or false":
            way_out = f"what is true or false is written alone, such as `{short(node)}`"
    return NUMBER_OR_FORMULA.at(
        node.span,
        f"`{short(node)}` is {what_of(operand)}, not a number",
        expected=expected,
        help=way_out,
        labels=origins(scope, node),
    )


def values_compared(
    node: tree.Compare, side: tree.AtomUse, item: Enumeration, compared: tree.Formula, scope: Scope
) -> Diagnostic:
    """``surface = crossing``: a value of an enumeration is an atom by itself."""
    name = side.name.text
    value = compared.name.text if isinstance(compared, tree.AtomUse) else ""
    relative = value in SIDES and set(SIDES[value].values()) <= set(item.values)
    objects = ", ".join(argument.text for argument in side.arguments)
    arguments = f"({objects})" if objects else ""
    no = "not " if node.relation == "!=" else ""
    if value in item.values or relative:
        alone = f"{no}{value}{arguments}"
        way_out = offering(f"write `{alone}`", alone)
    elif near := nearest_name(value, item.values):
        way_out = offering(f"did you mean `{near}`?", f"{no}{near}{arguments}")
    else:
        ways = any_of([f"`{known}{arguments}`" for known in item.values])
        is_number = isinstance(compared, tree.NumberLiteral)
        values = () if is_number else (f"{no}{known}{arguments}" for known in item.values)
        way_out = offering(f"write {ways}", *values)
    return NOT_BOOLEAN.at(
        node.span,
        f"`{name}` is not compared: each of its values is true or false by itself",
        expected="expected the value alone",
        help=way_out,
        labels=(Label(scope.symbols.spans[name].place, f"`{name}` is declared here"),),
    )


def truths_compared(node: tree.Compare, scope: Scope) -> Diagnostic:
    if isinstance(node.right, tree.TruthLiteral) and isinstance(node.left, tree.AtomUse):
        holds = node.right.value == (node.relation == "=")
        alone = f"{'' if holds else 'not '}{short(node.left)}"
        way_out: Help = offering(f"write `{alone}`", *(() if "…" in alone else (alone,)))
    elif node.relation in ("=", "!="):
        way_out = f"formulas are compared by `{'iff' if node.relation == '=' else 'xor'}`"
    else:
        way_out = _COMPARED
    return NUMBER_OR_FORMULA.at(
        node.span,
        f"both sides of `{node.relation}` are true or false, not numbers",
        expected="expected two numbers",
        help=way_out,
        labels=origins(scope, node.left, node.right),
    )


def two_kinds(node: tree.Conditional, value: object, otherwise: object, scope: Scope) -> Diagnostic:
    """``number if condition else truth``."""
    way_out = "both sides of `if … else` are numbers, or both are true or false"
    if isinstance(node.value, tree.Compare) and isinstance(otherwise, NumberByCases):
        number = (
            f"{short(node.value.right)} if {short(node.condition)} else {short(node.otherwise)}"
        )
        way_out = f"put parentheses around what is one number: `({number})`"
    return NUMBER_OR_FORMULA.at(
        node.otherwise.span,
        f"`{short(node.value)}` is {what_of(value)} and `{short(node.otherwise)}` "
        f"{what_of(otherwise)}: one cannot replace the other",
        expected=f"this is {what_of(otherwise)}",
        help=way_out,
        labels=origins(scope, node.value),
    )


def point_of_thousands(node: tree.NumberLiteral) -> Diagnostic:
    few, many = node.text.rstrip("0").rstrip("."), node.text.replace(".", "")
    few, many = (f"{text} {node.unit}".strip() for text in (few, many))
    return POINT_OF_THOUSANDS.at(
        node.span,
        f"`{short(node)}` is {few}, and may be meant for {many}",
        expected="the point parts decimals, not thousands",
        help="write it without the last 0, or without the point",
        severity="warning",
    )


def too_long(node: tree.NumberLiteral) -> Diagnostic:
    return NUMBER_TOO_LARGE.at(
        node.span,
        "this number has too many digits",
        help="write at most 400 digits, and no exponent beyond 400",
    )


def divided_by_zero(node: tree.Arithmetic) -> Diagnostic:
    return DIVIDED_BY_ZERO.at(
        node.right.span,
        f"`{short(node)}` divides by 0",
        expected="expected a number other than 0",
        help="check the divisor",
    )


def too_many_cases(node: tree.Formula) -> Diagnostic:
    return FORMULA_TOO_LARGE.at(
        node.span,
        f"`{short(node)}` becomes too large, with parameters and conditions put in",
        help="use fewer numbers that have an `if`, or say it in several comparisons",
    )


def objects_have_no_order(node: tree.Compare) -> Diagnostic:
    """``v < w`` of objects."""
    return NUMBER_OR_FORMULA.at(
        node.span,
        f"`{short(node.left)}` and `{short(node.right)}` are objects, which have no order",
        expected="expected `=` or `!=` between objects",
        help="compare numbers of theirs",
    )


def temporal_in_count(node: tree.Prefix | tree.Infix) -> Diagnostic:
    return MISPLACED_TEMPORAL_OPERATOR.at(
        node.span,
        f"`{node.operator}` cannot be used here: counts, parameters and facts speak of one state",
        expected="expected a formula about one state",
        help=offering(
            "put the operator around it, or give the rule a variable",
            *operator_outside(node.span),
        ),
    )


def endless_phase(phase: tree.Prefix, sequence: tree.Infix) -> Diagnostic:
    """``never p then q``, where ``never (p then q)`` is probably meant."""
    return OPERATOR_BEFORE_THEN.at(
        phase.span,
        f"`{phase.operator}` speaks of this phase alone, not of the whole sequence",
        expected=f"`{phase.operator}` binds tighter than `then`",
        help=f"write `{phase.operator} (… then …)` to speak of the sequence",
        severity="warning",
        fix=parentheses_behind(phase, sequence.span.end),
    )


def parentheses_behind(prefix: tree.Prefix, until: int) -> Fix:
    """The fix that puts an operator's intended operand, up to a position, in parentheses."""
    source, start = prefix.span.source, prefix.span.start
    behind = start + len(prefix.sign) if prefix.bound is None else prefix.bound.span.end
    head, inside = source.text[start:behind], source.text[behind:until].strip()
    return Fix(Span(source, start, until).place, f"{head} ({inside})")
