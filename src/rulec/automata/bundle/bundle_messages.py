"""Messages about compiled rulebooks."""

from __future__ import annotations

from rulec.diagnostics.code import Code

DAMAGED_BUNDLE = Code(
    "R0404",
    title="a compiled rulebook is damaged or of another version",
    why="A compiled rulebook is read as a whole and checked before it judges anything. If it was "
    "cut off, edited, or written by a version of rulec that this one does not understand, "
    "compile the source again.",
    bad="rulec compile esterle2019 -o build > log\n"
    "head -c 5000 build/esterle2019.json > part.json\n"
    "rulec maneuvers s2 -r part.json",
    good="rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
    kind="command",
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
