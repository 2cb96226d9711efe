"""Protocol Buffers' wire format: what is written is read, all else is refused."""

import random
import struct
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.recordings.encodings import wire_format
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.wire_format import (
    Field,
    Message,
    WireFile,
    Words,
    tables_of,
    wire_file,
)
from support.builders.wire_bytes import counted, double, field, varint, whole

FORM = BinaryFormat("a test", "there is no way out", 1000)
COLOURS = Words({0: "red", 2: "green"})
INNER = {1: Field("x", "double"), 2: Field("deeper", {})}
INNER[2] = Field("deeper", INNER)
TABLE = {
    1: Field("count", "int"),
    2: Field("natural", "uint", many=True),
    3: Field("turned", "sint", many=True),
    4: Field("is_on", "bool"),
    5: Field("long", "double", many=True),
    6: Field("short", "float", many=True),
    7: Field("name", "text"),
    8: Field("raw", "bytes", many=True),
    9: Field("colour", COLOURS, many=True),
    1000: Field("inner", INNER, many=True),
}
WRITTEN = {
    1: lambda value: whole(1, value),
    2: lambda value: whole(2, value),
    3: lambda value: whole(3, 2 * value if value >= 0 else -2 * value - 1),
    4: lambda value: whole(4, value),
    5: lambda value: double(5, value),
    6: lambda value: field(6, 5, struct.pack("<f", value)),
    7: lambda value: counted(7, value.encode()),
    8: lambda value: counted(8, value),
    9: lambda value: whole(9, 0 if value == "red" else 2),
    1000: lambda value: counted(1000, *nested(value)),
}
WHOLE = st.integers(-(2**63), 2**63 - 1)
NUMBERS = st.floats(allow_nan=False)
VALUES = {
    1: WHOLE,
    2: st.integers(0, 2**64 - 1),
    3: WHOLE,
    4: st.booleans(),
    5: NUMBERS,
    6: st.floats(allow_nan=False, width=32),
    7: st.text(),
    8: st.binary(),
    9: st.sampled_from(["red", "green"]),
    1000: st.lists(NUMBERS, max_size=4),
}
ONCE = [number for number, one in TABLE.items() if not one.many]
# Of any wire type, and of numbers that no table here has
UNKNOWN = st.one_of(
    st.integers(0, 2**64 - 1).map(lambda value: whole(11, value)),
    NUMBERS.map(lambda value: double(2**29 - 1, value)),
    st.binary().map(lambda value: counted(12, value)),
    st.binary(min_size=4, max_size=4).map(lambda value: field(13, 5, value)),
)


def nested(numbers):
    """The fields of a message with a number, in a message with the next, and so on."""
    inner = []
    for number in reversed(numbers):
        inner = [double(1, number), counted(2, *inner)]
    return inner


def read(data, table=TABLE):
    return list(WireFile(data, Path("file.pb"), FORM).fields(table))


def plain(fields):
    """Names and values, those of messages as lists of the same."""
    return [
        (one.field.name, plain(one.value.fields) if isinstance(one.value, Message) else one.value)
        for one in fields
    ]


def plainly_nested(numbers):
    inner = []
    for number in reversed(numbers):
        inner = [("x", number), ("deeper", inner)]
    return inner


def refused(data, table=TABLE):
    with pytest.raises(RulecError) as caught:
        read(data, table)
    (found,) = caught.value.diagnostics
    assert (found.code, found.place.file) == ("R0610", "file.pb")
    assert found.help == "there is no way out"
    return found


@st.composite
def messages(draw):
    """The bytes of a message with unknown fields in between, and what it says."""
    numbers = draw(st.lists(st.sampled_from(list(TABLE)), max_size=12))
    data, said = b"", []
    for place, number in enumerate(numbers):
        if number in ONCE and number in numbers[:place]:
            continue
        value = draw(VALUES[number])
        data += draw(UNKNOWN) + WRITTEN[number](value)
        said.append((TABLE[number].name, plainly_nested(value) if number == 1000 else value))
    return data + draw(UNKNOWN), said


@given(message=messages())
def test_what_is_written_is_read(message):
    data, said = message
    assert plain(read(data)) == said


@given(numbers=st.lists(NUMBERS), naturals=st.lists(st.integers(0, 2**64 - 1)))
def test_many_numbers_may_be_packed_into_one_value(numbers, naturals):
    packed = counted(5, struct.pack(f"<{len(numbers)}d", *numbers))
    packed += counted(2, *map(varint, naturals))
    assert plain(read(packed)) == [
        *(("long", number) for number in numbers),
        *(("natural", number) for number in naturals),
    ]


