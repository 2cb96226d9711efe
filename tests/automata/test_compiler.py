"""Compiling: Spot in a process of its own, and what becomes of rules that explode."""

from dataclasses import replace
from fractions import Fraction
from functools import reduce

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rulec.automata import compiler
from rulec.automata.alphabet import names_of
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.logic.past_registers import eliminate_past
from rulec.logic.printing import formula_text
from rulec.resource_limits import in_force
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.vocabulary import Enumeration, Signal, Vocabulary
from support.builders.rulebooks import P, Q, always, book, eventually, far, implies, near, rule
from support.generators.random_formulas import formulas

pytestmark = pytest.mark.usefixtures("compiled_anew")


def signals(n):
    return Vocabulary("signals", {}, {f"s{i}": Signal(f"s{i}", (), False) for i in range(n)})


def chain(operator, formulas):
    return reduce(lambda left, right: Binary(operator, left, right), formulas)


def exploding():
    """Eight untils under exclusive or: every one of the 2^8 combinations matters."""
    atoms = [Atom(f"s{i}") for i in range(16)]
    untils = [Binary(BinaryOperator.UNTIL, *atoms[i : i + 2]) for i in range(0, 16, 2)]
    return chain(BinaryOperator.XOR, untils)


def test_a_rule_becomes_its_smallest_table():
    # always (near -> q): running, or lost. Letters: what of near, q matters: bad or not.
    compiled = compile_rulebook(book(rule("A", always(implies(near("x"), Q)), "x: thing")))
    machine = compiled.rules[0].machine
    assert [(read.name, read.size) for read in machine.reads] == [("place", 2), ("q", 2)]
    assert len(machine.successors) == 2
    assert len(machine.successors[0]) == 2
    assert machine.rejecting_sink is not None
    assert machine.accepting_sink is None
    near_without_q = 0  # digit 0 is `near`, q is false
    others = {machine.letters[letter] for letter in range(4) if letter != near_without_q}
    assert len(others) == 1
    assert machine.successors[0][machine.letters[near_without_q]] == machine.rejecting_sink


def test_exclusive_values_make_letters_and_contradictions():
    never_both = book(
        rule("A", always(Binary(BinaryOperator.AND, near("x"), far("x"))), "x: thing")
    )
    (compiled,) = compile_rulebook(never_both).rules
    assert compiled.machine.reads[0].size == 3  # near, far, and all else
    assert compiled.machine.successors == ((0,),)
    assert compiled.machine.rejecting_sink == 0


@pytest.mark.parametrize(
    "position",
    [1, *(pytest.param(at_an_end, marks=pytest.mark.long) for at_an_end in (0, 2))],
)
def test_a_rule_that_explodes_is_an_error_and_the_others_compile(position):
    vocabulary = signals(16)
    rules = [Rule(name, "hard", (), always(Atom("s0"))) for name in "AB"]
    rules.insert(position, Rule("Boom", "hard", (), exploding()))
    with pytest.raises(RulecError) as caught:
        compile_rulebook(Rulebook("test", vocabulary, tuple(rules)))
    assert [d.code for d in caught.value.diagnostics] == ["R0401"]
    assert "Boom" in caught.value.diagnostics[0].message
    assert "a separate rule" in caught.value.diagnostics[0].help


def within(low, high, unit="steps"):
    return Bound(Fraction(low), None if high is None else Fraction(high), unit)


def ago(steps):
    """What was at each of the last instants takes 2^steps states."""
    return always(implies(Q, Unary(UnaryOperator.PREVIOUSLY, P, within(steps, steps))))


@pytest.mark.parametrize(
    ("vocabulary", "formula"),
    [
        pytest.param(book().vocabulary, ago(30), id="registers"),
        pytest.param(signals(16), exploding(), marks=pytest.mark.long, id="untils"),
    ],
)
def test_two_rules_that_explode_are_two_errors(vocabulary, formula):
    rules = tuple(Rule(name, "hard", (), formula) for name in ("Boom", "Bang"))
    with pytest.raises(RulecError) as caught:
        compile_rulebook(Rulebook("test", vocabulary, rules))
    messages = [d.message for d in caught.value.diagnostics]
    assert ["Boom" in messages[0], "Bang" in messages[1], len(messages)] == [True, True, 2]


