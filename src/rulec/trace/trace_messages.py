"""Messages about traces and the files that hold them."""

from __future__ import annotations

from rulec.diagnostics.code import Code

_GOOD = '{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "b"}}]}\n'
NOT_A_TRACE = Code(
    "R0501",
    title="a line is not a trace in JSON",
    why="A file of traces has one JSON object on each line, with a list of `states` at least. The "
    "message says what in the line is otherwise, where it ends if it has been cut short, or "
    "what the file is instead: packed, in UTF-16, a single list. `jq -c . FILE` brings JSON "
    "that is spread over lines into this form, `jq -c '.[]' FILE` a list.",
    bad='[{"position": {"v1": "b"}}]\n',
    good=_GOOD,
    kind="trace",
)

UNKNOWN_OBJECT = Code(
    "R0505",
    title="an object is unknown or of an unknown type",
    why="Every object that a state speaks of is listed in `objects`, with a type of the "
    "vocabulary that fits what is said of it.",
    bad='{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "b", "v2": "f"}}]}\n',
    good='{"objects": {"v1": "vehicle", "v2": "vehicle"}, '
    '"states": [{"position": {"v1": "b", "v2": "f"}}]}\n',
    kind="trace",
)

NO_STATES = Code(
    "R0506",
    title="a trace has no states",
    why="A trace says what was the case, state by state. Without any state there is nothing to "
    "judge.",
    bad='{"objects": {"v1": "vehicle"}, "states": []}\n',
    good=_GOOD,
    kind="trace",
)

NOT_A_TABLE = Code(
    "R0509",
    title="rows of a table are not traces",
    why="In CSV and Parquet the rows of a trace stand together, in the order of its steps, from "
    "step 0 on: for every step a row without `object` for what is about no object, and a row "
    "for each object that is there. An object's first row says its `type`.",
    bad="printf 'trace,step,object,type,position\nt1,1,v1,vehicle,b\n' > t.csv\n"
    "rulec verify t.csv -r esterle2019",
    good="printf 'trace,step,object,type,position\nt1,0,v1,vehicle,b\n' > t.csv\n"
    "rulec verify t.csv -r esterle2019",
    kind="command",
)

_TRACE = '{"id": "%s", "states": [{"speed": %s, "limit": 50}]}'
_FAST = f"printf '{_TRACE}\\n' a "
SAME_ID = Code(
    "R0512",
    title="traces of a file share an id",
    why="Verdicts, findings and tables name a trace by its id alone, so nobody can tell which of "
    "them is meant. Each is judged by itself all the same. In a table two traces with one id are "
    "often one, with rows of another trace in between.",
    bad=_FAST + "60 a 60 > t.jsonl\nrulec verify t.jsonl -r de",
    good=_FAST + "40 b 40 > t.jsonl\nrulec verify t.jsonl -r de",
    kind="command",
)

PARQUET_UNAVAILABLE = Code(
    "R0706",
    title="a Parquet file cannot be read or written here",
    why="It takes the package `pyarrow`, which is installed on request: "
    "`.venv/bin/python -m pip install -e '.[parquet]'` in the checkout. And it takes a file: a "
    "Parquet file has its table of contents at the end, so it cannot be read from a pipe.",
    bad="echo PAR1 | rulec verify - --input-format parquet -r esterle2019",
    good="echo '{\"states\": [{}]}' | rulec verify - --input-format jsonl -r esterle2019",
    kind="command",
)
