"""Codes about rulebooks that extend others, and about options, parameters and definitions."""

from rulec.diagnostics.explanations.explanation import Explanation

OVERLAY_NAMES = {
    "R0208": Explanation(
        "an option, a parameter or a definition is not used",
        "No rule, parameter or definition of the rulebook speaks of it, so it changes nothing.",
        "rulebook example\nsignal wet\noption strict = on\nhard rule r { require not wet }\n",
        "rulebook example\nsignal wet\noption strict = on\n"
        "hard rule r { require strict implies not wet }\n",
    ),
    "R0209": Explanation(
        "a unit of measure is unknown",
        "Numbers carry units, and those of quantities, parameters and comparisons have to be known "
        "so that they can be converted into one another exactly. Capitals matter.",
        "rulebook example\nquantity speed in KMH default 0\n"
        "hard rule r { require always speed <= 50 KMH }\n",
        "rulebook example\nquantity speed in km/h default 0\n"
        "hard rule r { require always speed <= 50 km/h }\n",
    ),
    "R0210": Explanation(
        "a kind of number is unknown",
        "Behind its colon a parameter says what kind of number it is: a length, a time, a speed, "
        "an acceleration, a mass, an angle, an area, a frequency, or just a number.",
        "rulebook example\nquantity speed in km/h default 0\nparam pace : velocity = 7 km/h\n"
        "hard rule r { require always speed <= pace }\n",
        "rulebook example\nquantity speed in km/h default 0\nparam pace : speed = 7 km/h\n"
        "hard rule r { require always speed <= pace }\n",
    ),
    "R0211": Explanation(
        "the near or the far side is not known",
        "The near side is the one of the kerb: the right one where traffic drives on the right. "
        "`near_side_of` and `far_side_of` need a `traffic` line in the rulebook or in one that it "
        "extends, and a vocabulary with `left_of` and `right_of`.",
        "rulebook example\nuse road\n"
        "hard rule r (v: vehicle) { require never (beside(v) and near_side_of(v)) }\n",
        "rulebook example\ntraffic right\nuse road\n"
        "hard rule r (v: vehicle) { require never (beside(v) and near_side_of(v)) }\n",
    ),
    "R0212": Explanation(
        "there is nothing to override, drop, soften, set or redefine",
        "These words change what a rulebook inherits from the one that it extends. If that has "
        "nothing of the name, the line would have no effect.",
        'rulebook example\nextends esterle2019\ndrop rule R4 because "not in this country"\n',
        'rulebook example\nextends esterle2019\ndrop rule R3 because "not in this country"\n',
    ),
    "R0213": Explanation(
        "rulebooks extend each other in a circle",
        "Each rulebook builds upon a more general one, up to one that extends no other.",
        "printf 'rulebook a\\nextends b\\n' > a.rules\n"
        "printf 'rulebook b\\nextends a\\n' > b.rules\nrulec check a.rules\n",
        "printf 'rulebook a\\nextends b\\n' > a.rules\n"
        "printf 'rulebook b\\nsignal p\\nhard rule r { require p }\\n' > b.rules\n"
        "rulec check a.rules\n",
        "command",
    ),
    "R0214": Explanation(
        "a name is inherited already",
        "A rulebook has all rules, options, parameters and definitions of the one that it extends. "
        "To change one of them says so: `override rule`, `set`, `redefine`.",
        "rulebook example\nextends esterle2019\n"
        "hard rule R3 (p: pedestrian) { require always not (R_pc and l_p) }\n",
        "rulebook example\nextends esterle2019\n"
        "override rule R3 (p: pedestrian) {\n"
        "  require always not (R_pc and l_p)\n"
        "  accept { l_p and R_cw }\n  reject { l_p and R_pc }\n}\n",
    ),
    "R0215": Explanation(
        "a level of priority is unknown",
        "A rule's place, such as `in legal`, is one of the levels that the `priority` lines of the "
        "rulebook, or of those that it extends, put in order.",
        "rulebook example\npriority safety > legal\nsignal wet\n"
        "hard rule r in lawful { require not wet }\n",
        "rulebook example\npriority safety > legal\nsignal wet\n"
        "hard rule r in legal { require not wet }\n",
    ),
}

