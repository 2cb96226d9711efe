"""Messages about how much of a formula, and of a trace, an operator of time speaks of."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, Fix, Span
from rulec.diagnostics.code import Code
from rulec.syntax import tree

FIRST_STATE_ONLY = Code(
    "R0360",
    title="a rule requires something of the first state only",
    why="A formula speaks of the state in which a trace begins, unless an operator of time such as "
    "`always` or `never` says otherwise: who starts slowly keeps `require speed <= limit`. "
    "`rulec check --fix` puts `always` before it. Where the first state is meant, say so: "
    "`always (previously true or p)` asks for `p` in the only state that has none before it.",
    bad="rulebook example\nquantity speed in km/h default 0\n"
    "hard rule r { require speed <= 50 km/h }\n",
    good="rulebook example\nquantity speed in km/h default 0\n"
    "hard rule r { require always (speed <= 50 km/h) }\n",
)

NARROW_OPERATOR = Code(
    "R0361",
    title="an operator of time speaks of less than what stands behind it",
    why="The operators `never`, `always` and `eventually` bind tighter than `and`, `or` and "
    "`implies`: `never a and b` is `(never a) and b`, which asks for `b` in the first state alone. "
    "`rulec check --fix` puts what follows into parentheses; whoever means the other reading puts "
    "these around the operator, as `rulec fmt` does, so that it can be seen.",
    bad="rulebook example\nsignal a, b\nhard rule r { require always a implies b }\n",
    good="rulebook example\nsignal a, b\nhard rule r { require always (a implies b) }\n",
)


def first_state_only(node: tree.Formula, reads: str, *, alone: bool) -> Diagnostic:
    """A requirement, or a part of one if not ``alone``, without an operator of time."""
    text = node.span.text
    bare = isinstance(node, tree.AtomUse | tree.Aggregate)
    if isinstance(node, tree.Prefix):
        # The only operator that is not one of time is `not`.
        wider = f"never {text[len(node.sign) :].lstrip()}"
    else:
        wider = f"always {text}" if bare else f"always ({text})"
    what = "the rule asks" if alone else "this part of the rule asks"
    return FIRST_STATE_ONLY.at(
        node.span,
        f"{what} for `{reads}` in the first state only",
        expected="nothing here speaks of later states",
        help=f"write `{wider if len(wider) <= 60 else f'{wider[:59]}…'}` to speak of all states",
        severity="warning",
        fix=Fix(node.span.place, wider),
    )


def narrow_operator(prefix: tree.Prefix, follows: str, until: int) -> Diagnostic:
    """``never a and b``, where ``never (a and b)`` is probably meant, up to a position."""
    span = prefix.span
    behind = span.start + len(prefix.sign) if prefix.bound is None else prefix.bound.span.end
    whole = Span(span.source, span.start, until)
    head = Span(span.source, span.start, behind).text
    inside = Span(span.source, behind, until).text.strip()
    return NARROW_OPERATOR.at(
        span,
        f"`{prefix.operator}` speaks of this alone, not of what `{follows}` joins to it",
        expected=f"`{prefix.operator}` binds tighter than `{follows}`",
        help=f"write `{prefix.operator} (… {follows} …)`, or put parentheses around this",
        severity="warning",
        fix=Fix(whole.place, f"{head} ({inside})"),
    )
