"""A vocabulary that has one of everything, for random rulebooks and traces."""

from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary

WORLD = Vocabulary(
    "world",
    {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")},
    {
        "place": Enumeration("place", ("thing",), ("near", "far", "gone")),
        "light": Enumeration("light", (), ("red", "green"), "red"),
        "p": Signal("p", (), False),
        "q": Signal("q", (), None),
        "loud": Signal("loud", ("thing",), False),
        "follows": Signal("follows", ("thing", "thing"), False),
        "speed": Quantity("speed", (), "m/s"),
        "pace": Quantity("pace", (), "m/s", 1.0),
        "gap": Quantity("gap", ("thing",), "m"),
        "apart": Quantity("apart", ("thing", "thing"), "m", 0.3),
    },
)