def test_too_many_letters_are_refused_without_trying():
    wide = chain(BinaryOperator.OR, [Atom(f"s{i}") for i in range(17)])
    with pytest.raises(RulecError) as caught:
        compile_rulebook(Rulebook("test", signals(17), (Rule("Wide", "hard", (), wide),)))
    assert "too many signals" in caught.value.diagnostics[0].message


def test_sixteen_signals_still_compile():
    wide = always(chain(BinaryOperator.OR, [Atom(f"s{i}") for i in range(16)]))
    (compiled,) = compile_rulebook(
        Rulebook("test", signals(16), (Rule("Wide", "hard", (), wide),))
    ).rules
    assert compiled.machine.letters.count(compiled.machine.letters[0]) == 1
    assert len(compiled.machine.letters) == 2**16


@pytest.mark.parametrize("n", [46, 150])
def test_an_enumeration_of_many_values(n):
    values = tuple(f"v{i}" for i in range(n))
    vocabulary = Vocabulary("wide", {}, {"x": Enumeration("x", (), values)})
    never_last = always(chain(BinaryOperator.OR, [Atom("x", (), v) for v in values[:-1]]))
    (compiled,) = compile_rulebook(
        Rulebook("test", vocabulary, (Rule("Wide", "hard", (), never_last),))
    ).rules
    machine = compiled.machine
    assert len(machine.letters) == n
    assert [machine.successors[0][c] == machine.rejecting_sink for c in machine.letters].index(
        True
    ) == n - 1


def test_a_rulebook_without_rules_compiles():
    assert compile_rulebook(book()).rules == ()


def test_who_asks_for_spot_where_it_is_not_is_told_the_way_out(monkeypatch):
    monkeypatch.setenv("RULEC_COMPILER", "spot")
    absent = "import sys; sys.modules['spot'] = None\n" + compiler._WORKER
    monkeypatch.setattr(compiler, "_WORKER", absent)
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", P)))
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0403"
    assert "conda" in diagnostic.help


def test_a_process_that_cannot_start_is_no_traceback(monkeypatch):
    monkeypatch.setattr(compiler, "_WORKER", "raise SystemExit(3)")
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", P)))
    assert caught.value.diagnostics[0].code == "R0403"


def checking(automaton, formula, semantics="stutter", cpu_s=None):
    """Ask whether Spot's automaton of a text is the formula's."""
    from rulec.automata.spot_bridge.spot_formulas import SpotFormulas
    from rulec.automata.spot_bridge.translation import check

    past = eliminate_past(formula)
    propositions = [*atoms_of(formula), *(one.atom for one in past.memories)]
    spot_formulas = SpotFormulas(names_of(propositions), "alive" if semantics == "finite" else None)
    translated = spot_formulas.translate(automaton, *SHAPE)
    check(translated, past.present, spot_formulas, past.memories, cpu_s)


SHAPE = ("parity", "det", "complete")


@pytest.mark.spot
@pytest.mark.parametrize("cpu_s", [None, 5])
def test_an_automaton_that_fails_its_check_is_refused(cpu_s):
    """Had Spot translated `p` as `not p`, the check would not let it pass."""
    from rulec.automata.spot_bridge import CheckError

    checking("p", P, cpu_s=cpu_s)
    # Another language, one too small, one too large; then the right one, but nondeterministic.
    for wrong in ("!p", "G p", "F p"):
        with pytest.raises(CheckError):
            checking(wrong, P, cpu_s=cpu_s)


@pytest.mark.spot
def test_a_nondeterministic_automaton_fails_its_check(monkeypatch):
    from rulec.automata.spot_bridge import CheckError

    formula = eventually(always(P))
    checking("FG p", formula)
    monkeypatch.setattr(f"{__name__}.SHAPE", ("BA",))
    with pytest.raises(CheckError):
        checking("FG p", formula)


@pytest.mark.spot
def test_a_check_that_takes_too_long_is_left_out():
    """Nothing is known then, which is no mistake; the table is still compared on random words."""
    wide = chain(BinaryOperator.XOR, [eventually(Atom(f"s{i}")) for i in range(9)])
    checking("1", wide, cpu_s=0.02)


MEMORY = '"memory 0"'
ONCE = Unary(UnaryOperator.ONCE, P)


