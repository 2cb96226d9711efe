"""Messages about traces that do not fit a vocabulary or a rulebook."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

_GOOD = '{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "b"}}]}\n'
UNDECLARED_NAME = Code(
    "R0502",
    title="a state uses a name that the vocabulary does not have",
    why="The keys of a state are names of the rulebook's vocabulary. Unknown ones are errors, "
    "because otherwise a misspelt name would silently have its default. The same holds for the "
    "list `told` of names that a source provides.",
    bad='{"objects": {"v1": "vehicle"}, "states": [{"postion": {"v1": "b"}}]}\n',
    good=_GOOD,
    kind="trace",
)

UNFITTING_VALUE = Code(
    "R0503",
    title="a state's value does not fit its declaration",
    why="A signal is true or false, an enumeration has one of its values as a text, and a "
    "quantity is a finite number; a value about objects is a map from each object to one of "
    "these. A constant of the vocabulary has the same value in all states of a trace.",
    bad='{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "behind"}}]}\n',
    good=_GOOD,
    kind="trace",
)

MISSING_VALUE = Code(
    "R0504",
    title="a state lacks a value that has no default",
    why="Values that a state leaves out have the default of their declaration. Without a default, "
    "the value must be given if a rule reads it: a missing value is never taken to be false.",
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
    why="A vocabulary may state by `fact` what holds in every state. Rules are compiled for such "
    "states only, so an impossible state gets no verdict. Either the state is wrong, for instance "
    "because of a sensor or a converter, or the fact does not always hold. The message names the "
    "fact and the values concerned.",
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
    why="The file written by `rulec monitor --save` contains the states of the rules' automata, "
    "not the states of the world that led there. So it is valid only for the rules that it was "
    "saved with; for others, start a new monitor.",
    bad=_SAVED + "rulec monitor second.rules --restore saved.json < states.jsonl",
    good=_SAVED + "rulec monitor first.rules --restore saved.json < states.jsonl",
    kind="command",
)

STEP_TOO_FAR_OFF = Code(
    "R0724",
    title="a trace has another time step",
    why="With `rulec verify --step S`, traces are judged as if their states were S seconds apart. "
    "This is right for steps close to S, such as the jitter of a logger's clock causes, and wrong "
    "for all others, since bounds in seconds would change.",
    bad="""echo '{"step_s": 0.5, "states": [{"surface": "R_cw"}]}' > t.jsonl
rulec verify t.jsonl -r esterle2019 --step 0.1""",
    good="""echo '{"step_s": 0.1001, "states": [{"surface": "R_cw"}]}' > t.jsonl
rulec verify t.jsonl -r esterle2019 --step 0.1""",
    kind="command",
)


def missing_value(
    subject: tuple[str, tuple[str, ...]], where: str, rule: str, place: SourceLocation | None
) -> RulecError:
    """The error (R0504) about a state that lacks the value of a name for some objects."""
    name, items = subject
    of = f" of `{', '.join(map(str, items))}`" if items else ""  # a program may count its objects
    return MISSING_VALUE.error(
        place,
        f"{where} does not say the `{name}`{of}, which rule `{rule}` needs",
        help="say it in every state, `null` where it is not known, or declare a default for it",
    )
