"""What a witness is spared although no definition excludes it: nobody would believe it.

They are no facts: a map may show a way onto a roundabout as a junction, too, and an example may say
that ego is on a crossing without its distance to it.
"""

from __future__ import annotations

from collections.abc import Set
from functools import cache

from rulec.logic.free_names import names_in
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Axiom, Rulebook
from rulec.vocabulary import Vocabulary

_BELIEVABLE = """\
rulebook believable
use road
fact crossing implies crossing_zone
fact crossing implies distance_to_crossing <= 1 m
fact crossing_zone implies distance_to_crossing <= 10 m
fact junction_zone implies distance_to_junction <= 10 m
fact crosses_stop_line implies distance_to_stop_line <= 1 m
fact crosses_light_line implies time_to_stop_line <= 1 s
fact enters_roundabout implies not enters_junction
fact on_shoulder(o) implies not same_lane(o)
fact speed < 25 km/h implies can_stop_at_once
fact precedes(o) implies behind(o) and same_lane(o)
fact ego_car implies ego_mass <= 3.5 t
fact ego_motorcycle or ego_moped or ego_cycle implies ego_mass <= 1.5 t
fact lamps_off implies not front_fog_lamps
fact visibility >= 10 m
fact speed >= 20 km/h
soft rule none { require true }
"""


def believable(names: Set[str], vocabulary: Vocabulary) -> tuple[Axiom, ...]:
    """What is believed of states in these words of a vocabulary, if it has them from `road`.

    The last of it, if `speed` is among the words, is that ego drives.
    """
    words = _believable()
    known = {
        name
        for name in names
        if vocabulary.declarations.get(name) == words.vocabulary.declarations.get(name)
    }
    return tuple(axiom for axiom in words.axioms if known.issuperset(names_in(axiom.formula)))


@cache
def _believable() -> Rulebook:
    return parse_rulebook(_BELIEVABLE)
