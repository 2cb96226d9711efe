"""Rulebooks made in memory for tests of everything behind the language."""

from hypothesis import reject

from rulec.automata import compiler
from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRulebook
from rulec.automata.prefix_machines import prefix_machines
from rulec.diagnostics.diagnostic import at
from rulec.logic.formula import Atom, Binary, BinaryOperator, Formula, Unary, UnaryOperator
from rulec.rulebook.rulebook_model import Rule, Rulebook, Variable
from rulec.rulebook.rules.implied_signals import with_implied
from support.generators.random_formulas import VOCABULARY

P, Q = Atom("p"), Atom("q")


def near(variable: str) -> Atom:
    return Atom("place", (variable,), "near")


def far(variable: str) -> Atom:
    return Atom("place", (variable,), "far")


def no(formula: Formula) -> Formula:
    return Unary(UnaryOperator.NOT, formula)


def always(formula: Formula) -> Formula:
    return Unary(UnaryOperator.ALWAYS, formula)


def eventually(formula: Formula) -> Formula:
    return Unary(UnaryOperator.EVENTUALLY, formula)


def both(left: Formula, right: Formula) -> Formula:
    return Binary(BinaryOperator.AND, left, right)


def implies(left: Formula, right: Formula) -> Formula:
    return Binary(BinaryOperator.IMPLIES, left, right)


def rule(name, formula, *variables, strength="hard"):
    """A rule over variables given as ``"x: thing"``."""
    bound = (Variable(*text.split(": ")) for text in variables)
    return Rule(name, strength, tuple(bound), formula, cite=f"Art. {name}")


def compile_both_ways(rulebook, step_s=None):
    """With automata as texts; the tables are those that are made with the past in registers."""
    compiled = compile_here(rulebook, step_s, with_texts=True)
    assert compiled.rules == compile_here(rulebook, step_s).rules
    return compiled


def compile_here(rulebook, step_s=None, *, with_texts=False):
    """As the compiler does, without a process of its own: for tests with many small rulebooks."""
    from rulec.automata.compiler_jobs import Failed
    from rulec.automata.worker.compiler_choice import choice
    from rulec.automata.worker.compiler_worker import chosen
    from support.asked_compilers import machine_by

    usual = chosen(choice())

    compiled = []
    for formula in compiler.lower(rulebook, step_s).rules:
        job = compiler._job(rulebook, formula, with_texts=with_texts)
        answer = machine_by(job, usual)
        if answer in (Failed("reach"), Failed("sets")):
            reject()
        compiled.append(compiler._compiled(formula.rule, formula.step_s, answer))
    return CompiledRulebook(
        rulebook.name,
        with_implied(rulebook.vocabulary, [one.formula for one in rulebook.axioms]),
        tuple(compiled),
        "",
        "",
        "",
        (),
        "",
        usual.version,
        semantics=rulebook.semantics,
        levels=rulebook.levels,
        priorities=rulebook.priorities,
        axioms=tuple(
            CompiledAxiom(one.variables, one.formula, at(one.span)) for one in rulebook.axioms
        ),
        prefixes=prefix_machines,
    )


def book(*rules):
    return Rulebook("test", VOCABULARY, rules)
