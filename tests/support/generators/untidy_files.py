"""Hypothesis strategies for whole files as nobody should write them: white space at random."""

import re
from random import Random

from hypothesis import strategies as st

from rulec.diagnostics import Source
from rulec.syntax import parse, tree
from rulec.syntax.keywords import PRECEDENCE, SYMBOLS, UNARY_OPERATORS
from support.builders.printed_files import print_file
from support.generators.syntax_trees import names, texts

LONG = st.text("abcdefghij_", min_size=1, max_size=12).filter(lambda text: text != "_")
OTHERS = {"and": "&&", "or": "||", "always": "[]", "eventually": "<>"}

some_names = st.one_of(
    st.sampled_from(["p", "q", "behind", "v", "w"]).map(tree.Name),
    names,
    LONG.map(lambda text: tree.Name(f"n_{text}")),
)


def _lists(of, least=0, most=4):
    return st.lists(of, min_size=least, max_size=most).map(tuple)


numbers = st.builds(
    tree.NumberLiteral,
    st.sampled_from(["0", "7", "1.5", "2e3", "1.5e-3", "007"]),
    st.sampled_from(["", "s", "steps", "km/h", "m/s^2", "%"]),
)
atoms = st.builds(tree.AtomUse, some_names, _lists(some_names, most=2))
amounts = numbers | some_names.map(tree.AtomUse)
bounds = st.one_of(
    st.builds(lambda high: tree.BoundNode(None, high), amounts),
    st.builds(lambda low: tree.BoundNode(low, None), amounts),
    st.builds(tree.BoundNode, amounts, amounts),
    st.builds(lambda one: tree.BoundNode(one, one, exact=True), amounts),
)
BOUNDED = {word for word in SYMBOLS if word in ("then", "until", "since", "always", "next", "once")}


@st.composite
def operations(draw, inner):
    """An operation of any kind, spelled and grouped in any way."""
    grouped = draw(st.booleans())
    match draw(st.integers(0, 6)):
        case 0 | 1:
            word = draw(st.sampled_from(sorted(PRECEDENCE)))
            sides, kind = (draw(inner), draw(inner)), tree.Infix
        case 2 | 3:
            word = draw(st.sampled_from(UNARY_OPERATORS))
            sides, kind = (draw(inner),), tree.Prefix
        case 4:
            relation = draw(st.sampled_from(["<", "<=", "=", "!=", ">=", ">"]))
            return tree.Compare(relation, draw(inner), draw(inner), grouped=grouped)
        case 5:
            if draw(st.booleans()):
                return tree.Minus(draw(inner), grouped=grouped)
            sign = draw(st.sampled_from("+-*/"))
            return tree.Arithmetic(sign, draw(inner), draw(inner), grouped=grouped)
        case _:
            if draw(st.booleans()):
                return tree.Conditional(draw(inner), draw(inner), draw(inner), grouped=grouped)
            variable = tree.Parameter(draw(some_names), draw(some_names))
            kind = draw(st.sampled_from(["some", "every", "count"]))
            return tree.Aggregate(kind, variable, draw(inner))
    sign = draw(st.sampled_from([word, SYMBOLS[word], OTHERS.get(word, word)]))
    bound = draw(st.none() | bounds) if word in BOUNDED else None
    return kind(word, *sides, bound, sign=sign, grouped=grouped)


formulas = st.recursive(
    atoms | numbers | st.builds(tree.TruthLiteral, st.booleans()), operations, max_leaves=20
).filter(lambda one: not isinstance(one, tree.Conditional))
values = st.one_of(formulas, st.builds(tree.Conditional, formulas, formulas, formulas))

