"""R04: from rulebooks to automata, and what the machines then show."""

from rulec.diagnostics.explanations.explanation import Explanation

_SIGNALS = ", ".join(f"s{number}" for number in range(1, 18))
_EACH = [f"not s{number}" for number in range(1, 18)]

COMPILING = {
    "R0401": Explanation(
        "the automaton of a rule would be too large",
        "An automaton can be far larger than its formula. A rule may take 5 s of processor time "
        "and 2 GiB of memory to compile, and read 65,536 different letters (16 signals). Demands "
        "that are joined by `and` can each have a rule of their own; those automata stand beside "
        "each other instead of being multiplied.",
        f"rulebook example\nsignal {_SIGNALS}\nhard rule all_off {{\n"
        f"  require always ({' and '.join(_EACH[:9])}\n"
        f"                  and {' and '.join(_EACH[9:])})\n}}\n",
        f"rulebook example\nsignal {_SIGNALS}\n"
        f"hard rule these_off {{\n  require always ({' and '.join(_EACH[:9])})\n}}\n"
        f"hard rule those_off {{\n  require always ({' and '.join(_EACH[9:])})\n}}\n",
        "compiled",
    ),
    "R0402": Explanation(
        "the compiled automaton failed its check against the formula",
        "After every compilation the automaton is compared with the formula that it came from. If "
        "they differ there is a mistake in Spot or in rulec, none in the rulebook. Please report "
        "the rule.",
        "",
        "",
        "circumstance",
    ),
    "R0403": Explanation(
        "Spot is not installed",
        "Spot turns formulas into automata. There is a package for Linux on x86-64 (`pip install "
        "spottl`), and one for other systems (`conda install -c conda-forge spot`). A rulebook "
        "that was compiled elsewhere runs without Spot.",
        "",
        "",
        "circumstance",
    ),
    "R0404": Explanation(
        "a compiled rulebook is damaged or of another version",
        "A compiled rulebook is read as a whole and checked before it judges anything. If it was "
        "cut off, edited, or written by a version of rulec that this one does not understand, "
        "compile the source again.",
        "rulec compile esterle2019 -o build > log\n"
        "head -c 5000 build/esterle2019.json > part.json\n"
        "rulec maneuvers s2 -r part.json",
        "rulec compile esterle2019 -o build > log\nrulec maneuvers s2 -r build/esterle2019.json",
        "command",
    ),
    "R0405": Explanation(
        "a rulebook reads relations of two partitions",
        "A navigation graph knows where ego is in the relations of one partition: `position` of "
        "the paper's four regions, or `station` and `lateral` of the fine one. A rulebook that "
        "reads both can judge traces that supply both, and no graph.",
        "rulebook example\nuse paper\nlateral(o: obstacle) is one of left_of, same_lane, right_of\n"
        "hard rule r (v: vehicle) { require always not (f(v) and same_lane(v)) }\n",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) { require always not f(v) }\n",
        "maneuvers",
    ),
    "R0406": Explanation(
        "an example comes out otherwise than it says",
        "An `accept` example is a trace that the rule must allow, a `reject` example one that it "
        "must forbid. If one comes out otherwise, either the formula or the example does not say "
        "what is meant. `rulec test` runs them all.",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
        "  require always not r(v)\n  reject { b(v); l(v); f(v) }\n}\n",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
        "  require always not r(v)\n  reject { b(v); r(v); f(v) }\n}\n",
        "compiled",
    ),
    "R0407": Explanation(
        "a bound is not a multiple of the step",
        "A bound in seconds becomes a number of states, with the time from one state of a trace "
        "to the next, its step. If a bound falls between two states, nobody knows what held "
        "there. Choose a bound that is a multiple of the step, or traces with a finer one.",
        "rulebook example\nsignal wet default false\n"
        "hard rule r { require always (wet implies eventually[<= 1.5 s] not wet) }\n",
        "rulebook example\nstep 0.5 s\nsignal wet default false\n"
        "hard rule r { require always (wet implies eventually[<= 1.5 s] not wet) }\n",
        "compiled",
    ),
    "R0408": Explanation(
        "a rule is not exercised by its examples",
        "Examples show that a formula says what is meant only if it can be wrong in both ways: a "
        "trace that the rule must allow, and one that it must forbid. A rule all of whose examples "
        "it accepts would pass them also if it required nothing at all. `rulec test` says so, and "
        "with `--coverage` what else the examples do not show.",
        "rulebook example\nsignal wet, slow default false\nhard rule r {\n"
        "  require always (wet implies slow)\n  accept { not wet; wet and slow }\n}\n",
        "rulebook example\nsignal wet, slow default false\nhard rule r {\n"
        "  require always (wet implies slow)\n  accept { not wet; wet and slow }\n"
        "  reject { not wet; wet and not slow }\n}\n",
        "examples",
    ),
    "R0409": Explanation(
        "facts contradict each other",
        "A `fact` holds in every state. If several cannot hold together, or one cannot hold at "
        "all, there is no state that a rule could speak of. The message names facts that "
        "contradict each other, none of them needlessly.",
        "rulebook example\nsignal wet, fog default false\nfact wet or fog\nfact not wet\n"
        "fact not fog\nhard rule r { require always not (wet and fog) }\n",
        "rulebook example\nsignal wet, fog default false\nfact not (wet and fog)\n"
        "hard rule r { require always not wet }\n",
        "compiled",
    ),
}
