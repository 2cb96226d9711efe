"""What is to say of rules that cannot be compiled."""

from __future__ import annotations

from rulec.automata.axiom_instances import AxiomInstance
from rulec.automata.spot_worker import Failed
from rulec.diagnostics import Diagnostic, Label
from rulec.diagnostics.diagnostic import at
from rulec.logic.bounds import operations_of
from rulec.logic.printing import in_words
from rulec.rulebook.model import Rule


def no_machine(rule: Rule, failed: Failed | None, cpu_limit_s: int) -> Diagnostic:
    """R0401, R0402 or R0409; ``failed`` is None if it was the end of Spot's process.

    Raises RuntimeError for a bug.
    """
    place = at(rule.span)
    if failed is not None and failed.why == "bug":
        raise RuntimeError(f"while compiling rule {rule.name}:\n{failed.traceback}")
    if failed is not None and failed.why == "check":
        return Diagnostic(
            "R0402",
            f"the automaton of rule `{rule.name}` is not equivalent to its formula",
            place,
            help="this is a bug in Spot or rulec, not in the rulebook: please report the rule",
        )
    if failed is not None and failed.why == "facts":
        return _contradiction(rule, failed.contradiction)
    why = (
        "it reads too many signals, enumerations and numbers at once"
        if failed is not None and failed.why == "letters"
        else f"it takes more than {cpu_limit_s} s or 2 GiB to build"
    )
    return Diagnostic(
        "R0401",
        f"the automaton of rule `{rule.name}` would be too large: {why}",
        place,
        help="say each of its demands in a rule of its own: rules joined by `and` multiply, "
        "rules beside each other do not" + _bounds_help(rule),
    )


def _contradiction(rule: Rule, instances: tuple[AxiomInstance, ...]) -> Diagnostic:
    axioms = list(dict.fromkeys(one.fact for one in instances))
    first, *others = axioms
    said = ", ".join(f"`{in_words(one.formula)}`" for one in axioms)
    types = {variable.name: variable.type for variable in rule.variables}
    who = sorted({f"a `{types[name]}`" for one in instances for name in one.variables})
    return Diagnostic(
        "R0409",
        f"these facts contradict each other: {said}" if others else f"{said} can never be a fact",
        at(first.span),
        expected="no state can be so",
        help="a fact is what holds in every state: correct or remove one of them"
        if others
        else "a fact is what holds in every state: correct or remove it",
        labels=tuple(Label(one.span.place, "and so") for one in others if one.span is not None),
        notes=(f"there would be no state with {' and '.join(who)}",) if who else (),
    )


def _bounds_help(rule: Rule) -> str:
    # Seconds or steps, it is the number of them that makes it large.
    has_bounds = any(one.bound is not None for one in operations_of(rule.formula))
    return "; each bound takes as many states as it has steps" if has_bounds else ""


def no_spot(problem: str) -> Diagnostic:
    """R0403: Spot cannot be loaded."""
    return Diagnostic(
        "R0403",
        f"Spot, which turns rules into automata, cannot be loaded: {problem}",
        help="`pip install spottl` on Linux x86-64 with glibc 2.34 or later, "
        "`conda install -c conda-forge spot` elsewhere; a compiled rulebook runs without Spot",
    )