days = st.dates().map(lambda day: day.isoformat())
in_force = st.one_of(
    st.builds(tree.InForce, days, st.just("") | days), st.builds(tree.InForce, st.just(""), days)
)
maybe = st.none()
parameters = _lists(st.builds(tree.Parameter, some_names, maybe | some_names))
variables = _lists(st.builds(tree.Parameter, some_names, some_names))
weights = st.sampled_from(["0", "2", "1.5"]).map(tree.NumberLiteral)
declarations = st.one_of(
    st.builds(tree.TypeItem, some_names, maybe | some_names),
    st.builds(
        tree.EnumerationItem, some_names, parameters, _lists(some_names, 1, 9), maybe | some_names
    ),
    st.builds(
        tree.SignalItem,
        _lists(st.builds(tree.SignalHead, some_names, parameters), 1, 9),
        maybe | st.booleans(),
    ),
    st.builds(
        tree.QuantityItem,
        some_names,
        parameters,
        st.sampled_from(["m", "km/h", "m/s^2", "%", "Nm", "µm"]),
        maybe | st.sampled_from([0.0, -1.5, 2e30, 1e-7]),
    ),
    st.builds(tree.FactItem, formulas),
    st.builds(tree.ConstantItem, _lists(some_names, 1, 9)),
    st.builds(tree.PresumedItem, _lists(some_names, 1, 9)),
)
provisions = st.one_of(
    st.builds(tree.OptionItem, some_names, st.booleans()),
    st.builds(tree.ParamItem, some_names, maybe | some_names, values, maybe | in_force),
    st.builds(tree.SetItem, some_names, values, maybe | in_force),
    st.builds(tree.SetItem, some_names, st.booleans()),
    st.builds(tree.DefineItem, some_names, parameters, formulas, st.booleans()),
    st.builds(tree.DropItem, some_names, texts),
    st.builds(tree.SoftenItem, some_names, maybe | some_names, maybe | weights, maybe | texts),
    st.builds(tree.SilentItem, some_names, texts),
)
literals = st.one_of(
    st.builds(tree.StateLiteral, atoms, st.booleans()),
    st.builds(tree.StateLiteral, atoms, st.just(False), numbers | numbers.map(tree.Minus)),
)
examples = st.builds(
    tree.ExampleItem,
    st.booleans(),
    _lists(st.builds(tree.ExampleState, _lists(literals, 0)), 1),
    texts.map(lambda text: text.value) | st.just(""),
    variables,
)
scopes = st.sampled_from([None, "initially", "at start", "throughout", "at some point", "at end"])
rules = st.builds(
    tree.RuleItem,
    st.sampled_from(["hard", "soft"]),
    some_names,
    variables,
    formulas,
    maybe | texts,
    maybe | texts,
    _lists(examples),
    level=maybe | some_names,
    weight=maybe | weights,
    override=st.booleans(),
    unless=_lists(st.builds(tree.Unless, formulas, scopes), most=2),
    when=maybe | formulas,
    source=maybe | texts,
    certainty=st.sampled_from(["", "verified", "unverified"]),
    in_force=maybe | in_force,
)
priorities = st.lists(some_names, min_size=2, max_size=9).flatmap(
    lambda levels: st.builds(
        tree.PriorityLine,
        st.just(tuple(levels)),
        st.lists(st.sampled_from(">="), min_size=len(levels) - 1, max_size=len(levels) - 1).map(
            tuple
        ),
    )
)
rulebooks = st.builds(
    lambda items, rule, *rest, **more: tree.File("rulebook", *rest, items=(*items, rule), **more),
    _lists(declarations | provisions | rules),
    rules,
    some_names,
    maybe | st.builds(tree.TitleLine, texts),
    maybe | st.builds(tree.LawLine, texts, st.just("") | days),
    st.lists(names, max_size=2, unique=True).map(lambda some: tuple(map(tree.UseLine, some))),
    extends=maybe | st.builds(tree.ExtendsLine, some_names),
    traffic=maybe | st.just(tree.TrafficLine("left")),
    semantics=maybe | st.just(tree.SemanticsLine("finite")),
    step=maybe | st.builds(tree.StepLine, numbers),
    priorities=_lists(priorities, most=2),
)
vocabularies = st.builds(
    lambda name, items: tree.File("vocabulary", name, items=items),
    some_names,
    _lists(declarations),
)
files = rulebooks | vocabularies

COMMENTS = [
    "#",
    "# c",
    "#c  ",
    "## (",
    "# }",
    '# "',
    "#\té;",
    "# 車 \x85 \u2028x",
    f"# {'long ' * 9}",
]
BLANKS = [" ", " ", " ", "  ", "\t"]
LINE_ENDS = ["\n", "\n", "\n\n", "\n   \n\n"]
GOES_ON = set(";,({=&|!+*") | {"and", "or", "implies", "then", "until", "not", "always", "->", "G"}

_TOKENS = re.compile(
    r"""
      "(?:[^"\\\n]|\\.)*"                                # texts
    | [0-9]+-[0-9]+-[0-9]+                               # dates
    | [0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?            # numbers
    | at\ (?:some\ point|start|end)\b | (?:weak|strong)\ \w+
    | (?:[%°]|[^\W\d]\w*\^-?[0-9]+|[^\W\d]\w*(?:/[^\W\d]\w*(?:\^-?[0-9]+)?)+)   # units
    | [^\W\d]\w*
    | <-> | -> | <= | >= | != | && | \|\| | \[\] | <> | \.\. | \S
    """,
    re.VERBOSE,
)
_OR_LINE_END = re.compile(rf"\n|{_TOKENS.pattern}", re.VERBOSE)


def untidied(text, seed):
    """A printed file with other white space, and with comments, between any two tokens.

    Most have no mistakes; a line that ends in the middle of nothing may be taken for the beginning
    of something else.
    """
    choose = Random(seed)
    pieces = [choose.choice(["", "\n", "# first\n\n"])]
    for token in _OR_LINE_END.findall(text):
        if token == "\n":
            pieces.append(choose.choice(LINE_ENDS))
            continue
        ends = choose.randrange(3 if token in GOES_ON else 60) == 0
        pieces += [token, choose.choice(LINE_ENDS if ends else BLANKS)]
        if choose.randrange(16) == 0:
            pieces += [choose.choice(COMMENTS), "\n", choose.choice(["", "\n", "  "])]
    return "".join(pieces)


untidy_files = st.builds(
    untidied, files.map(lambda file: print_file(file, "written")), st.integers()
)

_OPERATORS = st.sampled_from(["not", "always", "never", "eventually", "next", "once", "weak next"])
_JOINS = st.sampled_from(["and", "or", "xor", "implies", "iff", "until", "since", "then"])
_PLAIN = st.sampled_from(["p", "r(v)", "true", "d <= 2", "some x: a (r(x))", "p or q"])


@st.composite
def loose_formulas(draw):
    """The text of a formula with parentheses anywhere, also where they group nothing."""
    text = ""
    for join in ["", *draw(st.lists(_JOINS, min_size=1, max_size=3))]:
        operand = draw(_PLAIN)
        for operator in [*draw(st.lists(_OPERATORS, max_size=2)), ""]:
            operand = f"{operator} ({operand})" if draw(st.booleans()) else f"{operator} {operand}"
        text += f" {join} {operand}"
    return text


def tree_of(text):
    """The tree of a text; None if it has mistakes."""
    file, mistakes = parse(Source("text", text))
    return None if mistakes else file
