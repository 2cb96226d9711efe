"""Verdicts under unknown values are those of all completions."""

from fractions import Fraction

from hypothesis import Phase, given, settings

from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.uncertainty.state_letters.read_digits import names_of_read
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.full_vocabulary import WORLD
from support.builders.rulebooks import compile_here
from support.generators.blurred_traces import blurred, telling_numbers
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds
from support.oracles.completion_oracle import CompletionOracle, n_completions
from support.oracles.rulebook_oracle import Oracle, Said
from support.oracles.state_oracle import Reading

NUMBERS = telling_numbers()
MOST_COMPLETIONS = 400
ORDER = settings(phases=[Phase.generate])


def why(trace, names, stretch):
    """Of each name whether some value is unknown altogether, or all are within bounds."""
    reasons = set()
    for name in names:
        said = [state.get(name) for state in trace.states[stretch[0] : stretch[1] + 1]]
        reasons.add("not told" if UNKNOWN in leaves(said) else "tolerance")
    return reasons


def leaves(value):
    if isinstance(value, dict | list):
        inner = value.values() if isinstance(value, dict) else value
        return [leaf for one in inner for leaf in leaves(one)]
    return [value]


def reads_several(compiled, name):
    """Whether a rule asks of several words at once, as a sum and a counted object may."""
    (rule,) = [one for one in compiled.rules if one.name == name]
    return any(len(names_of_read(read)) > 1 for read in rule.machine.reads)


@given(seeds)
@ORDER
def test_verdicts_are_those_of_all_completions(chance):
    book = rulebook(chance, Fraction(1))
    compiled = compile_here(book, Fraction(1))
    oracle = Oracle(book)
    formulas = [x.formula for x in (*book.rules, *book.axioms)]
    names = {name for formula in formulas for name in names_in(formula)}
    for trace in traces(chance, Fraction(1))[:3]:
        partial = blurred(chance, trace, names)
        if n_completions(partial, WORLD, NUMBERS) > MOST_COMPLETIONS:
            continue
        completed = CompletionOracle(oracle, partial, NUMBERS)
        if completed.refused or not completed.answers:
            continue
        try:
            verdict = verify(partial, compiled)
        except RulecError as error:
            raise AssertionError((error, partial)) from error
        violated = {(x.rule, tuple(x.binding.values())): x for x in verdict.violations}
        doubtful = {(x.rule, tuple(x.binding.values())): x for x in verdict.open}
        for rule in book.rules:
            for objects, *stretch in Reading(book, partial).choices(rule):
                key = rule.name, tuple(objects.values())
                expected = completed.verdict(*key)
                if isinstance(expected, Said):
                    assert key in violated, (key, partial, rule)
                    step = violated[key].step
                    assert (-1 if step is None else step) == expected.step, (key, partial, rule)
                elif expected == "open":
                    assert key in doubtful, (key, partial, rule)
                    found = doubtful[key]
                    assert found.exact
                    assert set(found.because) == why(partial, found.depends_on, stretch)
                    if reads_several(compiled, rule.name):
                        # One of them may be unknown in other states than the others are.
                        assert completed.decides(found.depends_on, *key), (key, partial, rule)
                    else:
                        assert found.depends_on == completed.smallest(*key), (key, partial, rule)
                else:
                    assert key not in violated, (key, partial, rule)
                    assert key not in doubtful, (key, partial, rule)