OVERLAY_MEANING = {
    "R0312": Explanation(
        "numbers of two kinds are put together",
        "A length is not compared with a speed, and a number without a unit not with either. Only "
        "a bare 0 fits every kind.",
        "rulebook example\nquantity speed in km/h default 0\n"
        "hard rule r { require always speed <= 50 }\n",
        "rulebook example\nquantity speed in km/h default 0\n"
        "hard rule r { require always speed <= 50 km/h }\n",
    ),
    "R0313": Explanation(
        "a number stands where something true or false is needed, or the other way round",
        "Formulas are made of what is true or false: signals, values and comparisons. Comparisons "
        "are made of numbers: quantities, parameters, counts, and numbers with their units.",
        "rulebook example\nquantity speed in km/h default 0\n"
        "hard rule r { require always not speed }\n",
        "rulebook example\nquantity speed in km/h default 0\n"
        "hard rule r { require always not speed > 0 }\n",
    ),
    "R0314": Explanation(
        "two numbers that change are multiplied or divided",
        "Comparisons are linear: numbers that states give are added, subtracted, and multiplied or "
        "divided by fixed numbers and parameters, except by 0.",
        "rulebook example\nquantity gap in m default 100\nquantity speed in m/s default 0\n"
        "hard rule r { require always gap / speed >= 2 s }\n",
        "rulebook example\nquantity gap in m default 100\nquantity speed in m/s default 0\n"
        "hard rule r { require always gap >= 2 s * speed }\n",
    ),
    "R0316": Explanation(
        "a definition or a parameter is made of itself",
        "A definition is put in the place of its name, so it cannot contain itself, not even by "
        "way "
        "of another.",
        "rulebook example\nsignal wet\ndefine slippery = wet or slippery\n"
        "hard rule r { require not slippery }\n",
        "rulebook example\nsignal wet\ndefine slippery = wet\nhard rule r { require not slippery "
        "}\n",
    ),
    "R0317": Explanation(
        "a bound of time makes no sense",
        "Bounds are fixed times or whole numbers of steps: `[<= 3 s]`, `[>= 2 steps]`, "
        "`[1 s .. 4 s]`. `next` and `previously` look at one instant: `next[2 steps]`.",
        "rulebook example\nsignal wet\nhard rule r { require eventually[4 s .. 1 s] wet }\n",
        "rulebook example\nsignal wet\nhard rule r { require eventually[1 s .. 4 s] wet }\n",
    ),
    "R0318": Explanation(
        "an exception's scope does not fit the rule",
        "Exceptions `at start`, `throughout`, `at some point` and `at end` speak of the stretch of "
        "time that a rule guards, which begins with `never` or `always`. Other rules can except "
        "what holds `initially`. What holds `throughout` phases whose length is bounded cannot "
        "be said.",
        "rulebook example\nsignal wet, fog\n"
        "hard rule r { require eventually wet unless fog throughout }\n",
        "rulebook example\nsignal wet, fog\n"
        "hard rule r { require eventually wet unless fog initially }\n",
    ),
    "R0319": Explanation(
        "a temporal operator stands in a count, a parameter or a fact",
        "The words `some`, `every` and `count` go over the objects of one moment, and a "
        "parameter is a number "
        "of one moment. What happens to one object over time is said by a variable of the rule.",
        "rulebook example\ntype car\nsignal near(c: car) default false\n"
        "hard rule r { require every c: car (always not near(c)) }\n",
        "rulebook example\ntype car\nsignal near(c: car) default false\n"
        "hard rule r { require always every c: car (not near(c)) }\n",
    ),
    "R0320": Explanation(
        "a parameter has no value on the day in question, or two",
        "Values can be dated by `in force from … until …`. The day is the one asked for, else that "
        "of the rulebook's `law` line, else today. On it there has to be one value.",
        'rulebook example\nlaw "Highway Code" as of 2019-01-01\nquantity gap in m default 9\n'
        "param least : length = 1.5 m in force from 2020-04-28\n"
        "hard rule r { require always gap >= least }\n",
        'rulebook example\nlaw "Highway Code" as of 2019-01-01\nquantity gap in m default 9\n'
        "param least : length = 1 m in force until 2020-04-27\n"
        "param least : length = 1.5 m in force from 2020-04-28\n"
        "hard rule r { require always gap >= least }\n",
    ),
    "R0321": Explanation(
        "levels of priority go round in a circle",
        "With `a > b` level a is above level b. Levels of one rank are written `a = b`.",
        "rulebook example\npriority safety > legal\npriority legal > safety\nsignal wet\n"
        "hard rule r in legal { require not wet }\n",
        "rulebook example\npriority safety > legal\nsignal wet\n"
        "hard rule r in legal { require not wet }\n",
    ),
    "R0322": Explanation(
        "a weight or a step is not above 0",
        "A weight says how much a rule counts beside others of its level, a step how far the "
        "states "
        "of examples are apart in time.",
        "rulebook example\nsignal wet\nsoft rule r weight 0 { require not wet }\n",
        "rulebook example\nsignal wet\nsoft rule r weight 1 { require not wet }\n",
    ),
    "R0323": Explanation(
        "a formula grows too large when definitions, conditions and exceptions are put in",
        "Each is put in the place where it is used. Definitions that use others twice, conditional "
        "numbers beside each other, and exceptions that hold throughout multiply.",
        "rulebook example\nsignal wet, a, b, c, d, e\nhard rule r {\n  require never (wet then "
        "not wet)\n"
        "  unless a throughout unless b throughout unless c throughout\n"
        "  unless d throughout unless e throughout\n}\n",
        "rulebook example\nsignal wet, a, b, c, d, e\nhard rule r {\n  require never (wet then "
        "not wet)\n"
        "  unless a or b or c or d or e throughout\n}\n",
    ),
}
