"""Tables proved against their formulas, and changed tables that are not."""

import json
import random
import subprocess
import sys
from dataclasses import replace

import pytest

import rulec
from rulec.automata.bundle.bundle_file import to_json
from rulec.automata.bundle.cut_machines import stored
from rulec.automata.second_compiler import with_automata
from rulec.validation.comparison_words import KNOWN_UNITS
from rulec.validation.file_proof import UnreadableError, proof_of, proofs_of
from rulec.vocabulary.dimensions import UNITS
from support.builders.compiled_files import sealed
from support.builders.national_books import NATIONAL
from support.builders.worded_books import compiled_at_random, meaning, some_words, verdict
from support.generators.odd_documents import ODD_VALUES, places_in, with_value


def file_of(reference, step):
    compiled = rulec.compile_rulebook(reference, step_s=step)
    return to_json(with_automata(replace(compiled, prefixes=stored(compiled)))).encode()


def reasons(data):
    return {proof.rule: proof.because for proof in proofs_of(data) if proof.because}


@pytest.mark.parametrize("name", ["esterle2019", "gb"])
def test_rules_that_ship_are_proved(name):
    data = file_of(name, 1)
    assert len(proofs_of(data)) == len(json.loads(data)["rules"]) > 0
    assert reasons(data) == {}


TWO_UNITS = """
rulebook two_units
type car
quantity speed(v: car) in km/h default 0
hard rule alone (v: car) { require always (speed(v) > 18 km/h or eventually speed(v) > 5 m/s) }
hard rule counted {
  require always (some v: car (speed(v) > 5 m/s) or next some v: car (speed(v) > 18 km/h))
}
"""


def test_one_limit_in_two_units_is_one_comparison():
    rules = rulec.compile_rulebook(rulec.parse_rulebook(TWO_UNITS))
    data = to_json(with_automata(replace(rules, prefixes=stored(rules)))).encode()
    assert len(proofs_of(data)) == 2
    assert reasons(data) == {}
    for speeds, violated in [((18, 19, 18), True), ((18, 18, 19), False)]:
        states = [{"speed": {"a": speed}} for speed in speeds]
        found = rulec.verify(rulec.Trace("t", 1.0, {"a": "car"}, states), rules)
        assert ("alone" in {one.rule for one in found.violations}) is violated
        assert "counted" in {one.rule for one in found.violations}


@pytest.mark.parametrize("compared", ["!= -2", ">= -2", "= -2", "< 0.5", "= 0.5"])
def test_a_count_is_never_negative(compared):
    rules = rulec.compile_rulebook(
        rulec.parse_rulebook(
            "rulebook b\ntype a\nsignal p, s(x: a) default false\n"
            f"hard rule r {{ require always (p or count x: a (s(x)) {compared}) }}"
        )
    )
    assert reasons(to_json(with_automata(rules)).encode()) == {}


@pytest.mark.parametrize("name", sorted(UNITS.keys() - {"in"}))
def test_the_checker_has_every_unit_of_the_language(name):
    assert KNOWN_UNITS[name][0] == UNITS[name].factor


@pytest.mark.long
@pytest.mark.parametrize("step", [1, 0.1])
@pytest.mark.parametrize("name", ["esterle2019", *NATIONAL])
def test_all_rules_that_ship_are_proved(name, step):
    assert reasons(file_of(name, step)) == {}


@pytest.mark.parametrize("seed", range(2))
def test_random_rules_are_proved(seed):
    compiled = compiled_at_random(random.Random(seed), n_rules=12)
    assert reasons(to_json(with_automata(compiled)).encode()) == {}


@pytest.mark.long
def test_a_thousand_random_rules_are_proved():
    chance = random.Random(3)
    for _ in range(80):
        compiled = compiled_at_random(chance, n_rules=13, most=6)
        assert reasons(to_json(with_automata(compiled)).encode()) == {}


