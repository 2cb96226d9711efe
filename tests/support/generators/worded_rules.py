"""Random rulebooks as text: all operators, bounds, comparisons with units, enumerations, facts."""

_FUTURE = ["always", "never", "eventually", "next", "weak next"]
_UNARY = ["not", *_FUTURE, "once", "historically", "previously", "weak previously"]
_BINARY = ["and", "or", "implies", "iff", "xor"]
_TEMPORAL = ["then", "until", "release", "weak until", "strong release", "since"]
_BESIDE = ("next", "weak next", "previously", "weak previously")
_ATOMS = [
    "p",
    "q",
    "red",
    "green",
    "speed > 30 km/h",
    "speed <= 10 m/s",
    "speed - limit >= 5 km/h",
    "speed = 50 km/h",
]
_FACTS = [
    "",
    "fact not (p and q)\n",
    "fact red implies speed <= 20 km/h\nfact not (p and green)\n",
]
_HEAD = """\
rulebook b
semantics {semantics}
signal p, q default false
light is one of red, green, off default off
quantity speed in km/h default 0
quantity limit in km/h default 0
{facts}"""


def worded_rulebook(chance, n_rules=8, most=5):
    """The text of a rulebook; formulas have up to ``most`` atoms."""
    head = _HEAD.format(semantics=chance.choice(["stutter", "finite"]), facts=chance.choice(_FACTS))
    rules = [
        f"hard rule r{n} {{ require {_formula(chance, chance.randint(1, most))} }}\n"
        for n in range(n_rules)
    ]
    return head + "".join(rules)


def _formula(chance, size):
    if size == 1 and chance.random() < 0.7:
        return chance.choice(_ATOMS)
    if size == 1 or chance.random() < 0.4:
        operator = chance.choice(_UNARY)
        inner = _formula(chance, max(1, size - 1))
        return f"{operator}{_bound(chance, operator)} ({inner})"
    operator = chance.choice(_BINARY + _TEMPORAL)
    left = chance.randint(1, size - 1)
    first, second = _formula(chance, left), _formula(chance, size - left)
    return f"({first}) {operator}{_bound(chance, operator)} ({second})"


def _bound(chance, operator):
    if operator == "not" or operator in _BINARY or chance.random() < 0.6:
        return ""
    if operator in _BESIDE:
        return f"[{chance.randint(0, 3)} steps]"
    low, high = chance.randint(0, 2), chance.randint(2, 4)
    bounds = [f"<= {high} steps", f"{low} steps .. {high} steps", f">= {low} steps", "<= 2 s"]
    return f"[{chance.choice(bounds)}]"
