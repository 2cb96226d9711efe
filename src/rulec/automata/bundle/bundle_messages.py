"""Messages about compiled rulebooks."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

_SIGNALS = ", ".join(f"s{number}" for number in range(1, 18))
_EACH = [f"not s{number}" for number in range(1, 18)]

AUTOMATON_TOO_LARGE = Code(
    "R0401",
    title="the automaton of a rule would be too large",
    why="An automaton can be far larger than its formula. While it is built it may have 20,000 "
    "states and 1,000,000 edges and take 2 GiB of memory; the rule may need as many acceptance "
    "sets as Spot has, 32, and read 65,536 different letters (16 signals). Requirements joined by "
    "`and` can be put into separate rules, whose automata are not multiplied.",
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
    title="a file is not a compiled rulebook, or one of another version",
    why="A compiled rulebook is read completely and checked before it is used. If the file is "
    "something else, was edited by hand, or was written by an incompatible version of rulec, "
    "compile the source again.",
    bad="""echo '{"format": "a rulebook"}' > esterle2019.json\n"""
    "rulec maneuvers s2 -r esterle2019.json",
    good="rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
    kind="command",
)

CHANGED_BUNDLE = Code(
    "R0410",
    title="a compiled rulebook has been changed since it was written",
    why="A compiled rulebook begins with the SHA-256 of the rest, so that no change on disk, in "
    "transit or in an editor can alter a verdict unnoticed. Line ends and spaces count. Compile "
    "the source again; if the file was edited on purpose, edit the source instead.",
    bad="rulec compile esterle2019 -o build > log\n"
    "sed 's/true/false/' build/esterle2019.json > changed.json\n"
    "rulec maneuvers s2 -r changed.json",
    good="rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
    kind="command",
)

NO_DIGEST = Code(
    "R0411",
    title="a compiled rulebook has no digest",
    why="Compiled rulebooks of versions 3 to 5 have no checksum, so a changed table could give "
    "wrong verdicts unnoticed. They are no longer read: compile the source again.",
    bad="""echo '{"format": "rulec compiled rulebook", "version": 5}' > old.json\n"""
    "rulec maneuvers s2 -r old.json",
    good="rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
    kind="command",
)

_KEY = "RWQkF88c9hIe+Ip+cBE8srVQ+AZLA9rUsl5RNpje9LC8FABS7WICckWL"
_COMPILED = "rulec compile esterle2019 -o build > log\n"
NOT_SIGNED = Code(
    "R0412",
    title="a compiled rulebook is not signed by the required key",
    why="With `--require-signed KEY` a compiled rulebook is accepted only if a signature by that "
    "key, in minisign's format, is beside it: `RULEBOOK.json.minisig`. Signatures by another key, "
    "of other content, without the digest (`minisign -S -l`), and missing ones are refused, as "
    "are sources, which are never signed.",
    bad=f"{_COMPILED}rulec show build/esterle2019.json --require-signed {_KEY}",
    good=f"{_COMPILED}rulec show build/esterle2019.json",
    kind="command",
)

NO_KEY = Code(
    "R0413",
    title="a public key is invalid",
    why="A public key in minisign's format is a file of two lines, the second of which is Base64 "
    "of 42 bytes. Give either the path of such a file or that line itself.",
    bad=f"{_COMPILED}rulec show build/esterle2019.json --require-signed minisign.pub",
    good=f"{_COMPILED}rulec show build/esterle2019.json",
    kind="command",
)

NO_CRYPTOGRAPHY = Code(
    "R0414",
    title="signatures cannot be checked: the package `cryptography` is missing",
    why="Checking Ed25519 signatures needs the package `cryptography`, which is installed on "
    "request: `.venv/bin/python -m pip install -e '.[signed]'` in the checkout.",
    kind="circumstance",
)

_TWO_STEPS = """\
cat > soon.rules <<.
rulebook soon
signal p
hard rule soon { require eventually (p and eventually[<= 1 s] not p) }
.
echo '{"step_s": 0.5, "states": [{"p": true}, {"p": false}]}' > trace.jsonl
"""
OTHER_STEP = Code(
    "R0507",
    title="a trace has a step that a rule was not compiled for",
    why="Bounds in seconds are clocks in a compiled rulebook, which judge traces of any time step "
    "`step_s`. A bound that begins at some instant or other is none: such a rule is for the step "
    "of `rulec compile --step` alone. With the source of the rulebook, every trace is judged by "
    "its own step.",
    bad=_TWO_STEPS + "rulec compile soon.rules --step 1 -o build > log\n"
    "rulec verify trace.jsonl -r build/soon.json",
    good=_TWO_STEPS + "rulec compile soon.rules --step 0.5 -o build > log\n"
    "rulec verify trace.jsonl -r build/soon.json",
    kind="command",
)

OTHER_DAY = Code(
    "R0419",
    title="a compiled rulebook is for the law of another day",
    why="Rules and parameters that are not in force on a day are left out when a rulebook is "
    "compiled, so a compiled rulebook has the law of one day. With the source of the rulebook, "
    "`--at` chooses the day.",
    bad="rulec compile esterle2019 --at 2024-01-01 -o build > log\n"
    "rulec show build/esterle2019.json --at 2026-01-01",
    good="rulec compile esterle2019 --at 2026-01-01 -o build > log\n"
    "rulec show build/esterle2019.json --at 2026-01-01",
    kind="command",
)


def other_day(file: str, compiled: str, wanted: str) -> RulecError:
    """A file compiled for the law of one day, where that of another one is wanted."""
    return OTHER_DAY.error(
        SourceLocation(file),
        f"this rulebook was compiled for the law of {compiled}, not of {wanted}",
        help=f"compile its source with `--at {wanted}`, or leave out `--at`",
    )
