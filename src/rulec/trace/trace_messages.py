"""Messages about traces and the files that hold them."""

from __future__ import annotations

from rulec.diagnostics.code import Code

_GOOD = '{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "b"}}]}\n'
NOT_A_TRACE = Code(
    "R0501",
    title="a line is not a trace in JSON",
    why="A file of traces has one JSON object on each line, with at least a list of `states`. The "
    "message says what is wrong with the line, where it ends if it was cut short, or what the "
    "file is instead: compressed, in UTF-16, or a single list. `jq -c . FILE` converts JSON that "
    "is spread over several lines, `jq -c '.[]' FILE` a list.",
    bad='[{"position": {"v1": "b"}}]\n',
    good=_GOOD,
    kind="trace",
)

UNKNOWN_OBJECT = Code(
    "R0505",
    title="an object is unknown or of an unknown type",
    why="Every object in a state must be listed in `objects`, with a type of the vocabulary that "
    "fits its values.",
    bad='{"objects": {"v1": "vehicle"}, "states": [{"position": {"v1": "b", "v2": "f"}}]}\n',
    good='{"objects": {"v1": "vehicle", "v2": "vehicle"}, '
    '"states": [{"position": {"v1": "b", "v2": "f"}}]}\n',
    kind="trace",
)

NO_STATES = Code(
    "R0506",
    title="a trace has no states",
    why="A trace describes a drive state by state. Without states there is nothing to judge.",
    bad='{"objects": {"v1": "vehicle"}, "states": []}\n',
    good=_GOOD,
    kind="trace",
)

NOT_A_TABLE = Code(
    "R0509",
    title="rows of a table are not traces",
    why="In CSV and Parquet, the rows of a trace are consecutive and in the order of its steps, "
    "from step 0 on: for each step one row without `object` for values about no object, and one "
    "row for each object that is present. The first row of an object gives its `type`.",
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
    why="Verdicts, findings and tables identify a trace by its id alone, so it is unclear which "
    "of them they refer to. Each trace is judged nevertheless. In a table, two traces with one id "
    "are often a single trace interrupted by rows of another.",
    bad=_FAST + "60 a 60 > t.jsonl\nrulec verify t.jsonl -r de",
    good=_FAST + "40 b 40 > t.jsonl\nrulec verify t.jsonl -r de",
    kind="command",
)

PARQUET_UNAVAILABLE = Code(
    "R0706",
    title="a Parquet file cannot be read or written here",
    why="Parquet needs the package `pyarrow`, which is installed on request: `.venv/bin/python -m "
    "pip install -e '.[parquet]'` in the checkout. It also needs a file: a Parquet file has its "
    "table of contents at the end, so it cannot be read from a pipe.",
    bad="echo PAR1 | rulec verify - --input-format parquet -r esterle2019",
    good="echo '{\"states\": [{}]}' | rulec verify - --input-format jsonl -r esterle2019",
    kind="command",
)
