"""Messages about evaluating navigation graphs."""

from __future__ import annotations

from rulec.diagnostics.code import Code

TWO_PARTITIONS = Code(
    "R0405",
    title="a rulebook reads relations of two partitions",
    why="A navigation graph knows where ego is in the relations of one partition: `position` of "
    "the paper's four regions, or `station` and `lateral` of the fine one. A rulebook that "
    "reads both can judge traces that supply both, and no graph.",
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
    title="a past does not lead up to a scenario",
    why="With `--after` the maneuvers of a scenario go on where a trace has ended: the first layer "
    "is the state after its last one. So there is one such trace, and its states are as far "
    "apart as the layers.",
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
    title="rules keep too many maneuvers apart",
    why="Maneuvers are counted and ranked together where they are at one place, the automata of "
    "all rules are in one state, and what is violated costs the same. Rules of the law come to "
    "few such states and costs, but there can be as many states as the product of all automata "
    "has, and as many costs as rules have subsets. Judge by fewer rules at a time, choose a "
    "larger step, or let rules that matter alike have one weight.",
    bad=_WEIGHTS.format(weight="$w"),
    good=_WEIGHTS.format(weight="1"),
    kind="command",
)
