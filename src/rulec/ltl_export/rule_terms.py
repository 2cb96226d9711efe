"""The terms of a rule: its formula, facts about propositions, history variables."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

from rulec.automata.alphabet import knowledge, propositions_of, reads_of
from rulec.automata.axiom_groups import axiom_groups
from rulec.automata.compiler import RuleFormula
from rulec.automata.tables import MOST_STEPS_AHEAD
from rulec.diagnostics import RulecError
from rulec.diagnostics.code import Code
from rulec.logic import formula as ltl
from rulec.logic.bounds import total_bound
from rulec.logic.fold import fold_constants
from rulec.logic.past_registers import definition, eliminate_past
from rulec.logic.printing import formula_text
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.spoken_words import spoken_formula
from rulec.logic.sentences.wording import atom_clause, comparison_clause
from rulec.ltl_export.ltl_terms import Term, Terms, conjunction, size_of
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.rulebook.rules.axiom_instances import axiom_instances

MOST_SIGNS = 2_000_000
"""The greatest number of characters of a rule's text."""

_SIGNS = {"<=": "le", ">=": "ge", "!=": "ne", "<": "lt", ">": "gt", "=": "eq", "+": "plus"}
_KEYWORDS = """
    true false TRUE FALSE xor xnor G F X U V W R M Y Z H O S T A E AG AF AX EG EF EX alive
    in mod next init self union word abs max min count bool signed unsigned real integer boolean
    array of case esac MODULE VAR DEFINE LTLSPEC NAME P filter func label const process word1
    extend resize sizeof uwconst swconst toint floor sin cos tan exp ln pi time clock
    MDEFINE CONSTANTS IVAR FROZENVAR INIT TRANS INVAR SPEC CTLSPEC PSLSPEC COMPUTE INVARSPEC
    FAIRNESS JUSTICE COMPASSION ISA ASSIGN CONSTRAINT IN MIN MAX MIRROR PRED PREDICATES BU EBF ABF
    EBG ABG
    READ WRITE CONSTARRAY URGENT
    """
_RESERVED = frozenset(_KEYWORDS.split())
"""Keywords of the tools, and their operators."""


@dataclass(frozen=True, slots=True)
class Proposition:
    """The meaning of a tool's proposition: in a rulebook's notation, and in English.

    A history proposition stands for what held one instant ago.
    """

    name: str
    formula: str
    says: str = ""


@dataclass(frozen=True, slots=True)
class RuleTerms:
    """A rule for other tools.

    ``facts`` hold in every possible word. ``history`` defines the propositions of the ``past``:
    false at first, then the value of their formula one instant before. A possible word keeps the
    rule if ``formula`` holds with the history that this word determines.
    """

    rule: Rule
    step_s: Fraction | None
    formula: Term
    facts: Term
    history: Term
    propositions: tuple[Proposition, ...]
    past: tuple[Proposition, ...]


def rule_terms(rulebook: Rulebook, lowered: RuleFormula, phrases: Mapping[str, str]) -> RuleTerms:
    """The terms of a rule. Raises RulecError R0754 if they would be too long."""
    rule, formula = lowered.rule, lowered.formula
    if total_bound(formula) > MOST_STEPS_AHEAD:
        raise too_long(rule, f"one of its bounds has more than {MOST_STEPS_AHEAD:,} steps")
    vocabulary = rulebook.vocabulary
    own = propositions_of(formula)
    groups = axiom_groups(
        own, axiom_instances(rule.variables, rulebook.axioms, vocabulary), vocabulary
    )
    about = {ltl.subject_of(atom) for atom in own}
    known = [knowledge(reads_of(formula, vocabulary), own), *(group.known for group in groups)]
    # Facts about other propositions only are not the rule's concern.
    facts = [
        fold_constants(fact)
        for fact in known
        if any(ltl.subject_of(atom) in about for atom in propositions_of(fact))
    ]
    spoken_of = dict.fromkeys([*own, *(atom for fact in facts for atom in propositions_of(fact))])
    # Past operators become propositions for what held one instant ago.
    past = eliminate_past(formula, registers=False)
    names: dict[ltl.Proposition, str] = {}
    for atom in [*spoken_of, *(memory.atom for memory in past.memories)]:
        names[atom] = fresh_identifier(str(atom), set(names.values()))
    terms = Terms(names, "alive" if rulebook.semantics == "finite" else None)
    known_as = tuple(
        Proposition(names[proposition], str(proposition), _in_words(proposition, phrases))
        for proposition in spoken_of
    )
    ago = tuple(
        Proposition(names[memory.atom], formula_text(fold_constants(memory.formula)))
        for memory in past.memories
    )
    defined = (terms.term_of(fold_constants(definition(memory))) for memory in past.memories)
    of_rule = RuleTerms(
        rule,
        lowered.step_s,
        formula=terms.term_of(fold_constants(past.present)),
        facts=conjunction((terms.lasting, *(terms.always(fact) for fact in facts))),
        history=conjunction(tuple(defined)),
        propositions=known_as,
        past=ago,
    )
    sizes = map(size_of, (of_rule.formula, of_rule.facts, of_rule.history))
    if sum(sizes) > MOST_SIGNS:
        raise too_long(rule, f"its text would have more than {MOST_SIGNS:,} signs")
    return of_rule


def fresh_identifier(text: str, taken: set[str]) -> str:
    """``beside(v)`` becomes ``beside_v``, ``speed <= 50 km/h`` becomes ``speed_le_50_km_h``."""
    spelt = re.sub("|".join(map(re.escape, _SIGNS)), lambda sign: f" {_SIGNS[sign[0]]} ", text)
    name = re.sub(r"[^A-Za-z0-9]+", "_", spelt.replace("_", " ")).strip("_")[:60].rstrip("_")
    if not name or not name[0].isalpha() or name in _RESERVED:
        name = f"p_{name}"
    several = (f"{name}_{number}" for number in count(2))
    return name if name not in taken else next(each for each in several if each not in taken)


def _in_words(proposition: ltl.Proposition, phrases: Mapping[str, str]) -> str:
    spoken = spoken_formula(proposition, phrases)
    if isinstance(spoken, ltl.Comparison):
        return comparison_clause(spoken, ENGLISH, holds=True)
    assert isinstance(spoken, ltl.Atom)
    return atom_clause(spoken, ENGLISH, holds=True)


TOO_LONG_IN_LTL = Code("R0754")


def too_long(rule: Rule, why: str) -> RulecError:
    """The error (R0754) about a rule."""
    return TOO_LONG_IN_LTL.error(
        rule.span,
        f"rule `{rule.name}` is too long in LTL: {why}",
        help="use a larger step, or its automaton, which is small: leave out `--emit ltl`",
    )
