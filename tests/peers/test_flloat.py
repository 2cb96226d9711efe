"""Another implementation judges finite words by LTLf formulas: flloat.

It brings a module that overwrites ``lark``, so it lives in an environment of its own, made from the
package index; hence only in the long run of the tests. It knows no past, no bounds, and neither
weak until nor strong release.
"""

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

from rulec.automata.alphabet import propositions_of, reads_of
from rulec.automata.worker.job_answers import verdict
from rulec.logic.bounds import PAST, operations_of
from rulec.logic.formula import Binary, Constant, Unary
from rulec.logic.semantics import holds
from support.generators.drawn import drawn
from support.generators.timed_formulas import (
    TIMED_VOCABULARY,
    is_true,
    letter_number,
    letters_of,
    timed_formulas,
    timed_words,
    without_bounds,
)
from support.oracles.installed_spot import machine_of

spot_bridge = pytest.importorskip("rulec.automata.spot_bridge")

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
)
PROGRAM = Path(__file__).with_name("judge_ltlf.py")

UNARY = {
    "not": "!({p})",
    "next": "X({p})",
    "weak next": "WX({p})",
    "eventually": "F({p})",
    "always": "G({p})",
    "never": "G(!({p}))",
}
BINARY = {
    "and": "({p}) & ({q})",
    "or": "({p}) | ({q})",
    "implies": "({p}) -> ({q})",
    "iff": "({p}) <-> ({q})",
    "xor": "!(({p}) <-> ({q}))",
    "until": "({p}) U ({q})",
    "release": "({p}) R ({q})",
    "weak until": "({q}) R (({p}) | ({q}))",
    "strong release": "({q}) U (({p}) & ({q}))",
    "then": "({p}) & X(({p}) U ({q}))",
}


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    """A Python that has flloat."""
    folder = tmp_path_factory.mktemp("flloat")
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    python = folder / "bin" / "python"
    install = [python, "-m", "pip", "install", "--quiet", "flloat==0.3.0"]
    subprocess.run(install, check=True)
    return python


def in_flloat(formula, names):
    match formula:
        case Constant(value):
            return "true" if value else "false"
        case Unary(operator, operand):
            return UNARY[operator.value].format(p=in_flloat(operand, names))
        case Binary(operator, left, right):
            p, q = (in_flloat(one, names) for one in (left, right))
            return BINARY[operator.value].format(p=p, q=q)
    return names[formula]


def by_machine(formula, words):
    reads = reads_of(formula, TIMED_VOCABULARY)
    found = spot_bridge.translate(formula, reads, "finite")
    machine = machine_of(found, reads)
    return [verdict(machine, [letter_number(reads, state) for state in word]) for word in words]


def test_its_verdicts_are_those_of_direct_evaluation_and_of_machines(python):
    chosen = [
        formula
        for formula in drawn(timed_formulas, 3000)
        if any(True for _ in operations_of(formula))
        and all(one.operator not in PAST for one in operations_of(formula))
    ]
    pool = drawn(timed_words, 300)
    pick = random.Random(1)
    jobs, evaluated, judged = [], [], []
    for formula in chosen:
        names = {one: f"p{n}" for n, one in enumerate(propositions_of(formula))}
        words = pick.sample(pool, 12)
        evaluated.append([holds(formula, letters_of(formula, word), "finite") for word in words])
        judged.append(by_machine(formula, words))
        values = [
            [{name: is_true(one, state) for one, name in names.items()} for state in word]
            for word in words
        ]
        jobs.append({"formula": in_flloat(without_bounds(formula), names), "words": values})
    done = subprocess.run(
        [python, PROGRAM],
        input="\n".join(map(json.dumps, jobs)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == ""
    verdicts = [json.loads(line) for line in done.stdout.splitlines()]
    assert evaluated == verdicts
    assert judged == verdicts
    assert len(jobs) > 500
    assert sum(one.bound is not None for formula in chosen for one in operations_of(formula)) > 300
    share = sum(map(sum, verdicts)) / sum(map(len, verdicts))
    assert 0.2 < share < 0.8