@pytest.mark.spot
@pytest.mark.parametrize(
    ("automaton", "why"),
    [
        (f"G(q -> (Xp | {MEMORY}))", "the memory is still a proposition"),
        ("G(q -> X p)", "what was is forgotten"),
        ("G(q -> (X p | XXF p))", "what comes is taken for what was"),
        ("1", "nothing is asked for"),
    ],
)
def test_an_automaton_that_forgets_fails_its_check(automaton, why):
    """`always (q implies once next p)` is `Xp R (Xp | !q)`, and nothing else passes for it."""
    from rulec.automata.spot_bridge import CheckError

    later = Unary(UnaryOperator.ONCE, Unary(UnaryOperator.NEXT, P))
    formula = always(implies(Q, later))
    assert [one.atom.name for one in eliminate_past(formula).memories] == ["memory 0"]
    checking("Xp R (Xp | !q)", formula)
    with pytest.raises(CheckError):
        checking(automaton, formula)


@pytest.mark.spot
def test_the_check_knows_where_words_end():
    from rulec.automata.spot_bridge import CheckError

    formula = always(Unary(UnaryOperator.NEXT, P))
    ends = "alive & (alive U G!alive)"
    checking("0", formula, "finite")  # no word goes on for ever
    weak = always(Unary(UnaryOperator.WEAK_NEXT, P))
    checking(f"{ends} & XG(alive -> p)", weak, "finite")
    for wrong in ("XG(alive -> p)", f"{ends} & XG p", ends, f"{ends} & X p"):
        with pytest.raises(CheckError):
            checking(wrong, weak, "finite")


def test_a_rule_about_the_past_becomes_its_smallest_table():
    # always (q implies once near): not near yet, near once and safe, or lost.
    formula = always(implies(Q, Unary(UnaryOperator.ONCE, near("x"))))
    (compiled,) = compile_rulebook(book(rule("A", formula, "x: thing"))).rules
    machine = compiled.machine
    assert len(machine.successors) == 3
    assert None not in (machine.rejecting_sink, machine.accepting_sink)
    near_at_once = machine.letters[0]  # digit 0 is `near`, q is false
    assert machine.successors[0][near_at_once] == machine.accepting_sink
    assert 'AP: 2 "q" "near(x)"' in compiled.hoa or 'AP: 2 "near(x)" "q"' in compiled.hoa
    assert "memory" not in compiled.hoa
    assert "\nStates: 3\n" in compiled.hoa
    assert formula_text(compiled.formula) == "always (q implies once near(x))"


def test_what_was_before_takes_as_many_states_as_there_are_pasts():
    # always (q implies p three instants ago): the last three p, and lost. In the first three
    # instants there is no such p, as if it had been false.
    ago = reduce(lambda inner, _: Unary(UnaryOperator.PREVIOUSLY, inner), range(3), P)
    (compiled,) = compile_rulebook(book(rule("A", always(implies(Q, ago))))).rules
    assert len(compiled.machine.successors) == 2**3 + 1


def test_a_past_as_deep_as_a_formula_may_be():
    deep = reduce(lambda inner, _: Unary(UnaryOperator.ONCE, inner), range(198), P)
    (deepest, plain) = compile_rulebook(
        book(rule("A", always(implies(Q, deep))), rule("B", always(implies(Q, ONCE))))
    ).rules
    assert deepest.machine == plain.machine


@pytest.mark.spot
def test_phases_in_phases_that_explode_are_an_error():
    """On the left a sequence is said twice, and what stands in it four times."""
    deep = reduce(lambda inner, _: Binary(BinaryOperator.THEN, inner, Q), range(99), P)
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", deep)))
    assert [one.code for one in caught.value.diagnostics] == ["R0401"]


@pytest.mark.spot
def test_more_acceptance_sets_than_spot_has_are_an_error():
    """Whether it will end well, six steps on, is guessed at every instant before."""
    well = Unary(UnaryOperator.NEXT, Unary(UnaryOperator.EVENTUALLY, P), within(6, 6))
    ends = Binary(BinaryOperator.UNTIL, Q, Binary(BinaryOperator.AND, far("x"), well))
    with pytest.raises(RulecError, match="acceptance sets") as caught:
        compile_rulebook(book(rule("A", Binary(BinaryOperator.SINCE, near("x"), ends), "x: thing")))
    assert [one.code for one in caught.value.diagnostics] == ["R0401"]


