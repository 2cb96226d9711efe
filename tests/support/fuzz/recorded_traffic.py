"""Targets of recorded traffic and maps: small files of every format with mistakes in them."""

import shutil
from functools import cache

from support.mutations.format_samples import MAPS, RECORDINGS

TRACKS = "track,t,x,y,type\n" + "".join(
    f"{car},{step / 10},{5 * car + step},{y},car\n"
    for car, y in ((1, 0), (2, 3.5))
    for step in range(12)
)
"""Two who drive on, and no roads."""
BOOKS = ("esterle2019", "esterle2019", "esterle2019", "vienna")


@cache
def _samples(samples):
    """Samples of a format, their files as they are packed, and these whole."""
    packed = [(sample, sample.packed()) for sample in samples()]
    return [(one, of, {name: file.whole() for name, file in of.items()}) for one, of in packed]


def _written(place, pick, formats):
    """A sample of some format in a folder of its own, with mistakes in one of its files."""
    sample, packed, whole = pick.choice(_samples(formats[pick.choice(list(formats))]))
    broken = pick.choice(sorted(packed))
    folder = place.folder / "recorded"
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in whole.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(packed[name].broken(pick) if name == broken else content)
    return folder, sample


def recordings(place, pick):
    """Recorded traffic of any format, and what stands beside it."""
    folder, sample = _written(place, pick, RECORDINGS)
    file, book = str(folder / sample.entry), pick.choice(BOOKS)
    roads = ["--map", str(folder / sample.roads)] if sample.roads else []
    match pick.randrange(8):
        case 0:
            return ["find", "(v: vehicle) b(v)", file, "-u", "paper", *roads]
        case 1:
            drawn = str(place.folder / pick.choice(("drive.svg", "drive.html")))
            return ["draw", "drive", file, "-r", book, "-o", drawn, *roads]
        case 2:
            return ["show", "--audit", str(place.folder / "listed.rules"), "--source", file, *roads]
        case 3:
            return ["maneuvers", file, "-r", "esterle2019", *roads]
        case 4:
            return [
                "maneuvers",
                "--traces",
                file,
                "--recorded",
                "-o",
                str(place.folder / "made.jsonl"),
                *roads,
            ]
        case _:
            return ["verify", file, "-r", book, *roads, *pick.choice(([], ["--json"]))]


def maps(place, pick):
    """Maps of any format, for traffic that has no roads of its own."""
    folder, sample = _written(place, pick, MAPS)
    tracks = place.write("tried.csv", TRACKS)
    roads = ["--map", str(folder / sample.entry)]
    match pick.randrange(4):
        case 0:
            drawn = str(place.folder / "drive.svg")
            return ["draw", "drive", tracks, "-r", "esterle2019", "-o", drawn, *roads]
        case 1:
            return ["find", "(v: vehicle) b(v)", tracks, "-u", "paper", *roads]
        case _:
            return ["verify", tracks, "-r", pick.choice(BOOKS), *roads]
