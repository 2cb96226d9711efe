"""Messages about rules that cannot be compiled."""

from __future__ import annotations

from fractions import Fraction

from rulec.automata.bundle.bundle_messages import AUTOMATON_TOO_LARGE
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.compiler_jobs import MOST_OPERATORS, Failed
from rulec.automata.tables import MOST_EDGES, MOST_STATES
from rulec.automata.worker.confinement import Confinement
from rulec.diagnostics import Diagnostic, SourceLocation
from rulec.diagnostics.code import Code
from rulec.logic.bounds import operations_of
from rulec.logic.printing import number_in_words
from rulec.resource_limits import COMPILING, BudgetSpentError
from rulec.rulebook.rulebook_model import Rule, provision_note
from rulec.rulebook.rules.axiom_messages import contradictory_facts

FAILED_CHECK = Code("R0402")

COMPILERS_DISAGREE = Code("R0417")

SPOT_MISSING = Code("R0403")

SPOT_NOT_CONFINED = Code("R0415")

_GET_SPOT = (
    "`pip install spottl` on Linux x86-64 with glibc 2.34 or later, "
    "`conda install -c conda-forge spot` elsewhere; a compiled rulebook runs without Spot"
)


def no_machine(
    rule: Rule | CompiledRule,
    place: SourceLocation | None,
    failed: Failed | None,
    step_s: Fraction | None = None,
) -> Diagnostic:
    """The diagnostic (R0401 to R0403, R0409) for a failure; None: Spot's process died (R0401).

    ``step_s`` is the step in which the rule's bounds were counted. Raises RuntimeError for a bug.
    """
    why = "it takes more than 2 GiB to build"
    match failed:
        case Failed("bug", traceback):
            raise RuntimeError(f"while compiling rule {rule.name}:\n{traceback}")
        case Failed("check"):
            return FAILED_CHECK.at(
                place,
                f"the automaton of rule `{rule.name}` is not equivalent to its formula",
                help="this is a bug in Spot or rulec, not in the rulebook: please report the rule",
                notes=_provision(rule),
            )
        case Failed("facts", contradiction=instances):
            return contradictory_facts(instances, rule.variables)
        case Failed("reach"):
            return SPOT_MISSING.at(
                place,
                f"rule `{rule.name}` needs Spot: it nests unbounded obligations, or its past "
                "depends on the future",
                help=_GET_SPOT,
                notes=_provision(rule),
            )
        case Failed("letters"):
            why = "it reads too many signals, enumerations and numbers at once"
        case Failed("size"):
            why = (
                f"it gets more than {MOST_STATES:,} states, {MOST_EDGES:,} edges, or "
                f"{MOST_OPERATORS:,} operators with each `then` written out"
            )
        case Failed("sets"):
            why = "it needs more acceptance sets than Spot supports"
        case Failed("steps"):
            why = "one of its bounds has more than 10,000 steps"
    # Whether a bound is given in seconds or steps, the number of its steps makes it large.
    n_bounds = sum(operation.bound is not None for operation in operations_of(rule.formula))
    has_bounds = n_bounds > 0
    more = "; each bound takes as many states as it has steps" if has_bounds else ""
    if has_bounds and step_s is not None:
        # A user can resample a recording to longer steps, but cannot change the law.
        why += f" for steps of {number_in_words(step_s)} s"
        more += "; longer steps mean fewer: for a recording, every fifth state may be enough"
    help_text = (
        "write a separate rule for each of its demands: automata of demands joined by `and` "
        "multiply, those of separate rules do not" + more
    )
    if n_bounds == 1 or failed == Failed("steps"):
        # Its demands are not what multiplies.
        help_text = (
            "give it a longer step or a shorter bound: each bound takes as many states as it has "
            "steps; for a recording, every fifth state may be enough"
        )
    return AUTOMATON_TOO_LARGE.at(
        place,
        f"the automaton of rule `{rule.name}` would be too large: {why}",
        help=help_text,
        notes=_provision(rule),
    )


def no_time(name: str, place: SourceLocation | None, step_s: Fraction | None) -> BudgetSpentError:
    """The error (R0718) for a rulebook whose time is used up when this rule is compiled."""
    whose = f"up to rule `{name}`"
    if step_s is not None:
        whose += f" for steps of {number_in_words(step_s)} s"
    return COMPILING.spent(place, whose)


def _provision(rule: Rule | CompiledRule) -> tuple[str, ...]:
    return (provision_note(rule.name, rule.cite),) if rule.cite else ()


def no_spot(problem: str) -> Diagnostic:
    """R0403: Spot cannot be loaded."""
    return SPOT_MISSING.at(
        None,
        f"Spot, which turns rules into automata, cannot be loaded: {problem}",
        help=f"{_GET_SPOT}; unset RULEC_COMPILER to compile without it",
    )


def not_confined(confined: Confinement) -> Diagnostic:
    """R0415: the worker can do more than its task needs."""
    left = {"write files (no Landlock)": confined.files}
    left["connect and run programs (no seccomp)"] = confined.connections
    able = " and ".join(deed for deed, is_held in left.items() if not is_held)
    return SPOT_NOT_CONFINED.at(
        None,
        f"RULEC_REQUIRE_CONFINED is set, but Spot's process could {able}",
        help="compile on Linux from 5.13, on x86-64 or ARM64, outside of containers that forbid "
        "Landlock; judge elsewhere with the rulebook compiled there; or unset "
        "RULEC_REQUIRE_CONFINED",
    )
