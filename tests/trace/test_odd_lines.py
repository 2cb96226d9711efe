"""An odd line among lines of JSON: it is answered as if it was alone, and so are the others."""

import io
import json
import random
from itertools import chain

import pytest

import rulec
from rulec.monitoring.batch.batch_verify import verify_items
from rulec.monitoring.verdict import NotJudged
from rulec.trace.formats.json_lines import read_chunks

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


def answers(text, rules):
    return [
        (answer.trace, answer.error.diagnostics) if isinstance(answer, NotJudged) else answer
        for chunk in read_chunks(io.BytesIO(text), "t.jsonl")
        for _, some in verify_items(chunk, rules)
        for answer in some
    ]


def check_one_by_one(every, rules):
    """Each line is answered as if the lines before it were blank, and none came after it."""
    alone = [answers(b"\n" * place + line, rules) for place, line in enumerate(every)]
    assert answers(b"\n".join(every), rules) == [*chain.from_iterable(alone)]


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


@pytest.mark.parametrize("style", [(", ", ": "), (",", ":")], ids=["usual", "compact"])
def test_lines_that_are_not_odd(style, rules):
    every = [line.encode() for line in lines(style=style)]
    check_one_by_one(every, rules)
    found = answers(b"\n".join(every), rules)
    assert {bool(verdict.violations) for verdict in found} == {False, True}
    assert any(verdict.open for verdict in found)


@pytest.mark.parametrize("last", [False, True], ids=["first", "last"])
@pytest.mark.parametrize("case", ODD)
def test_what_is_odd_about_one_line_changes_nothing_for_others(case, last, rules):
    before, after = ODD[case]
    every = lines()
    line = every[7]
    assert before in line
    begin = line.rindex(before) if last else line.index(before)
    every[7] = line[:begin] + after + line[begin + len(before) :]
    check_one_by_one([one.encode() for one in every], rules)


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
    assert not isinstance(answers(every[line], rules)[0], rulec.Verdict)
    check_one_by_one(every, rules)
