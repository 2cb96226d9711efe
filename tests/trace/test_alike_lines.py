"""Lines of JSON read together as columns, held against the same lines decoded one by one."""

import io
import json
import random
import re
from itertools import pairwise, product

import numpy as np
import pytest

import rulec
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.batch_verify import verify_items
from rulec.monitoring.verdict import NotJudged
from rulec.trace.formats.alike_lines import LineBlock
from rulec.trace.formats.byte_columns import (
    PADDING,
    begin_with,
    column_words,
    end_as_before,
    read_values,
    words_for,
    words_from,
)
from rulec.trace.formats.json_lines import read_chunks
from rulec.trace.formats.table_blocks import Numbers

BOOK = """
rulebook alike
type vehicle
signal wet default false
signal braking(v: vehicle) default false
lane(v: vehicle) is one of left, right
quantity gap(v: vehicle) in m
quantity speed in m/s default 0
hard rule near (v: vehicle) { require always (gap(v) < 5 m implies next braking(v)) }
hard rule right (v: vehicle) { require always (wet implies right(v)) }
hard rule slow { require always speed <= 50 km/h }
"""
N_STATES = 12


@pytest.fixture(scope="module")
def rules(tmp_path_factory):
    path = tmp_path_factory.mktemp("alike") / "alike.rules"
    path.write_text(BOOK)
    return rulec.compile_rulebook(path)


def trace(number, lengths=N_STATES):
    chance = random.Random(number)
    names = [f"{number}.{place}" for place in range(2)]
    states = [
        {
            "wet": number % 2 > 0 and chance.random() < 0.2,
            "lane": {name: chance.choice(["left", "right"]) for name in names},
            "gap": {
                name: chance.choice([round(chance.uniform(3, 9), 2), 5, 4.5]) for name in names
            },
            "braking": {name: number % 4 == 0 or chance.random() < 0.7 for name in names},
            "speed": chance.choice([round(chance.uniform(0, 14), 6), 13.888888888888888, 3]),
        }
        for _ in range(lengths)
    ]
    objects = dict.fromkeys(names, "vehicle")
    return {"id": f"t{number}", "step_s": 0.5, "objects": objects, "states": states}


def lines(n_traces=9, style=(", ", ": ")):
    return [json.dumps(trace(number), separators=style) for number in range(n_traces)]


def chunks(text, *, together):
    return list(read_chunks(io.BytesIO(text + b"\n"), "t.jsonl", together=together))


def answers(text, rules, *, together):
    return [
        (answer.trace, answer.error.diagnostics) if isinstance(answer, NotJudged) else answer
        for chunk in chunks(text, together=together)
        for _, some in verify_items(chunk, rules)
        for answer in some
    ]


def alike_in(text):
    """The traces that were read together, by their places."""
    (chunk, *_) = chunks(text, together=True)
    assert isinstance(chunk, LineBlock)
    return sorted(place for found in chunk.alike for place in found.lines.tolist())


def held_against_one_by_one(text, rules):
    said, apart = (
        [
            one.diagnostics if isinstance(one, RulecError) else one
            for chunk in chunks(text, together=together)
            for one in chunk
        ]
        for together in (True, False)
    )
    assert said == apart
    assert answers(text, rules, together=True) == answers(text, rules, together=False)


@pytest.mark.parametrize("style", [(", ", ": "), (",", ":")], ids=["usual", "compact"])
def test_what_most_programs_write_is_read_together(style, rules):
    text = "\n".join(lines(style=style)).encode()
    assert alike_in(text) == list(range(9))
    held_against_one_by_one(text, rules)
    found = answers(text, rules, together=True)
    assert {bool(verdict.violations) for verdict in found} == {False, True}
    assert any(verdict.open for verdict in found)


def test_complete_traces_and_cut_ones_are_read_together(rules):
    said = (line.replace('"step_s"', '"ends": "complete", "step_s"') for line in lines()[::2])
    text = "\n".join([*said, *lines()]).encode()
    assert alike_in(text) == list(range(14))
    held_against_one_by_one(text, rules)
    found = answers(text, rules, together=True)
    assert {bool(verdict.open) for verdict in found[:5]} == {False}
    assert {bool(verdict.open) for verdict in found[5:]} == {False, True}


