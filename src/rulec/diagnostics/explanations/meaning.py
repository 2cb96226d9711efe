"""R03: what can be read, and has no meaning or too many."""

from rulec.diagnostics.explanations.explanation import Explanation

MEANING = {
    "R0301": Explanation(
        "an atom has the wrong number of arguments",
        "A signal or an enumeration is about the world, or about as many objects as its "
        "declaration has parameters; in a formula it stands with as many variables.",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) { require f(v) or CONGESTED(v) }\n",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) { require f(v) or CONGESTED }\n",
    ),
    "R0302": Explanation(
        "an argument is of the wrong type",
        "What is declared for one type can be said of its subtypes, and of no other objects.",
        "rulebook example\ntype car\ntype pedestrian\nsignal braking(c: car)\n"
        "hard rule r (p: pedestrian) { require not braking(p) }\n",
        "rulebook example\ntype car\ntype pedestrian\nsignal braking(c: car)\n"
        "hard rule r (c: car) { require not braking(c) }\n",
    ),
    "R0303": Explanation(
        "a name stands for something that cannot be true or false",
        "Formulas are made of what is true or false in a state: signals, and values of "
        "enumerations. Quantities, types, objects and an enumeration as a whole are neither.",
        "rulebook example\nsurface is one of road, crossing\nhard rule r { require not surface }\n",
        "rulebook example\nsurface is one of road, crossing\n"
        "hard rule r { require not crossing }\n",
    ),
    "R0304": Explanation(
        "types are subtypes of one another in a circle",
        "A type can be a subtype of another, that of a third, and so on, but never of itself.",
        "rulebook example\ntype bus is vehicle\ntype vehicle is bus\nsignal p\n"
        "hard rule r { require p }\n",
        "rulebook example\ntype vehicle\ntype bus is vehicle\nsignal p\n"
        "hard rule r { require p }\n",
    ),
    "R0305": Explanation(
        "a default is not one of the values",
        "An enumeration's default is what holds where nothing is said, so it has to be one of "
        "the values.",
        "rulebook example\nlight is one of red, green default grean\nhard rule r { require red }\n",
        "rulebook example\nlight is one of red, green default green\nhard rule r { require red }\n",
    ),
    "R0306": Explanation(
        "a state of an example contradicts itself or a fact",
        "In one state a signal is true or false, an enumeration has one value, and what the "
        "vocabulary calls a `fact` holds. What a state does not say has its default, if the rule "
        "reads it. Two states, one after the other, are separated by `;`.",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
        "  require always not r(v)\n  accept { b(v) and l(v) }\n}\n",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
        "  require always not r(v)\n  accept { b(v); l(v) }\n}\n",
    ),
    "R0307": Explanation(
        "a state leaves open what has no default",
        "What an example does not say takes the default of its declaration. Without a default "
        "every state has to say it if the formula needs it: a missing value is never taken for "
        "false.",
        "rulebook example\nsignal wet, fog\nhard rule r {\n  require always not (wet and fog)\n"
        "  accept { wet }\n}\n",
        "rulebook example\nsignal wet, fog\nhard rule r {\n  require always not (wet and fog)\n"
        "  accept { wet and not fog }\n}\n",
    ),
    "R0308": Explanation(
        "a parameter's type is left out where it is not clear",
        "Without a type, `signal near(o)` is about objects of the one type that has no parent. If "
        "there are several such types, or none, the type has to be written.",
        "rulebook example\ntype vehicle\ntype pedestrian\nsignal near(o)\n"
        "hard rule r (v: vehicle) { require not near(v) }\n",
        "rulebook example\ntype vehicle\ntype pedestrian\nsignal near(o: vehicle)\n"
        "hard rule r (v: vehicle) { require not near(v) }\n",
    ),
    "R0309": Explanation(
        "a name can be read in two ways",
        "The name `b_v` is short for `b(v)`. Where the underscores of a name can be read in two "
        "ways, parentheses say which is meant.",
        "rulebook example\ntype t\nsignal a(o: t), a_b(o: t)\n"
        "hard rule r (b_c: t, c: t) { require a_b_c and a(c) and a(b_c) }\n",
        "rulebook example\ntype t\nsignal a(o: t), a_b(o: t)\n"
        "hard rule r (b_c: t, c: t) { require a_b(c) and a(c) and a(b_c) }\n",
    ),
    "R0310": Explanation(
        "a state denies a value instead of naming one",
        "In a state of an example an enumeration has exactly one value, so the state names it. "
        "That it is not one of them would leave open which it is.",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
        "  require always not r(v)\n  accept { not r(v) }\n}\n",
        "rulebook example\nuse paper\nhard rule r (v: vehicle) {\n"
        "  require always not r(v)\n  accept { l(v) }\n}\n",
    ),
    "R0311": Explanation(
        "an operator speaks of a phase before `then`, not of the sequence",
        "Operators such as `never` bind tightest, so `never a then b` means `(never a) then b`: a "
        "phase without `a`, then `b`. A whole sequence stands in parentheses.",
        "rulebook example\nsignal a, b\nhard rule r { require never a then b }\n",
        "rulebook example\nsignal a, b\nhard rule r { require never (a then b) }\n",
    ),
}