def changed(machine, chance, outputs):
    """Change an entry of a table, in place: where it leads, what it says, or a letter's class."""
    width, states = len(machine["following"][0]), len(machine["following"])
    row, symbol = chance.randrange(states), chance.randrange(width)
    match chance.choice(["following", outputs, "letters"]):
        case "following":
            machine["following"][row][symbol] = chance.randrange(states)
        case "accepting":
            machine["accepting"][row][symbol] = not machine["accepting"][row][symbol]
        case "outcomes":
            machine["outcomes"][row][symbol] = chance.randrange(3)
        case "letters":
            machine["letters"][chance.randrange(len(machine["letters"]))] = chance.randrange(width)


def of_file(entry, whole):
    """What has been found of a rule in a file of its own, whose digest is right."""
    (proof,) = proofs_of(sealed({**whole, "rules": [entry]}))
    return proof


def check_changed_tables(seed, count, found=of_file, times=40):
    """Change tables; what judges a word otherwise must not be proved. Returns how many did.

    So many ``times`` those of the same rules; ``found`` says what has been found of one.
    """
    chance = random.Random(seed)
    otherwise, pool = 0, []
    for number in range(count):
        if number % times == 0:
            compiled = compiled_at_random(chance)
            whole = json.loads(to_json(with_automata(compiled)))
            pool = list(zip(whole["rules"], compiled.rules, strict=True))
        entry, rule = chance.choice(pool)
        entry = json.loads(json.dumps(entry))
        machine = entry["machine"]
        excluded = [letter for letter, symbol in enumerate(machine["letters"]) if symbol < 0]
        changed(machine, chance, "accepting")
        proof = found(entry, whole)
        letters = [letter for letter, symbol in enumerate(machine["letters"]) if symbol >= 0]
        says = meaning(rule, compiled.semantics)
        if len(letters) + len(excluded) > len(machine["letters"]):
            assert "leaves out" in proof.because
            continue
        for word in some_words(chance, letters, 60):
            if verdict(machine, word) != says(word):
                otherwise += 1
                assert proof.because, (rule.formula, machine, word)
                break
    return otherwise


def test_tables_that_judge_otherwise_are_not_proved():
    assert check_changed_tables(5, 100) > 50


@pytest.mark.long
def test_ten_thousand_changed_tables():
    """As if each stood in a file with a digest of its own; to write those would take longest."""
    assert check_changed_tables(6, 20_000, proof_of, times=500) > 10_000


@pytest.mark.parametrize(
    ("before", "after"),
    [
        # As Spot has it
        pytest.param("State: 0 {0}", "State: 0", marks=pytest.mark.spot),
        ("[t] ", "[0] "),
        ("[t] ", "[t] 0 [t] "),
        ("Inf(0)", "Fin(0)"),
        ("Start: 0", "Start: 1"),
        ('"p" "q"', '"q" "p"'),
        ('"p" "q"', '"p" "r"'),
        ("HOA: v1", "HOA: v2"),
        ("--BODY--", "Alias: @a 0 --BODY--"),
        ("--END--", ""),
        ("Acceptance: 1 Inf(0)", "Acceptance: ) Inf(0)"),
        ("Acceptance: 1 Inf(0)", "Acceptance: 0 Inf(0)"),
        ("Acceptance: 1 Inf(0)", "Acceptance: 1 Inf(0) | Inf(1)"),
        ("Start: 0\nAP", "Start: 0AP"),
    ],
)
def test_a_changed_hoa_text_is_not_proved(before, after):
    book = "rulebook b signal p, q hard rule r { require always (p implies next q) }"
    data = json.loads(to_json(with_automata(rulec.compile_rulebook(rulec.parse_rulebook(book)))))
    text = data["rules"][0]["hoa"]
    assert reasons(sealed(data)) == {}
    assert before in text, text
    data["rules"][0]["hoa"] = text.replace(before, after)
    assert "HOA" in reasons(sealed(data))["r"]