def test_traces_of_different_lengths_names_and_steps(rules):
    several = [trace(number, 3 + number) for number in range(14)]
    for one in several[::3]:
        one["step_s"] = 0.25
    del several[4]["id"]
    for state in several[5]["states"]:
        del state["speed"]
    text = "\n\n".join(map(json.dumps, several)).encode()
    assert set(alike_in(text)) >= {1, 2, 4, 7, 8, 10, 11, 13}
    held_against_one_by_one(text, rules)


ODD = {
    "null": ('"wet": false', '"wet": null'),
    "an interval": ('"speed": 3', '"speed": {"from": 2, "to": 3}'),
    "one more name": ('"wet": false', '"wet": false, "dry": true'),
    "a name said twice": ('"wet": false', '"wet": false, "wet": true'),
    "another order": ('"wet": false, "lane"', '"lane": {}, "wet": false, "lane"'),
    "a name that is none": ('"wet": false', '"wat": false'),
    "an object that is none": ('"7.0": "left"', '"7.9": "left"'),
    "more digits than floats have": ('"speed": 3', '"speed": 3.00000000000000000001'),
    "a large number": ('"speed": 3', '"speed": 9007199254740993'),
    "a number near to 0": ('"speed": 3', '"speed": 1e-300'),
    "a number with an exponent": ('"speed": 3', '"speed": 3e0'),
    "no number": ('"speed": 3', '"speed": NaN'),
    "a leading zero": ('"speed": 3', '"speed": 03'),
    "a sign before": ('"speed": 3', '"speed": +3'),
    "a point behind": ('"speed": 3}', '"speed": 3.}'),
    "a point before": ('"speed": 3', '"speed": .3'),
    "a negative zero": ('"speed": 3', '"speed": -0'),
    "a text for a number": ('"speed": 3', '"speed": "3"'),
    "a truth value for a number": ('"speed": 3', '"speed": true'),
    "a list": ('"speed": 3', '"speed": [3]'),
    "no value": ('"speed": 3', '"speed": '),
    "a word": ('"wet": false', '"wet": falsy'),
    "an unknown text": ('"left"', '"middle"'),
    "an escape": ('"left"', r'"\u006ceft"'),
    "a quote within": ('"left"', '"le"ft"'),
    "an open text": ('"left"', '"left'),
    "a colon within": ('"left"', '"le:ft"'),
    "the end of a state within a text": ('"left"', '"}, {"'),
    "a tab within a text": ('"left"', '"\tleft"'),
    "a space more": ('"wet": false', '"wet":  false'),
    "a brace too few": ('}, {"wet"', ', {"wet"'),
    "a comma too few": ('}, {"wet"', '} {"wet"'),
    "two commas": ('}, {"wet"', '},, {"wet"'),
    "no state": ('"states": [', '"states": [{}, '),
    "something behind": ("]}", "]} x"),
    "one more field": ('"step_s"', '"steps": 1, "step_s"'),
    "states before the rest": ('{"id"', '{"states": [], "id"'),
    "an object of no known type": ('"vehicle"}', '"tram"}'),
    "presence": ('"step_s"', '"present": {"7.0": [0, 3]}, "step_s"'),
    "a complete trace": ('"step_s"', '"ends": "complete", "step_s"'),
    "a trace that does not say its step": ('"step_s": 0.5, ', ""),
    "a step of nothing": ('"step_s": 0.5', '"step_s": 0'),
    "a step that is no float": ('"step_s": 0.5', '"step_s": 0.50000000000000000001'),
}


@pytest.mark.parametrize("last", [False, True], ids=["first", "last"])
@pytest.mark.parametrize("case", ODD)
def test_what_is_odd_about_one_line_changes_nothing_for_others(case, last, rules):
    before, after = ODD[case]
    every = lines()
    line = every[7]
    assert before in line
    begin = line.rindex(before) if last else line.index(before)
    every[7] = line[:begin] + after + line[begin + len(before) :]
    text = "\n".join(every).encode()
    assert set(alike_in(text)) >= set(range(9)) - {7}
    held_against_one_by_one(text, rules)


@pytest.mark.parametrize("line", [0, 2])
@pytest.mark.parametrize(
    ("text", "no_text"),
    [
        (b'"left"', b'"\xffeft"'),
        (b'"speed"', b'"spe\xff\xff"'),
        (b': {"%d.0": "', b': {"%d\x80": "'),
        (b', "speed"', b'\xc3, "speed"'),
        (b'"id": "t', b'"id": "\xff'),
    ],
    ids=["a value", "a name", "an object", "between", "the trace's name"],
)
def test_bytes_that_are_no_text(line, text, no_text, rules):
    every = [line.encode() for line in lines()]
    text, no_text = (part.replace(b"%d", b"%d" % line) for part in (text, no_text))
    assert text in every[line]
    every[line] = every[line].replace(text, no_text)
    assert line not in alike_in(b"\n".join(every))
    held_against_one_by_one(b"\n".join(every), rules)