def test_a_past_that_explodes_is_an_error():
    """Which of 16 signals there have been, told apart at every instant."""
    pasts = [Unary(UnaryOperator.ONCE, Atom(f"s{i}")) for i in range(16)]
    rules = (Rule("Boom", "hard", (), always(chain(BinaryOperator.XOR, pasts))),)
    with pytest.raises(RulecError) as caught:
        compile_rulebook(Rulebook("test", signals(16), rules))
    assert [one.code for one in caught.value.diagnostics] == ["R0401"]


@pytest.mark.spot
def test_a_failed_check_is_an_error_of_its_own(monkeypatch):
    failing = """
from rulec.automata.spot_bridge import CheckError, translation
from rulec.automata.worker import job_answers
def fail(*_, **__): raise CheckError
def unproved(*_): raise job_answers.UnprovableError("too long")
job_answers._prove, translation.check = unproved, fail
main(confined, choice)
"""
    worker = compiler._WORKER.replace("\nmain(confined, choice)\n", failing)
    assert worker != compiler._WORKER
    monkeypatch.setattr(compiler, "_WORKER", worker)
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", P), rule("B", Q)))
    assert [one.code for one in caught.value.diagnostics] == ["R0402", "R0402"]


@pytest.mark.spot
def test_what_nobody_thought_of_is_a_bug_with_a_traceback(monkeypatch):
    worker = compiler._WORKER.replace(
        "\nmain(confined, choice)\n",
        "\nfrom rulec.automata.spot_bridge import translation"
        "\ntranslation.check = None\nmain(confined, choice)\n",
    )
    monkeypatch.setattr(compiler, "_WORKER", worker)
    with pytest.raises(RuntimeError, match="while compiling rule A"):
        compile_rulebook(book(rule("A", P)))


def test_a_table_that_forgets_is_an_error_too(monkeypatch):
    """Where Spot has not compared the whole: here a register that forgets too soon."""
    forgetting = """
from rulec.logic.past_registers import Register
after = Register.after
Register.after = lambda self, state, left, right: after(self, state, left, right) & 0b111
main(confined, choice)
"""
    monkeypatch.setattr(
        compiler, "_WORKER", compiler._WORKER.replace("\nmain(confined, choice)\n", forgetting)
    )
    short, long = (always(implies(Q, Unary(UnaryOperator.ONCE, P, within(0, n)))) for n in (2, 3))
    assert compile_rulebook(book(rule("A", short))).rules
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", long)))
    assert [one.code for one in caught.value.diagnostics] == ["R0402"]


def test_a_hundred_steps_make_a_hundred_states():
    # Nothing seen, or p up to 100 steps ago; lost.
    formula = always(implies(Unary(UnaryOperator.ONCE, P, within(0, 100)), Q))
    (compiled,) = compile_rulebook(book(rule("A", formula))).rules
    assert len(compiled.machine.successors) == 100 + 2
    assert compiled.step_s is None
    assert "register" not in compiled.hoa
    assert formula_text(compiled.formula) == "always (once[<= 100 steps] p implies q)"


@pytest.mark.parametrize(
    "formula",
    [
        always(implies(P, eventually(near("x")))),
        always(implies(P, Unary(UnaryOperator.EVENTUALLY, Q, within(0, 100)))),
        always(implies(P, Unary(UnaryOperator.ALWAYS, Q, within(0, 100)))),
        always(implies(P, Binary(BinaryOperator.UNTIL, Q, near("x"), within(0, 50)))),
        eventually(Binary(BinaryOperator.AND, P, Unary(UnaryOperator.ALWAYS, Q, within(0, 60)))),
    ],
    ids=formula_text,
)
@pytest.mark.parametrize("semantics", ["stutter", "finite"])
def test_bounds_that_rules_have_fit_into_the_limits(formula, semantics):
    rulebook = replace(book(rule("A", formula, "x: thing")), semantics=semantics)
    compiled = compile_rulebook(rulebook)
    assert compiled.semantics == semantics
    assert len(compiled.rules[0].machine.successors) <= 102


def test_many_pending_duties_of_a_word_that_ends_are_asked_all_at_once():
    """Asked one after another in each state, they took two minutes of processor time."""
    formula = P
    for _ in range(23):
        formula = always(eventually(formula))
    with in_force(["compiling=20"]):
        (compiled,) = compile_rulebook(replace(book(rule("A", formula)), semantics="finite")).rules
    assert len(compiled.machine.successors) <= 3


