"""Messages about traces that do not fit a vocabulary or a rulebook."""

from __future__ import annotations

from rulec.diagnostics.code import Code

_GOOD = '{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "b"}}]}\n'
UNDECLARED_NAME = Code(
    "R0502",
    title="a state uses a name that the vocabulary does not know",
    why="The keys of a state are names of the rulebook's vocabulary. An unknown one is an error, "
    "because a misspelt name would otherwise take its default, and be judged. So is one in the "
    "list `told` of what a source tells.",
    bad='{"objects": {"v1": "vehicle"}, "states": [{"postion": {"v1": "b"}}]}\n',
    good=_GOOD,
    kind="trace",
)

UNFITTING_VALUE = Code(
    "R0503",
    title="a state's value does not fit its declaration",
    why="A signal is true or false, an enumeration has one of its values as a text, a quantity is "
    "a finite number; what is about objects is a map from each object to these. What the "
    "vocabulary calls constant has one value in all states of a trace.",
    bad='{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "behind"}}]}\n',
    good=_GOOD,
    kind="trace",
)

MISSING_VALUE = Code(
    "R0504",
    title="a state lacks a value that has no default",
    why="What a state leaves out takes the default of its declaration. Where there is none, the "
    "value has to be there if a rule reads it: a missing value is never taken for false.",
    bad='{"objects": {"v1": "vehicle"}, "states": [{"surface": "R_cw"}]}\n',
    good=_GOOD,
    kind="trace",
)

_STANDING = """\
cat > signal.rules <<.
rulebook signal_first
signal standing, turning, indicator default false
fact not (standing and turning)
hard rule indicate { require always (standing or turning implies indicator) }
.
echo '{"states": [{"standing": %s, "turning": true, "indicator": true}]}' > trace.jsonl
rulec verify trace.jsonl -r signal.rules"""
VIOLATED_AXIOM = Code(
    "R0508",
    title="a state contradicts a fact",
    why="A vocabulary may say, by `fact`, what holds in every state. Rules are compiled for states "
    "in which it does, and say nothing of others. So a state that cannot be gets no verdict. "
    "Either the state is wrong, as when a sensor or a converter is, or the fact does not "
    "always hold. The message names the fact and the values that it speaks of.",
    bad=_STANDING % "true",
    good=_STANDING % "false",
    kind="command",
)

_SAVED = """\
cat > first.rules <<.
rulebook first
signal lights default false
hard rule light { require always lights }
.
cat > second.rules <<.
rulebook second
extends first
override rule light { require eventually lights }
.
echo '{"state": {"lights": true}}' > states.jsonl
rulec monitor first.rules --save saved.json < states.jsonl > log
"""
UNRESTORABLE_MONITOR = Code(
    "R0510",
    title="a saved monitor cannot be restored",
    why="What `rulec monitor --save` writes says in which states the automata of the rules are, "
    "and nothing of the states of the world that led there. So it means something only to the "
    "very rules that it was saved with; for others a new monitor has to begin.",
    bad=_SAVED + "rulec monitor second.rules --restore saved.json < states.jsonl",
    good=_SAVED + "rulec monitor first.rules --restore saved.json < states.jsonl",
    kind="command",
)

STEP_TOO_FAR_OFF = Code(
    "R0724",
    title="a trace's step is another one",
    why="With `rulec verify --step S` traces are judged as if their states were S seconds apart. A "
    "logger's clock makes that right for steps next to S, and wrong for all others: a bound in "
    "seconds would be another one.",
    bad="""echo '{"step_s": 0.5, "states": [{"surface": "R_cw"}]}' > t.jsonl
rulec verify t.jsonl -r esterle2019 --step 0.1""",
    good="""echo '{"step_s": 0.1001, "states": [{"surface": "R_cw"}]}' > t.jsonl
rulec verify t.jsonl -r esterle2019 --step 0.1""",
    kind="command",
)