def test_the_trace_that_is_given_is_judged_otherwise():
    compiled = rulec.compile_rulebook(
        rulec.parse_rulebook(
            "rulebook b signal p, q hard rule r { require always (p implies next q) }"
        )
    )
    data = json.loads(to_json(with_automata(compiled)))
    machine = data["rules"][0]["machine"]
    # After p, without q: the state that waits for q now takes anything.
    waiting = machine["following"][0][machine["letters"][1]]
    lost = machine["following"][waiting][machine["letters"][0]]
    assert lost == machine["dead"]
    machine["following"][waiting][machine["letters"][0]] = 0
    (proof,) = proofs_of(sealed(data))
    assert "violated by its tree" in proof.because
    first, second, *_ = proof.word
    assert (first["p"], second["q"]) == ("true", "false")


@pytest.mark.parametrize(
    ("seed", "count"), [(8, 60), pytest.param(9, 3_000, marks=[pytest.mark.long])]
)
def test_changed_tables_for_cut_traces_are_proved_only_if_nothing_changes(seed, count):
    chance = random.Random(seed)
    pool, refused = [], 0
    for number in range(count):
        if number % 40 == 0:
            compiled = compiled_at_random(chance)
            whole = json.loads(to_json(with_automata(compiled)))
            pool = [entry for entry in whole["rules"] if entry["cut"] is not None]
        entry = json.loads(json.dumps(chance.choice(pool)))
        before = json.loads(json.dumps(entry["cut"]))
        changed(entry["cut"], chance, "outcomes")
        (proof,) = proofs_of(sealed({**whole, "rules": [entry]}))
        letters = [letter for letter, symbol in enumerate(before["letters"]) if symbol >= 0]
        for word in some_words(chance, letters, 60):
            if outcomes(before, word) != outcomes(entry["cut"], word):
                refused += 1
                assert proof.because
                break
    assert refused > count // 3


def outcomes(machine, word):
    """The outcomes of a word from each state that a run may begin in."""
    found = set()
    for start in machine["starts"]:
        state, of_run = start, []
        for letter in word:
            symbol = machine["letters"][letter]
            of_run.append(machine["outcomes"][state][symbol] if symbol >= 0 else None)
            state = machine["following"][state][symbol] if symbol >= 0 else state
        found.add(tuple(of_run))
    return found


WORDS = """\
rulebook words
type car
signal p default false
light is one of red, green, off default off
quantity speed in km/h default 0
quantity gap(c: car) in m default 0
fact red implies speed <= 20 km/h
hard rule fast { require always (red implies speed <= 10 m/s) }
hard rule near (c: car) { require always gap(c) >= 2 s * speed }
hard rule few { require never count c: car (gap(c) < 5 m) > 3 }
hard rule single { require always some c: car (gap(c) > 1 mi) }
hard rule whole { require always every c: car (not gap(c) > 1 mi) }
hard rule soon { require always (p implies eventually[<= 3 s] not p) }
hard rule back { require always (p implies once[<= 2 steps] red) }
"""


@pytest.fixture(scope="module")
def words():
    data = file_of(rulec.parse_rulebook(WORDS), 0.5)
    assert reasons(data) == {}
    return json.loads(data)


FAST, NEAR, FEW, ONE, ALL, SOON, BACK = range(7)


@pytest.mark.parametrize(
    ("place", "value", "because"),
    [
        ((FAST, "formula"), "always true", "in words"),
        ((FAST, "tree", 1, 2, "text"), "speed <= 11 m/s", "in words"),
        ((FAST, "machine", "reads", 1, "thresholds", 0, "limit"), "37", "do not decide"),
        ((FAST, "machine", "reads", 1, "thresholds", 0, "inclusive"), True, "do not decide"),
        ((FAST, "machine", "reads", 0, "values"), ["green"], "does not distinguish a value"),
        ((FAST, "machine", "reads", 0, "others"), False, "leave out values"),
        ((FAST, "machine", "reads", 0, "name"), "p", "misreads a signal"),
        ((FEW, "machine", "dead"), None, "calls dead"),
        ((FEW, "machine", "safe"), 0, "calls safe"),
        ((NEAR, "machine", "reads", 0, "terms", 1, 0), "-1/2", "does not read everything"),
        ((SOON, "step_s"), "1", "by its t"),
        ((SOON, "step_s"), None, "no time step"),
        ((SOON, "step_s"), "2/7", "by its t"),
        ((BACK, "cut", "starts"), [0], "cut traces has other outcomes"),
        ((BACK, "cut", "starts"), [], "no valid start states"),
        ((BACK, "tree", 0), "sometimes", "in words"),
        ((BACK, "machine", "letters", 0), -1, "leaves out"),
    ],
)
def test_a_file_that_contradicts_itself_is_not_proved(words, place, value, because):
    data = with_value(words, ("rules", *place), value)
    assert because in "; ".join(reasons(sealed(data)).values())


