"""Running needs neither Spot, Lark, Shapely nor NetworkX."""

import subprocess
import sys

from rulec.automata.bundle.bundle_file import to_json
from rulec.automata.compiler import compile_rulebook
from support.builders.rulebooks import Q, always, book, implies, near, rule

BLOCKED = """
import sys
for name in ("spot", "buddy", "lark", "shapely", "networkx", "click", "rich"):
    sys.modules[name] = None  # any import of it is an ImportError
import rulec
rules = rulec.compile_rulebook("book.json")
print(*[rulec.verify(trace, rules).satisfied for trace in rulec.read_traces("traces.jsonl")])
"""

COMMAND = """
import sys
for name in ("spot", "buddy", "lark", "shapely", "networkx"):
    sys.modules[name] = None
from rulec.cli.main import main
sys.exit(main(["verify", "traces.jsonl", "--rulebook", "book.json"]))
"""


def run(program, folder, values=("true", "false")):
    rules = compile_rulebook(book(rule("A", always(implies(near("x"), Q)), "x: car")))
    (folder / "book.json").write_text(to_json(rules))
    lines = [
        f'{{"objects": {{"c": "car"}}, "states": [{{"place": {{"c": "near"}}, "q": {q}}}]}}'
        for q in values
    ]
    (folder / "traces.jsonl").write_text("\n".join(lines))
    return subprocess.run(
        [sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False
    )


def test_a_compiled_rulebook_judges_traces_from_python(tmp_path):
    done = run(BLOCKED, tmp_path)
    assert (done.stdout, done.stderr) == ("True False\n", "")


def test_a_compiled_rulebook_judges_traces_from_the_command_line(tmp_path):
    done = run(COMMAND, tmp_path)
    assert done.returncode == 1
    assert done.stderr == ""
    assert "2 traces: 1 satisfied, 1 violated" in done.stdout


def test_importing_rulec_imports_nothing_else():
    heavy = ["spot", "lark", "shapely", "networkx", "numpy", "click", "rich", "msgspec"]
    program = f"import sys, rulec; print([n for n in {heavy} if n in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "[]\n"


WITHOUT_NUMPY = """
import sys
sys.modules["numpy"] = None
import rulec
rules = rulec.compile_rulebook("book.json")
for trace in rulec.read_traces("traces.jsonl"):
    verdict = rulec.verify(trace, rules)
    print(verdict.satisfied, *[own.step for own in verdict.violations], *verdict.open)
"""


def test_traces_known_or_not_are_judged_without_numpy_as_a_browser_does(tmp_path):
    done = run(WITHOUT_NUMPY, tmp_path, ("true", "false", "null"))
    assert done.stderr == ""
    known, broken, unknown = done.stdout.splitlines()
    assert (known, broken) == ("True", "False 0")
    assert unknown.startswith("None OpenVerdict(")
