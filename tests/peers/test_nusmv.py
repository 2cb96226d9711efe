"""NuSMV reads what is written for it and nuXmv, and judges traces by it as the automata do.

It comes as a wheel for Python 3.6 (pynusmv), so it lives in an environment of its own, made from
the package index; hence only in the long run of the tests.
"""

import csv
import json
import os
import random
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import rulec
from rulec.automata.second_compiler import with_automata
from rulec.rulebook.files.search_path import available_rulebooks
from support.cases.kinds_of_rules import ALL_KINDS
from support.oracles.installed_spot import spot
from tools.programs import environment

PROGRAM = Path(__file__).with_name("read_with_nusmv.py")
N_WORDS = 40


def old_python():
    """A Python 3.6, also one that pyenv has; None if there is none."""
    installed = sorted(Path.home().glob(".pyenv/versions/3.6.*/bin/python"))
    return installed[-1] if installed else shutil.which("python3.6")


pytestmark = [
    pytest.mark.skipif(
        os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
    ),
    pytest.mark.skipif(old_python() is None, reason="there is no Python 3.6, as NuSMV's wheel is"),
]


@pytest.fixture(scope="module")
def answers():
    """What NuSMV says of files, each ``checked`` or only read."""
    needed = ("pynusmv==1.0rc8", "pyparsing==2.4.7")
    python = environment("nusmv", *needed, python=old_python()) / "bin/python"

    def of(paths, *, checked):
        jobs = [json.dumps({"file": str(path), "checked": checked}) for path in paths]
        run = [python, PROGRAM]
        done = subprocess.run(
            run, input="\n".join(jobs), capture_output=True, text=True, check=False
        )
        # It warns where no word of the model breaks a specification.
        assert done.returncode == 0, done.stderr
        return [json.loads(line) for line in done.stdout.splitlines()]

    return of


def test_every_rulebook_is_read(answers, tmp_path):
    names = sorted(available_rulebooks())
    for name in names:
        rulec.write_ltl(name, tmp_path)
    read = answers([tmp_path / f"{name}.smv" for name in names], checked=False)
    assert [one["specifications"] for one in read] == [
        len(rulec.load_rulebook(name).rules) for name in names
    ]


def rows(folder, name):
    with (folder / f"{name}.csv").open(encoding="utf-8") as file:
        return {row["rule"]: row for row in csv.DictReader(file)}


def lasso(propositions, pick):
    """Letters, as the propositions that hold, and to which of them the last one leads back."""
    letters = [
        {name for name in propositions if pick.random() < 0.4} for _ in range(pick.randint(1, 6))
    ]
    return letters, pick.randrange(len(letters))


def ended(letters):
    """A finite word: the last letter is that of after its end, for ever."""
    alive = [letter | {"alive"} for letter in letters]
    return [*alive, set()], len(alive)


def as_model(module, parameters, letters, back):
    """A model that has this word and no other, and the rule's module of it."""
    last = len(letters) - 1
    never = len(letters)  # a variable has to have two values
    defined = []
    for name in parameters:
        where = ", ".join(str(at) for at, letter in enumerate(letters) if name in letter)
        defined.append(f"  {name} := {f't in {{{where}}}' if where else 'FALSE'};")
    (head,) = re.findall(r"MODULE (\w+)\(", module)
    return "\n".join(
        [
            module,
            "MODULE main",
            f"VAR t : 0..{never};",
            f"  here : {head}({', '.join(parameters)});",
            *(["DEFINE", *defined] if defined else []),
            "ASSIGN init(t) := 0;",
            f"  next(t) := case t = {last} : {back}; t = {never} : t; TRUE : t + 1; esac;",
            "",
        ]
    )


def as_word(propositions, letters, back):
    """The word in Spot's notation."""
    shown = [
        " & ".join(name if name in letter else f"!{name}" for name in propositions) or "1"
        for letter in letters
    ]
    return spot.parse_word("; ".join([*shown[:back], f"cycle{{{'; '.join(shown[back:])}}}"]))


@pytest.mark.parametrize("book", ["esterle2019", "", "semantics finite"])
def test_its_verdicts_are_those_of_the_automata(book, answers, tmp_path):
    reference, name = book, book
    if " " in book or not book:
        reference, name = str(tmp_path / "kinds.rules"), "kinds"
        Path(reference).write_text(ALL_KINDS.format(semantics=book))
    rulec.write_ltl(reference, tmp_path, 1)
    compiled = with_automata(rulec.compile_rulebook(reference, step_s=1))
    meanings = json.loads((tmp_path / f"{name}.propositions.json").read_text("utf-8"))["rules"]
    text = (tmp_path / f"{name}.smv").read_text("utf-8")
    modules = re.findall(r"MODULE rule_[\s\S]*?(?=\n\n)", text)
    pick = random.Random(5)
    paths, expected, can_be = [], [], 0
    for rule, module in zip(compiled.rules, modules, strict=True):
        own = meanings[rule.name]
        named = {one["formula"]: each for each, one in own["propositions"].items()}
        hoa = re.sub(
            r'"([^"\n]*)"', lambda ap, named=named: f'"{named.get(ap[1], ap[1])}"', rule.hoa
        )
        row = rows(tmp_path, name)[rule.name]
        facts = spot.translate(row["facts"])
        parameters = [*own["propositions"], *(["alive"] if "finite" in book else [])]
        for number in range(N_WORDS):
            letters, back = lasso(own["propositions"], pick)
            if "finite" in book:
                letters, back = ended(letters)
            paths.append(tmp_path / f"{rule.name}{number}.smv")
            paths[-1].write_text(as_model(module, parameters, letters, back))
            word = as_word(parameters, letters, back).as_automaton()
            is_possible = word.intersects(facts)
            can_be += is_possible
            # What cannot be is kept: the specification assumes the facts.
            expected.append(not is_possible or word.intersects(spot.automaton(hoa)))
    said = answers(paths, checked=True)
    assert [one["kept"] for one in said] == [[verdict] for verdict in expected]
    assert can_be > len(paths) / 4
    assert 0 < expected.count(False) < can_be
