"""R02: names that stand for nothing, or for too much."""

from rulec.diagnostics.explanations.explanation import Explanation

NAMES = {
    "R0201": Explanation(
        "a type is unknown",
        "A type has to be declared in the rulebook or in a vocabulary that it uses. Names are the "
        "same only if their letters are, capitals included.",
        "rulebook example\nuse paper\nhard rule r (v: vehicel) { require always not r(v) }\n",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) { require always not r(v) }\n",
    ),
    "R0202": Explanation(
        "a name in a formula or a state is unknown",
        "A formula speaks of signals and of the values of enumerations. They have to be declared "
        "in the rulebook or in a vocabulary that it uses.",
        "rulebook example\nuse paper\nhard rule r { require always not CONGESTD }\n",
        "rulebook example\nuse paper\nhard rule r { require always not CONGESTED }\n",
    ),
    "R0203": Explanation(
        "a variable is unknown",
        "The variables of a rule are those in the parentheses behind its name, each with a type.",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) { require always not r(w) and b(v) }"
        "\n",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) { require always not r(v) and b(v) }"
        "\n",
    ),
    "R0204": Explanation(
        "a name is declared twice",
        "Types, signals, quantities, enumerations and their values share one set of names, with "
        "those of the vocabularies that are used. Give one of the two another name. Two "
        "vocabularies that share names cannot be used together.",
        "rulebook example\nsignal wet\nsurface is one of dry, wet\nhard rule r { require dry }\n",
        "rulebook example\nsignal raining\nsurface is one of dry, wet\nhard rule r { require dry }"
        "\n",
    ),
    "R0205": Explanation(
        "two rules have the same name",
        "Verdicts name the rule that is violated, and each has a file of its own when it is "
        "compiled; so every rule needs a name of its own.",
        "rulebook example\nsignal p, q\nhard rule a { require p }\nhard rule a { require q }\n",
        "rulebook example\nsignal p, q\nhard rule a { require p }\nhard rule b { require q }\n",
    ),
    "R0206": Explanation(
        "a file is of another kind or name than expected",
        "A rulebook has rules and can be compiled; a vocabulary has declarations and can be used. "
        "A vocabulary `NAME` is found in a file `NAME.rules` that begins with `vocabulary NAME`.",
        "echo 'vocabulary town { signal fog }' > town.rules\nrulec compile ./town.rules -o build",
        "echo 'vocabulary town { signal fog }' > town.rules\n"
        "echo 'rulebook city use town hard rule r { require not fog }' > city.rules\n"
        "rulec compile ./city.rules -o build",
        "command",
    ),
    "R0207": Explanation(
        "a variable is not used",
        "The rule is judged for every choice of objects for its variables. A variable that the "
        "formula never speaks of makes more choices and changes no verdict, except where there "
        "is no such object: then the rule is not judged at all.",
        "rulebook example\nuse paper\n"
        "hard rule r (v: vehicle, p: pedestrian) { require always not r(v) }\n",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) { require always not r(v) }\n",
    ),
}
