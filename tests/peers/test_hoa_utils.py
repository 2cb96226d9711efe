"""Another implementation reads the HOA files and judges words by them: hoa-utils.

It brings a module that overwrites ``lark``, so it lives in an environment of its own, made from the
package index; hence only in the long run of the tests.
"""

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from rulec.automata.compiler import compile_rulebook
from rulec.logic.formula import atoms_of
from rulec.logic.semantics import holds
from support.builders.rulebooks import book, rule
from support.generators.drawn import drawn
from support.generators.random_formulas import formulas, letters, words

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
)
PROGRAM = Path(__file__).with_name("read_hoa.py")


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    """A Python that has hoa-utils."""
    folder = tmp_path_factory.mktemp("hoa-utils")
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    python = folder / "bin" / "python"
    install = [python, "-m", "pip", "install", "--quiet", "hoa-utils==0.1.0", "setuptools<80"]
    subprocess.run(install, check=True)
    return python


def test_its_verdicts_are_those_of_direct_evaluation(python):
    chosen = [f for f in drawn(formulas, 400) if any(True for _ in atoms_of(f))]
    variables = [["x: thing"] if any(a.arguments for a in atoms_of(f)) else [] for f in chosen]
    rules = [rule(f"r{n}", f, *v) for n, (f, v) in enumerate(zip(chosen, variables, strict=True))]
    compiled = compile_rulebook(book(*rules))
    pool = drawn(words, 200)
    pick = random.Random(1)
    jobs, expected = [], []
    for formula, machine in zip(chosen, compiled.rules, strict=True):
        if "\nAcceptance: 0 " in machine.hoa:  # hoa-utils 0.1.0 fails on no acceptance sets
            continue
        some = [letters(word) for word in pick.sample(pool, 12)]
        expected.append([holds(formula, word) for word in some])
        jobs.append({"hoa": machine.hoa, "words": [[[*map(str, a)] for a in w] for w in some]})
    done = subprocess.run(
        [python, PROGRAM],
        input="\n".join(map(json.dumps, jobs)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == ""
    assert [json.loads(line) for line in done.stdout.splitlines()] == expected
    assert len(jobs) > 100
    verdicts = [verdict for row in expected for verdict in row]
    assert 0.2 < sum(verdicts) / len(verdicts) < 0.8
