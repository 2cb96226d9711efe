"""The worst files of every format: as much to hold and to do for each byte as somebody can ask."""

from __future__ import annotations

import gzip
import io
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pyarrow
from pyarrow import parquet

from support.builders import mcap_files, track_tables
from support.builders import osi_traces as osi
from support.builders.recordings import SAMPLES
from support.builders.waymo_files import record
from support.mutations.format_samples import RECORDINGS

Files = Mapping[str, bytes]
"""Files by name; the first is judged, with the map that is called ``roads.…``, if there is one."""


def _parquet(columns, **options) -> bytes:
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(columns), sink, compression="zstd", **options)
    return sink.getvalue().to_pybytes()


def _tracks(ids: int, steps: int, apart_m: float = 0.0) -> dict[str, bytes]:
    n = ids * steps
    columns = {
        "track": np.repeat(np.arange(ids), steps),
        "t": np.tile(np.arange(steps) / 2, ids),
        "x": np.repeat(np.arange(ids) * apart_m, steps),
        "y": np.zeros(n),
        "speed": np.zeros(n),
    }
    return {"cars.parquet": _parquet(columns), "roads.csv": track_tables.LANES.encode()}


def _lanes(rows: str) -> dict[str, bytes]:
    cars = track_tables.table("track,t,x,y", *track_tables.driving("1"))
    return {"cars.csv": cars.encode(), "roads.csv": f"lane,x,y\n{rows}".encode()}


def _commonroad(inner: str) -> dict[str, bytes]:
    text = next(iter(SAMPLES)).read_text(encoding="utf-8")
    at = text.rindex("</commonRoad>")
    return {"DEU_Worst-1_1_T-1.xml": (text[:at] + inner + text[at:]).encode()}


def _fcd(moments: str) -> dict[str, bytes]:
    files = dict(next(RECORDINGS["sumo"]()).files)
    net = files["road.net.xml"]
    fcd = f"<fcd-export>{moments}</fcd-export>"
    return {"fcd.xml": fcd.encode(), "roads.net.xml": net.encode()}


def _person(name: int) -> str:
    return f'<person id="p{name}" x="20" y="0" angle="0" speed="1" pos="0" edge="in"/>'


def _empty_messages(field: int, count: int) -> bytes:
    return bytes([field << 3 | 2, 0]) * count


def _crowded_scene(count: int) -> str:
    state = (
        "<position><point><x>0</x><y>0</y></point></position>"
        "<orientation><exact>0</exact></orientation><time><exact>0</exact></time>"
        "<velocity><exact>1</exact></velocity><acceleration><exact>0</exact></acceleration>"
    )
    shape = "<shape><rectangle><length>4</length><width>2</width></rectangle></shape>"
    return "".join(
        f'<dynamicObstacle id="{900000 + k}"><type>car</type>{shape}'
        f"<initialState>{state}</initialState></dynamicObstacle>"
        for k in range(count)
    )


def _pickle(body: bytes) -> dict[str, bytes]:
    return {"some.pkl": b"\x80\x04" + body + b"."}


def _shared_tuples(levels: int) -> bytes:
    pairs = (b"h" + bytes([k]) + b"h" + bytes([k]) + b"\x86\x94" for k in range(levels))
    return b")\x94" + b"".join(pairs)


def _other(name: str, entry: str, content: bytes) -> dict[str, bytes]:
    """The files of a sample, with one of them exchanged."""
    sample = next(RECORDINGS[name]())
    whole = {key: one.whole() for key, one in sample.packed().items()}
    return {sample.entry: whole.pop(sample.entry)} | whole | {entry: content}


def _argoverse(rows: int) -> dict[str, bytes]:
    sample = next(RECORDINGS["argoverse-motion"]())
    content = sample.packed()[sample.entry].whole()
    table = parquet.read_table(io.BytesIO(content))
    one = table.slice(0, 1).take([0] * rows)
    sink = io.BytesIO()
    parquet.write_table(one, sink, compression="zstd")
    return _other("argoverse-motion", sample.entry, sink.getvalue())


