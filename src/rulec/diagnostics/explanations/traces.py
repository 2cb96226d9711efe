"""R05: traces that cannot be judged."""

from rulec.diagnostics.explanations.explanation import Explanation

_GOOD = '{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "b"}}]}\n'

_TWO_STEPS = """\
cat > soon.rules <<.
rulebook soon
signal p
hard rule soon { require eventually[<= 1 s] p }
.
echo '{"step_s": 0.5, "states": [{"p": false}, {"p": true}]}' > trace.jsonl
"""

_STANDING = """\
cat > signal.rules <<.
rulebook signal_first
signal standing, turning, indicator default false
fact not (standing and turning)
hard rule indicate { require always (standing or turning implies indicator) }
.
echo '{"states": [{"standing": %s, "turning": true, "indicator": true}]}' > trace.jsonl
rulec verify trace.jsonl -r signal.rules"""

_FIRST_HALF = """\
cat > past.jsonl <<.
{"step_s": 0.5, "states": [{"surface": "R_cw"}, {"surface": "R_cw"}]}
.
"""

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

TRACES = {
    "R0501": Explanation(
        "a line is not a trace in JSON",
        "A file of traces has one JSON object on each line, with a list of `states` at least. The "
        "message says what in the line is otherwise, where it ends if it has been cut short, or "
        "what the file is instead: packed, in UTF-16, a single list. `jq -c . FILE` brings JSON "
        "that is spread over lines into this form, `jq -c '.[]' FILE` a list.",
        '[{"position": {"v1": "b"}}]\n',
        _GOOD,
        "trace",
    ),
    "R0502": Explanation(
        "a state uses a name that the vocabulary does not know",
        "The keys of a state are names of the rulebook's vocabulary. An unknown one is an error, "
        "because a misspelt name would otherwise take its default, and be judged.",
        '{"objects": {"v1": "vehicle"}, "states": [{"postion": {"v1": "b"}}]}\n',
        _GOOD,
        "trace",
    ),
    "R0503": Explanation(
        "a state's value does not fit its declaration",
        "A signal is true or false, an enumeration has one of its values as a text, a quantity is "
        "a finite number; what is about objects is a map from each object to these.",
        '{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "behind"}}]}\n',
        _GOOD,
        "trace",
    ),
    "R0504": Explanation(
        "a state lacks a value that has no default",
        "What a state leaves out takes the default of its declaration. Where there is none, the "
        "value has to be there if a rule reads it: a missing value is never taken for false.",
        '{"objects": {"v1": "vehicle"}, "states": [{"surface": "R_cw"}]}\n',
        _GOOD,
        "trace",
    ),
    "R0505": Explanation(
        "an object is unknown or of an unknown type",
        "Every object that a state speaks of is listed in `objects`, with a type of the "
        "vocabulary that fits what is said of it.",
        '{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "b", "v2": "f"}}]}\n',
        '{"objects": {"v1": "vehicle", "v2": "vehicle"}, '
        '"states": [{"position": {"v1": "b", "v2": "f"}}]}\n',
        "trace",
    ),
    "R0506": Explanation(
        "a trace has no states",
        "A trace says what was the case, state by state. Without any state there is nothing to "
        "judge.",
        '{"objects": {"v1": "vehicle"}, "states": []}\n',
        _GOOD,
        "trace",
    ),
    "R0507": Explanation(
        "a trace has another step than a rule was compiled for",
        "A bound in seconds is so many states of a trace, how many depends on the seconds from one "
        "to the next, `step_s`. A compiled rulebook knows the number for one step only. `rulec "
        "compile --step` chooses it; from the source of the rulebook, every trace is judged by its "
        "own step.",
        _TWO_STEPS + "rulec compile soon.rules --step 1 -o build > log\n"
        "rulec verify trace.jsonl -r build/soon.json",
        _TWO_STEPS + "rulec compile soon.rules --step 0.5 -o build > log\n"
        "rulec verify trace.jsonl -r build/soon.json",
        "command",
    ),
    "R0508": Explanation(
        "a state contradicts a fact",
        "A vocabulary may say, by `fact`, what holds in every state. Rules are compiled for states "
        "in which it does, and say nothing of others. So a state that cannot be gets no verdict. "
        "Either the state is wrong, as when a sensor or a converter is, or the fact does not "
        "always hold. The message names the fact and the values that it speaks of.",
        _STANDING % "true",
        _STANDING % "false",
        "command",
    ),
    "R0509": Explanation(
        "rows of a table are not traces",
        "In CSV and Parquet the rows of a trace stand together, in the order of its steps, from "
        "step 0 on: for every step a row without `object` for what is about no object, and a row "
        "for each object that is there. An object's first row says its `type`.",
        "printf 'trace,step,object,type,position\nt1,1,v1,vehicle,b\n' > t.csv\n"
        "rulec verify t.csv -r esterle2019",
        "printf 'trace,step,object,type,position\nt1,0,v1,vehicle,b\n' > t.csv\n"
        "rulec verify t.csv -r esterle2019",
        "command",
    ),
    "R0510": Explanation(
        "a saved monitor cannot be restored",
        "What `rulec monitor --save` writes says in which states the automata of the rules are, "
        "and nothing of the states of the world that led there. So it means something only to the "
        "very rules that it was saved with; for others a new monitor has to begin.",
        _SAVED + "rulec monitor second.rules --restore saved.json < states.jsonl",
        _SAVED + "rulec monitor first.rules --restore saved.json < states.jsonl",
        "command",
    ),
    "R0511": Explanation(
        "a past does not lead up to a scenario",
        "With `--after` the maneuvers of a scenario go on where a trace has ended: the first layer "
        "is the state after its last one. So there is one such trace, its states are as far apart "
        "as the layers, and who is in both is of the same type in both.",
        _FIRST_HALF + "rulec maneuvers s2 -r esterle2019 --after past.jsonl",
        _FIRST_HALF + "rulec maneuvers s2 -r esterle2019 --after past.jsonl --step 0.5",
        "command",
    ),
}
