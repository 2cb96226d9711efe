"""Edits of a rulebook's text as authors make them, and as nobody does."""

import re

TYPED = (
    *("{", "}", '"', "'", "(", ")", "#", ";", " ", "\n", "\n\n", "<= 3 m", "é", "\u202e", "\r\n"),
    *("not ", "and ", "always ", "unless ", "accept { ", "hard rule x {", "override rule "),
    *(
        "define q = ",
        "define fast = slow\n",
        "param a : time = 3 s\n",
        "set ",
        "signal b default false\n",
    ),
    *(
        "type ",
        "extends ",
        "use road\n",
        "vocabulary ",
        "topics { ",
        "priority a > b\n",
        "_x",
        "(x)",
    ),
)


def edited(text, original, random):
    """The text after one edit; now and then it is the original again."""
    at = random.randrange(len(text) + 1)
    match random.randrange(8):
        case 0 | 1 | 2:
            return text[:at] + random.choice(TYPED) + text[at:]
        case 3:
            return text[:at] + random.choice(re.findall(r"\w+", original)) + text[at:]
        case 4:
            return text[:at] + text[at + random.randrange(1, 6) :]
        case 5:
            return text[:at] + text[at + random.randrange(1, 200) :]
        case 6:
            begin = random.randrange(len(original))
            return text[:at] + original[begin : begin + random.randrange(200)] + text[at:]
        case _:
            return original
