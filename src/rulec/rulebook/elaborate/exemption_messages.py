"""What is said about exceptions whose rule guards no stretch, or too many of them."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, Label, Span
from rulec.rulebook.elaborate.rule_messages import FORMULA_TOO_LARGE, UNFITTING_SCOPE
from rulec.syntax import tree


def no_stretch(unless: tree.Unless, scope: str, require: Span | None) -> Diagnostic:
    """A scope of an exception to a formula that guards no stretch of time."""
    written = f"`{scope}`" if unless.scope else "this exception"
    labels = () if require is None else (Label(require.place, "this is what the rule requires"),)
    return UNFITTING_SCOPE.at(
        unless.span,
        f"{written} speaks of a sequence, and the rule guards none: it does not begin with "
        "`never` or `always`",
        expected="expected `initially`",
        help="write `initially`, which looks at the first state, or say what must `never` happen",
        labels=labels,
    )


def bounded_phase(unless: tree.Unless) -> Diagnostic:
    """``throughout`` phases whose length is bounded."""
    return UNFITTING_SCOPE.at(
        unless.span,
        "an exception cannot hold `throughout` phases whose length is bounded",
        expected="expected another scope",
        help="write `at start`, `at end` or `at some point`, or leave the bounds of `then` out",
    )


def too_many_exceptions(unless: tree.Unless) -> Diagnostic:
    """More exceptions that hold throughout than a formula can take."""
    return FORMULA_TOO_LARGE.at(
        unless.span,
        "with this one, too many exceptions of the rule have to hold `throughout` its phases: "
        "each multiplies the formula",
        help="join some of them by `or` in one `unless`, if one of them may follow the other",
    )