def test_a_line_that_is_torn(rules):
    every = lines()
    every[3] = every[3][:500] + "\n" + every[3][500:]
    every[8] = every[8][:-40]
    text = "\n".join(every).encode()
    assert alike_in(text)
    held_against_one_by_one(text, rules)


def test_names_of_all_kinds(rules):
    every = [
        line.replace(f'"{number}.0"', json.dumps(name, ensure_ascii=False))
        for number, (line, name) in enumerate(
            zip(lines(8), ["a%s", "%", "é", "a b", "a:b", 'a"b', "a\\b", "from"], strict=True)
        )
    ]
    text = "\n".join(every * 3).encode()
    assert {0, 1, 2, 3} <= set(alike_in(text)) <= {place for place in range(24) if place % 8 < 4}
    held_against_one_by_one(text, rules)


WRITTEN = ["0", "7", "-7", "0.5", "-0.25", "10", "100.125", "123456789012345", "0.00001", "12.0"]
WRITTEN += ["0.1", "0.30000000000000004", "1234567.1234567", "5e-05", "1.5e+20", "98765432109876.5"]
REFUSED = ["00", "-01", "1.", ".5", "-.5", "-", "1-2", "1.2.3", "0x1", "1e5", "-0", "-0.0", "+1"]
REFUSED += ["12345678901234567890", "0.1000000000000000055", "1e-300", "nan", "1_0", "1 ", "1,5"]


def values_of(text, starts, ends):
    return read_values(text, starts, ends, column_words(text, starts, ends, 0))


def test_numbers_are_the_very_floats_that_they_are_written_as():
    texts = [
        *WRITTEN,
        *REFUSED,
        *(repr(round(random.Random(n).gauss(0, 99), 3)) for n in range(99)),
    ]
    text = b" " * PADDING + " ".join(texts).encode() + b" " * PADDING
    ends = PADDING + np.cumsum([len(one) + 1 for one in texts]) - 1
    found = values_of(np.frombuffer(text, np.uint8), ends - list(map(len, texts)), ends)
    assert isinstance(found.column, Numbers)
    for one, number, is_read in zip(texts, found.column.numbers, found.read, strict=True):
        assert is_read == (one not in REFUSED), one
        assert not is_read or (number == float(one) and repr(float(number)) == repr(float(one)))


def test_numbers_of_few_bytes_are_the_floats_that_json_says():
    chance = random.Random(8)
    short = ["".join(one) for size in range(1, 6) for one in product("019./:", repeat=size)]
    longer = ["".join(chance.choices("0123456789.", k=chance.randint(6, 8))) for _ in range(5_000)]
    texts = short + longer
    text = b" " * PADDING + " ".join(texts).encode() + b" " * PADDING
    ends = PADDING + np.cumsum([len(one) + 1 for one in texts]) - 1
    found = values_of(np.frombuffer(text, np.uint8), ends - list(map(len, texts)), ends)
    assert isinstance(found.column, Numbers)
    numbers, is_read = found.column.numbers, found.read
    json = re.compile(r"(0|[1-9][0-9]*)([.][0-9]+)?")
    assert is_read.tolist() == [json.fullmatch(one) is not None for one in texts]
    assert numbers[is_read].tolist() == [float(one) for one in texts if json.fullmatch(one)]


def test_bytes_are_compared_in_words_as_one_by_one():
    chance = random.Random(9)
    for width in range(1, 30):
        rows = [bytes(chance.choices(b"ab", k=width)) for _ in range(2)]
        rows = [bytes(chance.choices(b"ab", k=7)) + chance.choice(rows) for _ in range(60)]
        text = np.frombuffer(b"".join(rows) + b" " * 7, np.uint8)
        starts, count = np.arange(60) * (width + 7) + 7, words_for(width)
        cut = [one[7:] for one in rows]
        same = [one == before for before, one in pairwise(cut)]
        words = words_from(text, starts + width - 8 * count, count)
        assert end_as_before(words, width).tolist() == same
        words = words_from(text, starts, count)
        assert begin_with(words, cut[0]).tolist() == [one == cut[0] for one in cut]