WORST: Mapping[str, Callable[[int], Files]] = {
    "tracks: parked at one place": lambda n: _tracks(2 * n, 10 * n),
    "tracks: many moments of some": lambda n: _tracks(20, 500 * n),
    "tracks: side by side": lambda n: _tracks(2 * n, n, 5.0),
    "tracks: packed blanks": lambda n: {
        "cars.csv.gz": gzip.compress(b"track,t,x,y\n" + b"1,0,0,0\n" * (20_000 * n), 9),
        "roads.csv": track_tables.LANES.encode(),
    },
    "tracks: far times": lambda n: {
        "cars.csv": b"track,t,x,y\n1,0,0,0\n1,0.1,1,0\n2,%d,0,0\n" % (1000 * n),
        "roads.csv": track_tables.LANES.encode(),
    },
    "lanes: one of many points": lambda n: _lanes(
        "".join(f"r,{k / (50 * n):.6f},0\n" for k in range(10_000 * n))
    ),
    "lanes: many at one place": lambda n: _lanes(
        "".join(f"r{k},0,0\nr{k},200,0\n" for k in range(20 * n))
    ),
    "commonroad: crowd": lambda n: _commonroad(_crowded_scene(20 * n)),
    "commonroad: deep": lambda n: _commonroad("<a>" * (1000 * n) + "</a>" * (1000 * n)),
    "commonroad: empty elements": lambda n: _commonroad("<lanelet/>" * (1000 * n)),
    "commonroad: packed blanks": lambda n: {
        "DEU_Worst-1_1_T-1.xml": gzip.compress(b"<commonRoad>" + b" " * (1_000_000 * n), 9)
    },
    "commonroad-protobuf: empty messages": lambda n: {
        "DEU_Worst-1_1_T-1.pb": b"".join(_empty_messages(k, 5000 * n) for k in range(1, 9))
    },
    "sumo: crowd on foot": lambda n: _fcd(
        "".join(
            f'<timestep time="{t}">{"".join(map(_person, range(10 * n)))}</timestep>'
            for t in range(20)
        )
    ),
    "sumo: empty moments": lambda n: _fcd(
        "".join(f'<timestep time="{t}"/>' for t in range(5000 * n))
    ),
    "waymo: empty messages": lambda n: {
        "some.tfrecord": b"".join(record(_empty_messages(k, 20_000 * n)) for k in (2, 3, 8))
    },
    "osi: empty messages": lambda n: {
        "some.osi": osi.trace([b"".join(_empty_messages(k, 20_000 * n) for k in range(2, 16))])
    },
    "osi: packed blanks": lambda n: {
        "some.mcap": mcap_files.recorded((bytes(1_000_000 * n),), method="zstd")
    },
    "scenarionet: shared tuples": lambda n: _pickle(
        _shared_tuples(min(250, 30 * n)) + b"\x8c\x01x\x93"
    ),
    "scenarionet: empty sets": lambda n: _pickle(b"\x8f" * (40_000 * n)),
    "scenarionet: empty dictionaries": lambda n: _pickle(b"}" * (40_000 * n)),
    "argoverse-motion: one row again and again": lambda n: _argoverse(20_000 * n),
    **{
        f"{name}: its table again and again": lambda n, name=name: _repeated(name, n)
        for name in ("highd", "levelx", "interaction", "ngsim", "omega-prime")
    },
    **{
        f"{name}: zeros": lambda n, name=name: _other(
            name, next(RECORDINGS[name]()).entry, bytes(500_000 * n)
        )
        for name in ("argoverse-sensor",)
    },
}
"""What is asked for -> files of it; their size and what they ask for grow with a number."""


def _repeated(name: str, n: int) -> dict[str, bytes]:
    sample = next(RECORDINGS[name]())
    head, *rows = sample.packed()[sample.entry].whole().splitlines(keepends=True)
    # Each row of another track at the same place: whatever the columns, the first numbers differ
    own = [
        b",".join([b"%d" % (k + 10)] * 2 + row.split(b",")[2:])
        for k in range(100 * n)
        for row in rows[:4]
    ]
    return _other(name, sample.entry, head + b"".join(own))


def unpacked_bytes(files: Files) -> int:
    """The bytes of files after decompression; Parquet's dictionaries and runs count as it."""
    total = 0
    for name, content in files.items():
        if content.startswith(b"\x1f\x8b"):
            content = gzip.decompress(content)
        total += len(content)
        if Path(name).suffix == ".parquet":
            total += parquet.read_table(io.BytesIO(content)).nbytes
        if name.endswith(".mcap"):
            total += 1_000_000
    return total
