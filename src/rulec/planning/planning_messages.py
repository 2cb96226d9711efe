"""Messages about evaluating navigation graphs."""

from __future__ import annotations

from rulec.diagnostics.code import Code

MOST_WORLDS = 10_000
"""The most worlds that are examined one by one for a rule that counts objects."""

TWO_PARTITIONS = Code(
    "R0405",
    title="a rulebook reads relations of two partitions",
    why="A navigation graph describes ego's position by the relations of one partition: "
    "`position` for the four regions of the paper, or `station` and `lateral` for the fine one. A "
    "rulebook that reads both can judge traces that contain both, but no graph.",
    bad="rulebook example\nuse paper\nlateral(o: obstacle) is one of left_of, same_lane, right_of\n"
    "hard rule r (v: vehicle) { require always not (f(v) and same_lane(v)) }\n",
    good="rulebook example\nuse paper\nhard rule r (v: vehicle) { require always not f(v) }\n",
    kind="maneuvers",
)

_FIRST_HALF = """\
cat > past.jsonl <<.
{"step_s": 0.5, "states": [{"surface": "R_cw"}, {"surface": "R_cw"}]}
.
"""
UNFITTING_PAST = Code(
    "R0511",
    title="a past does not end where a scenario begins",
    why="With `--after`, the maneuvers of a scenario continue a trace: the first layer is the "
    "state after the last state of the trace. So the file must contain exactly one trace, with "
    "the time step of the layers.",
    bad=_FIRST_HALF + "rulec maneuvers s2 -r esterle2019 --after past.jsonl",
    good=_FIRST_HALF + "rulec maneuvers s2 -r esterle2019 --after past.jsonl --step 0.5",
    kind="command",
)

_WEIGHTS = """\
{{ echo "rulebook many use road"; nexts="next"; w=1; for rule in $(seq 16); do
    echo "soft rule r$rule (v: vehicle) weight {weight} {{ require $nexts same_lane(v) }}"
    nexts="$nexts next"; w=$((2 * w)); done
  echo "soft rule same (v: vehicle) weight $w {{ require $nexts same_lane(v) }}"
  echo "soft rule other (v: vehicle) weight $w {{ require $nexts not same_lane(v) }}"
}} > many.rules
rulec maneuvers s2 --step 0.25 --rank 1 -r ./many.rules
"""
TOO_MANY_MANEUVERS = Code(
    "R0616",
    title="rules distinguish too many maneuvers",
    why="Maneuvers are counted and ranked together if they are in the same place, the automata of "
    "all rules are in the same state, and their violations cost the same. For rules of law there "
    "are few such states and costs, but in general there can be as many states as in the product "
    "of all automata, and as many costs as there are subsets of rules. Use fewer rules at a time, "
    "choose a larger step, or give equally important rules the same weight.",
    bad=_WEIGHTS.format(weight="$w"),
    good=_WEIGHTS.format(weight="1"),
    kind="command",
)
