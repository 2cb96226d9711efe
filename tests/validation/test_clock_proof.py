"""Machines with clocks in compiled files: changed ones are proved only if they judge alike."""

import copy
import json
from random import Random

import msgspec
import pytest

import rulec
from rulec.automata.bundle import bundle_schema as schema
from rulec.automata.bundle.bundle_file import to_json
from rulec.automata.bundle.clocked_entries import timed_machine
from rulec.automata.mealy_monitor import sink_of
from rulec.automata.second_compiler import with_automata
from rulec.validation.clock_proof import proof_steps
from rulec.validation.file_proof import proof_of

RULES = (
    "always (p implies eventually[<= 1 s] q)",
    "always (q implies once[<= 1.5 s] p)",
    "always (once[>= 1 s] p implies (q since[0.5 s .. 2 s] p))",
    "never (p then[<= 1 s] q)",
    "always (p implies always[0.5 s .. 1 s] q)",
)


def compiled(semantics):
    rules = "".join(f"hard rule r{n} {{ require {text} }}\n" for n, text in enumerate(RULES))
    source = f"rulebook book\nsemantics {semantics}\nsignal p, q\n{rules}"
    book = rulec.compile_rulebook(rulec.parse_rulebook(source), step_s=0.5)
    return book, json.loads(to_json(with_automata(book)))


def is_proved(rule, book, clocked):
    return not proof_of({**rule, "clocked": clocked}, book).because


def changed(entry, chance):
    """The entry with one number of one of its rows changed."""
    entry = copy.deepcopy(entry)
    clock = chance.choice(entry["clocks"])
    kind = chance.choice(["following", "accepting", "operands", "from", "to", "letters"])
    if kind == "operands":
        clock["operands"][chance.randrange(len(clock["operands"]))] ^= chance.choice((1, 2, 3))
    elif kind in ("from", "to"):
        clock[kind] = chance.choice(["0", "1/2", "1", "3/2", "2"])
    elif kind == "letters":
        place = chance.randrange(len(entry["letters"]))
        if entry["letters"][place] >= 0:
            entry["letters"][place] = chance.randrange(len(entry["following"][0]))
    else:
        row = chance.choice(entry[kind])
        place = chance.randrange(len(row))
        row[place] = chance.randrange(len(entry[kind])) if kind == "following" else not row[place]
    return entry


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
def test_clocks_of_compiled_rules_are_proved(semantics):
    _, data = compiled(semantics)
    for rule in data["rules"]:
        assert is_proved(rule, data, rule["clocked"])


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
def test_a_changed_one_is_proved_if_and_only_if_it_unrolls_to_the_same(semantics):
    book, data = compiled(semantics)
    chance, outcomes = Random(semantics), []
    for rule, entry in zip(book.rules, data["rules"], strict=True):
        for _ in range(60):
            other = changed(entry["clocked"], chance)
            read = msgspec.convert(other, schema.ClockedEntry)
            rows = read.successors, read.outputs
            read.rejecting_sink = sink_of(*rows, verdict=False)
            read.accepting_sink = sink_of(*rows, verdict=True)
            try:
                timed = timed_machine(read, rule.machine.reads, "r", ends=semantics == "finite")
            except ValueError:
                continue  # Such a file is refused, whatever it says at this step
            same = all(timed.at(step) == rule.timed.at(step) for step in proof_steps(entry["tree"]))
            assert is_proved(entry, data, other) is same
            outcomes.append(same)
    assert 20 < sum(outcomes) < len(outcomes) - 50
