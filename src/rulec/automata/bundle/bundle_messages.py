"""Messages about compiled rulebooks."""

from __future__ import annotations

from rulec.diagnostics.code import Code

_SIGNALS = ", ".join(f"s{number}" for number in range(1, 18))
_EACH = [f"not s{number}" for number in range(1, 18)]

AUTOMATON_TOO_LARGE = Code(
    "R0401",
    title="the automaton of a rule would be too large",
    why="An automaton can be far larger than its formula. A rule may take 5 s of processor time "
    "and 2 GiB of memory to compile, and as many acceptance sets as Spot has, 32, and read 65,536 "
    "different letters (16 signals). Demands "
    "that are joined by `and` can each have a rule of their own; those automata stand beside "
    "each other instead of being multiplied.",
    bad=f"rulebook example\nsignal {_SIGNALS}\nhard rule all_off {{\n"
    f"  require always ({' and '.join(_EACH[:9])}\n"
    f"                  and {' and '.join(_EACH[9:])})\n}}\n",
    good=f"rulebook example\nsignal {_SIGNALS}\n"
    f"hard rule these_off {{\n  require always ({' and '.join(_EACH[:9])})\n}}\n"
    f"hard rule those_off {{\n  require always ({' and '.join(_EACH[9:])})\n}}\n",
    kind="compiled",
)

DAMAGED_BUNDLE = Code(
    "R0404",
    title="a file is no compiled rulebook, or one of another version",
    why="A compiled rulebook is read as a whole and checked before it judges anything. If the file "
    "is something else, was put together by hand, or was written by a version of rulec that this "
    "one does not understand, compile the source again.",
    bad="""echo '{"format": "a rulebook"}' > esterle2019.json\n"""
    "rulec maneuvers s2 -r esterle2019.json",
    good="rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
    kind="command",
)

CHANGED_BUNDLE = Code(
    "R0410",
    title="a compiled rulebook is not as it was written",
    why="A compiled rulebook begins with the SHA-256 of all that follows, so that a single bit "
    "that has changed on a disk, on the way or in an editor cannot change a verdict unseen. Line "
    "ends and spaces count. Compile the source again; if the file was edited on purpose, edit "
    "the source instead.",
    bad="rulec compile esterle2019 -o build > log\n"
    "sed 's/true/false/' build/esterle2019.json > changed.json\n"
    "rulec maneuvers s2 -r changed.json",
    good="rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
    kind="command",
)

NO_DIGEST = Code(
    "R0411",
    title="a compiled rulebook has no digest",
    why="Compiled rulebooks of versions 3 to 5 do not say what their bytes were when they were "
    "written, so a table that has changed since would judge otherwise without a word. They are "
    "not read any more: compile the source again.",
    bad="""echo '{"format": "rulec compiled rulebook", "version": 5}' > old.json\n"""
    "rulec maneuvers s2 -r old.json",
    good="rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
    kind="command",
)

_KEY = "RWQkF88c9hIe+Ip+cBE8srVQ+AZLA9rUsl5RNpje9LC8FABS7WICckWL"
_COMPILED = "rulec compile esterle2019 -o build > log\n"
NOT_SIGNED = Code(
    "R0412",
    title="a compiled rulebook is not signed by the key that is required",
    why="With `--require-signed KEY` only compiled rulebooks are taken beside which lies a "
    "signature by that key, in minisign's format: `RULEBOOK.json.minisig`. A signature of another "
    "key, of other content, without the digest (`minisign -S -l`), and none at all are refused, "
    "and so are sources, which nobody signs.",
    bad=f"{_COMPILED}rulec show build/esterle2019.json --require-signed {_KEY}",
    good=f"{_COMPILED}rulec show build/esterle2019.json",
    kind="command",
)

NO_KEY = Code(
    "R0413",
    title="a public key is none",
    why="A public key in minisign's format is a file of two lines, of which the second is Base64 "
    "of 42 bytes. Either the path of such a file is given, or that line itself.",
    bad=f"{_COMPILED}rulec show build/esterle2019.json --require-signed minisign.pub",
    good=f"{_COMPILED}rulec show build/esterle2019.json",
    kind="command",
)

NO_CRYPTOGRAPHY = Code(
    "R0414",
    title="signatures cannot be checked: the package `cryptography` is missing",
    why="Ed25519 takes the package `cryptography`, which is installed on request: "
    "`.venv/bin/python -m pip install -e '.[signed]'` in the checkout.",
    kind="circumstance",
)

_TWO_STEPS = """\
cat > soon.rules <<.
rulebook soon
signal p
hard rule soon { require eventually[<= 1 s] p }
.
echo '{"step_s": 0.5, "states": [{"p": false}, {"p": true}]}' > trace.jsonl
"""
OTHER_STEP = Code(
    "R0507",
    title="a trace has another step than a rule was compiled for",
    why="A bound in seconds is so many states of a trace, how many depends on the seconds from one "
    "to the next, `step_s`. A compiled rulebook knows the number for some steps only, which "
    "`rulec compile --step` chooses; from the source of the rulebook, every trace is judged by its "
    "own step.",
    bad=_TWO_STEPS + "rulec compile soon.rules --step 1 -o build > log\n"
    "rulec verify trace.jsonl -r build/soon.json",
    good=_TWO_STEPS + "rulec compile soon.rules --step 0.5 -o build > log\n"
    "rulec verify trace.jsonl -r build/soon.json",
    kind="command",
)
