"""Mistakes by the structure of what they are in: words of a source, values of JSON, or bytes."""

import json
import re
from copy import deepcopy

from support.generators.mutated_files import mutated_bytes

TOKEN = re.compile(r'"[^"\n]*"|\w+|[<>=!]=|\S|\s+')
STRANGE_WORDS = (
    "\u202e",
    "\u0455top",
    "\x1b]0;own\x07",
    "\n::error::own\n",
    "1e999999999",
    "0." + "0" * 400 + "1",
    "9" * 400,
    "-0",
    "nan",
    "(" * 300,
    "not " * 300,
    "always eventually " * 30,
    "next[1e9 steps]",
    "\ufeff",
    "\0",
    '"',
    "#",
)
STRANGE_VALUES = (
    None,
    True,
    -1,
    0,
    1e308,
    float("nan"),
    float("inf"),
    10**400,
    9007199254740993,
    "",
    "1e9999999",
    "\ud800",
    "\n::error::own\n",
    "\x1b[2J",
    "x" * 10_000,
    [],
    {},
    [[]] * 50,
    {"": {}},
)


def mutated_words(text, pick, others):
    """A source with some of its words changed for others', gone, twice, or for strange ones."""
    tokens = TOKEN.findall(text)
    for _ in range(pick.choice((1, 1, 2, 3, 8))):
        at, length = pick.randrange(len(tokens) + 1), pick.choice((1, 1, 1, 2, 5, 20))
        match pick.randrange(6):
            case 0:
                tokens[at : at + length] = []
            case 1:
                tokens[at : at + length] = tokens[at : at + length] * 2
            case 2:
                tokens[at : at + 1] = [pick.choice(STRANGE_WORDS)]
            case 3:
                tokens[at : at + 1] = [pick.choice(tokens or [""])]
            case _:
                other = TOKEN.findall(pick.choice(others))
                start = pick.randrange(len(other) + 1)
                tokens[at : at + length] = other[start : start + length]
    text = "".join(tokens)
    if pick.random() < 0.1:
        return mutated_bytes(text.encode(), pick)
    return text.encode("utf-8", "surrogatepass")


def mutated_json(text, pick):
    """JSON, or lines of it, with some values changed for others, gone, or for strange ones."""
    if pick.random() < 0.15:
        return mutated_bytes(text.encode(), pick)
    lines = text.splitlines() if text.count("\n{") else [text]
    number = pick.randrange(len(lines))
    content = [json.loads(lines[number])]
    for _ in range(pick.choice((1, 1, 2, 3))):
        _change(content, pick)
    # Of what stands at the top nothing may be left
    lines[number] = json.dumps(content[0]) if content else ""
    return "\n".join(lines).encode("utf-8", "surrogatepass")


def _change(content, pick):
    holder, key = content, 0
    while isinstance(holder[key], dict | list) and holder[key] and pick.random() < 0.85:
        holder = holder[key]
        key = pick.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
    match pick.randrange(5):
        case 0 if holder is not content:
            del holder[key]
        case 1 if isinstance(holder, list) and holder is not content:
            holder.insert(key, deepcopy(pick.choice(holder)))
        case 2 if isinstance(holder, dict):
            holder[pick.choice(("", "x\n::error::own", "\ud800", "step_s"))] = deepcopy(holder[key])
        case 3:
            holder[key] = pick.choice((deepcopy(content), str(holder[key]), [holder[key]]))
        case _:
            holder[key] = deepcopy(pick.choice(STRANGE_VALUES))