@given(message=messages(), seed=st.integers(0, 2**32))
def test_mistakes_are_read_or_refused(message, seed):
    pick = random.Random(seed)
    data = bytearray(message[0])
    for _ in range(pick.randint(1, 3)):
        at = pick.randrange(len(data) + 1)
        data[at : at + pick.randrange(3)] = pick.randbytes(pick.randrange(3))
    data = data[: pick.randrange(len(data) + 1)] if pick.random() < 0.3 else data
    try:
        read(bytes(data))
    except RulecError as error:
        (found,) = error.diagnostics
        assert found.code == "R0610"
        assert len(found.message) < 300


GOOD = whole(1, 300)
# Three bytes: whatever comes behind it begins at byte 3


@pytest.mark.parametrize(
    ("bad", "place", "why"),
    [
        (b"\x08", 4, "a value begins that has more bytes than are left"),
        (b"\x10\xff\xff", 4, "a value begins that has more bytes than are left"),
        (b"\x10" + b"\xff" * 10 + b"\x01", 4, "a number has more than 10 bytes"),
        (b"\x29\0\0\0", 3, "a value begins that has more bytes than are left"),
        (b"\x35\0\0\0", 3, "a value begins that has more bytes than are left"),
        (b"\x3a\x05abcd", 3, "a value begins that has more bytes than are left"),
        (counted(77)[:-1] + varint(2**63), 3, "a value begins that has more bytes than are left"),
        (b"\x0b", 3, "a field has the wire type 3"),
        (b"\x0f", 3, "a field has the wire type 7"),
        (b"\0\0", 3, "there is a field of the number 0, which none has"),
        (whole(1, 5), 3, "a message has a second field 1"),
        (double(7, 5), 3, "field 7 has the wire type 1"),
        (whole(1000, 5), 3, "field 1000 has the wire type 0"),
        (counted(4, b"\1"), 3, "field 4 has the wire type 2"),
        (whole(9, 1), 4, "`colour` has the unknown value 1"),
        (counted(7, b"ab\xff"), 7, "the text of `name` is not UTF-8"),
        (counted(5, b"\0" * 12), 13, "a value begins that has more bytes than are left"),
        (counted(1000, b"\x09"), 6, "a value begins that has more bytes than are left"),
    ],
)
def test_what_is_wrong_is_said_of_its_byte(bad, place, why):
    assert f"at byte {place}, {why}" in refused(GOOD + bad).message


def test_messages_in_messages_without_end():
    data = b""
    for _ in range(100):
        data = counted(2, data)
    assert "a message lies in more than 64 others" in refused(data, {2: Field("in", INNER)}).message
    assert len(read(data, {3: Field("other", INNER)})) == 0


def test_more_values_than_fit_in_memory(monkeypatch):
    monkeypatch.setattr(wire_format, "MOST_VALUES", 100)
    # Of each field by itself, since those before it are done with
    assert len(read(counted(2, b"\1" * 100) * 5)) == 500
    found = refused(counted(2, b"\1" * 100) + counted(2, b"\1" * 101))
    assert "a message has more than 100 values in it" in found.message


@pytest.mark.parametrize(("size", "why"), [(0, "it is empty"), (1001, "it is too large")])
def test_files_of_other_sizes(tmp_path, size, why):
    path = tmp_path / "file.pb"
    path.write_bytes(b"\0" * size)
    with pytest.raises(RulecError, match=why):
        wire_file(path, FORM)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(RulecError) as caught:
        wire_file(tmp_path / "file.pb", FORM)
    assert caught.value.diagnostics[0].code == "R0701"


def test_a_schema_makes_tables():
    tables = tables_of(
        """
Id: 1 value uint
Named: Id, 2 @name text
Colour = red - green
Sign = 3 stop, 70 yield
Node: Named, 4 colour Colour, 5 next/node Node*,
  6 - Id, 7 sign Sign
""",
        "other",
        {},
    )
    node = tables["Node"]
    assert list(node) == [1, 2, 4, 5, 6, 7]
    assert node[2] == Field("@name", "text")
    assert node[4] == Field("colour", Words({0: "red", 2: "green"}, "other"))
    assert (node[5].name, node[5].many) == ("next/node", True)
    assert node[5].holds is node
    assert node[6] == Field("", {1: Field("value", "uint")})
    assert node[7].holds == Words({3: "stop", 70: "yield"}, "other")


@pytest.mark.parametrize(
    "schema", ["1 value uint", "Id: 1 value", "Id: 1 value uint 2", "Id: 1 value number"]
)
def test_what_is_no_schema(schema):
    with pytest.raises((KeyError, ValueError)):
        tables_of(schema, "", {})