def test_a_distance_into_the_past_explodes():
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", ago(30))))
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0401"
    assert "a longer step or a shorter bound" in diagnostic.help
    # Nothing can be taken apart.
    assert "separate rule" not in diagnostic.help


@pytest.mark.parametrize("operator", [UnaryOperator.EVENTUALLY, UnaryOperator.ONCE])
def test_so_does_a_bound_of_a_million_steps(operator):
    formula = always(implies(Q, Unary(operator, P, within(0, 10**6))))
    with pytest.raises(RulecError) as caught:
        compile_rulebook(book(rule("A", formula)))
    assert [one.code for one in caught.value.diagnostics] == ["R0401"]


def seconds(high, name="A", step="0.5"):
    formula = always(implies(P, Unary(UnaryOperator.EVENTUALLY, Q, within(0, high, "s"))))
    return replace(rule(name, formula), step_s=Fraction(step))


def test_seconds_become_steps_of_the_trace_or_of_the_examples():
    rulebook = book(seconds(3), rule("B", P))
    own, other = compile_rulebook(rulebook).rules
    assert (own.step_s, other.step_s) == (Fraction(1, 2), None)
    assert len(own.machine.successors) == 6 + 2
    assert "one letter is 0.5 s" in own.hoa
    finer, _ = compile_rulebook(rulebook, step_s=Fraction(1, 10)).rules
    assert finer.step_s == Fraction(1, 10)
    assert len(finer.machine.successors) == 30 + 2
    # It stays what the rulebook says.
    assert finer.formula == own.formula == rulebook.rules[0].formula


def test_what_a_rulebook_says_of_its_rules_is_kept():
    kept = {
        "level": "safety",
        "weight": Fraction(5, 2),
        "source": "https://example.org",
        "certainty": "secondary",
        "book": "base",
    }
    whole = {
        "semantics": "finite",
        "levels": ("safety", "legal"),
        "priorities": frozenset({("safety", "legal")}),
        "extends": ("base",),
        "at": "2026-01-01",
    }
    compiled = compile_rulebook(replace(book(replace(rule("A", P), **kept)), **whole))
    assert {name: getattr(compiled, name) for name in whole} == whole
    assert {name: getattr(compiled.rules[0], name) for name in kept} == kept


def test_finite_words_end_with_alive():
    vocabulary = Vocabulary("v", {}, {"alive": Signal("alive"), "p": Signal("p")})
    formulas = {"plain": always(P), "clash": always(implies(P, Atom("alive")))}
    rules = tuple(Rule(name, "hard", (), formula) for name, formula in formulas.items())
    plain, clash = compile_rulebook(Rulebook("b", vocabulary, rules, semantics="finite")).rules
    assert 'AP: 2 "alive" "p"' in plain.hoa
    assert 'AP: 3 "alive" "alive (2)" "p"' in clash.hoa
    assert '"alive" is true as long as the word lasts' in plain.hoa
    assert '"alive (2)" is true as long as the word lasts' in clash.hoa


@pytest.mark.spot
@settings(max_examples=max(5, settings().max_examples // 500))
@given(st.lists(formulas, min_size=2, max_size=8))
def test_a_rules_table_does_not_depend_on_its_neighbours(several):
    rules = [rule(f"r{n}", formula, "x: thing") for n, formula in enumerate(several)]
    forward = [one.machine for one in compile_rulebook(book(*rules)).rules]
    backward = [one.machine for one in compile_rulebook(book(*rules[::-1])).rules]
    assert forward == backward[::-1]
    assert compile_rulebook(book(rules[-1])).rules[0].machine == forward[-1]


def test_nor_do_the_files_of_the_papers_rules():
    source = load_rulebook("esterle2019")
    together = compile_rulebook(source).rules
    for rule_alone in together:
        (one,) = (each for each in source.rules if each.name == rule_alone.name)
        assert compile_rulebook(replace(source, rules=(one,))).rules == (rule_alone,)
    backward = compile_rulebook(replace(source, rules=source.rules[::-1])).rules
    assert backward[::-1] == together


def test_files_of_the_working_directory_are_not_imported(tmp_path, monkeypatch):
    (tmp_path / "spot.py").write_text("raise RuntimeError('not this one')")
    monkeypatch.chdir(tmp_path)
    assert compile_rulebook(book(rule("A", P))).rules