@pytest.mark.parametrize(
    ("rule", "text", "instead"),
    [
        (FAST, "speed <= 10 m/s", "speed <= 10 km/h"),
        (FAST, "speed <= 10 m/s", "speed < 10 m/s"),
        (FAST, "speed <= 10 m/s", "speed <= 10 smoots"),
        (NEAR, "gap(c) >= 2 s * speed", "gap(c) >= 2 * speed"),
        (NEAR, "gap(c) >= 2 s * speed", "gap(c) >= 1.8 s * speed"),
        (NEAR, "gap(c) >= 2 s * speed", "2 s * speed >= gap(c)"),
        (FEW, "gap(c) < 5 m", "gap(c) < 50 m"),
        (FEW, "> 3", "> 4"),
        (ONE, "some c: car", "every c: car"),
        (ALL, "(not gap(c) > 1 mi)", "(gap(c) > 1 mi)"),
        (ONE, "gap(c) > 1 mi", "gap(c) > 1 km"),
    ],
)
def test_words_that_say_other_numbers_are_not_proved(words, rule, text, instead):
    entry = json.dumps(words["rules"][rule])
    assert text in entry
    rules = [json.loads(entry.replace(text, instead))]
    assert len(reasons(sealed({**words, "rules": rules}))) == 1


def test_other_words_for_the_same_numbers_are_proved(words):
    entry = json.dumps(words["rules"][NEAR])
    rules = [json.loads(entry.replace("gap(c) >= 2 s * speed", "2000 ms * speed - gap(c) <= 0"))]
    assert reasons(sealed({**words, "rules": rules})) == {}


@pytest.mark.parametrize("odd", ODD_VALUES.values(), ids=ODD_VALUES)
def test_odd_values_anywhere_are_no_accident(words, odd):
    chance = random.Random(ascii(odd)[:9])
    places = [place for place in places_in(words) if place[0] in ("rules", "facts", "vocabulary")]
    for place in chance.sample(places, 60):
        try:
            proofs = proofs_of(sealed(with_value(words, place, odd)))
        except UnreadableError:
            continue
        assert len(proofs) == len(words["rules"])


@pytest.mark.parametrize(
    "formula",
    [
        "eventually[<= 5000 steps] p",
        "previously[300 steps] p",
        "always (p implies eventually[9 steps .. 60 steps] red)",
    ],
)
def test_what_is_too_large_is_not_proved_and_takes_no_time(words, formula):
    tree = _tree(rulec.parse_rulebook(WORDS + f"hard rule large {{ require {formula} }}"))
    rule = {**words["rules"][BACK], "tree": tree, "formula": formula}
    (proof,) = proofs_of(sealed({**words, "rules": [rule]}))
    assert proof.because


def _tree(rulebook):
    from rulec.logic.codec import to_data

    return to_data(rulebook.rules[-1].formula)


def test_a_name_that_is_there_twice_is_refused():
    text = (
        '{\n "format": "rulec compiled rulebook",\n "version": 6,\n "rules": [],\n "rules": []}\n'
    )
    from rulec.automata.bundle.bundle_file import with_digest

    with pytest.raises(UnreadableError):
        proofs_of(with_digest(text).encode())


def test_the_checker_loads_nothing_of_rulec():
    program = (
        "import sys, rulec.validation.file_proof\n"
        "own = [name for name in sys.modules if name.startswith('rulec.')]\n"
        "assert all(name.startswith('rulec.validation') for name in own), own\n"
        "assert not {'spot', 'lark', 'numpy', 'msgspec'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
