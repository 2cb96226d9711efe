"""Help for chains of comparisons."""

from __future__ import annotations

from typing import Final

from rulec.syntax.keywords import RESERVED
from rulec.syntax.messages.parse_context import ParseContext

RELATIONS: Final = ("<", "<=", "=", "!=", ">=", ">")
"""The signs of comparisons."""


def advise_on_chain(scene: ParseContext) -> str:
    """Advice on ``a < b < c``: compare two at a time."""
    last = next((at for at in range(scene.at - 1, -1, -1) if scene.text_at(at) in RELATIONS), None)
    if last is None:
        return ""

    def part(first: int, behind: int) -> str:
        return scene.source.text[scene.tokens[first].start : scene.tokens[behind - 1].end]

    left, right = _back(scene, last), _forward(scene, scene.at + 1)
    if left == last or last + 1 >= scene.at or right == scene.at + 1:
        return "compare two at a time: `a < b and b < c`"
    middle = part(last + 1, scene.at)
    first, second = part(left, scene.at), part(scene.at, right)
    whole = f"{first} and {middle} {second}"
    return "compare two at a time: " + (
        f"write `{whole}`" if len(whole) <= 60 and "\n" not in whole else "`a < b and b < c`"
    )


def _belongs(scene: ParseContext, at: int) -> bool:
    token = scene.token(at)
    if token is None:
        return False
    if token.kind == "word":
        return token.text not in RESERVED
    return token.kind == "number" or token.text in ("+", "-", "*", "/", ".", ",", "(", ")", "^")


def _back(scene: ParseContext, at: int) -> int:
    depth = 0
    while _belongs(scene, at - 1):
        depth += (scene.text_at(at - 1) == ")") - (scene.text_at(at - 1) == "(")
        if depth < 0:
            break
        at -= 1
    return at


def _forward(scene: ParseContext, at: int) -> int:
    depth = 0
    while _belongs(scene, at):
        depth += (scene.text_at(at) == "(") - (scene.text_at(at) == ")")
        if depth < 0:
            break
        at += 1
    return at
