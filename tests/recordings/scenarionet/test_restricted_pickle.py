"""Pickles: plain data come back as they were, and nothing that a pickle names is run."""

import collections
import os
import pickle
import random
import struct
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.scenarionet.restricted_pickle import read_pickle

FORM = BinaryFormat("some pickle", "give another", 10_000_000)


def read(tmp_path, content):
    path = tmp_path / "some.pkl"
    path.write_bytes(content)
    return read_pickle(path, FORM)


PLAIN = {
    "nothing": None,
    "flags": [True, False],
    "wholes": (0, 255, 256, -1, 2**31, -(2**62)),
    "numbers": [0.5, float("inf")],
    "texts": ["", "ä" * 300],
    "bytes": b"\x00" * 300,
    "set": {"a", 1, None},
    "pairs": collections.OrderedDict(),
    "default": collections.defaultdict(int),
    "long list": list(range(2000)),
    5: {},
}


@pytest.mark.parametrize("protocol", [2, 3, 4, 5])
def test_plain_data(tmp_path, protocol):
    assert read(tmp_path, pickle.dumps(PLAIN, protocol)) == PLAIN


@pytest.mark.parametrize("protocol", [2, 3, 4, 5])
@pytest.mark.parametrize(
    "array",
    [
        np.arange(6.0).reshape(2, 3),
        np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        np.arange(5, dtype=">i2"),
        np.zeros((0, 3), dtype="f4"),
        np.array([True, False]),
        np.array(["ab", "c"]),
        np.array(2.5),
    ],
    ids=lambda array: f"{array.dtype}{array.shape}",
)
def test_arrays(tmp_path, protocol, array):
    found = read(tmp_path, pickle.dumps([array, array], protocol))[1]
    assert (found.dtype, found.shape) == (array.dtype, array.shape)
    assert (found == array).all()


def test_scalars_of_numpy_are_numbers(tmp_path):
    assert read(tmp_path, pickle.dumps([np.float32(0.5), np.int64(7)])) == [0.5, 7]


class Calls:
    """Asks for a call when it is unpickled."""

    def __init__(self, call, *arguments):
        self.call = call, arguments

    def __reduce__(self):
        return self.call


class Plain:
    """An object of a class of one's own."""


@pytest.mark.parametrize("protocol", [2, 4])
@pytest.mark.parametrize(
    ("value", "name"),
    [
        (Calls(os.system, "touch harm"), f"{os.system.__module__}.system"),
        (Calls(eval, "1"), "eval"),
        (Calls(getattr, "a", "b"), "getattr"),
        (Calls(np.zeros, 10**12), "zeros"),
        (Calls(np.load, "harm.npy"), "load"),
        (Calls(bytearray, 10**12), "bytearray"),
        (Calls(range, 10**12), "range"),
        (Plain(), "Plain"),
        (np.array([Plain()], dtype=object), ""),
    ],
    ids=lambda value: value if isinstance(value, str) else type(value).__name__,
)
def test_what_is_asked_for_is_refused_by_name(tmp_path, monkeypatch, value, name, protocol):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RulecError) as caught:
        read(tmp_path, pickle.dumps(value, protocol))
    assert name in str(caught.value)
    assert "at byte" in str(caught.value)
    assert not (tmp_path / "harm").exists()


def text(value):
    return b"\x8c" + bytes([len(value)]) + value.encode()


def asked(module, name):
    return text(module) + text(name) + b"\x93"


RECONSTRUCT = asked("numpy.core.multiarray", "_reconstruct")
DTYPE = asked("numpy", "dtype")
SET = asked("builtins", "set")
FLOATS = DTYPE + text("f8") + b"\x85R"
EMPTY = RECONSTRUCT + b")R"


def shaped(*sizes, raw=b""):
    """An array of numbers of 64 bits with a shape of one's choice."""
    numbers = b"".join(b"\x8a\x08" + struct.pack("<q", size) for size in sizes)
    content = b"B" + struct.pack("<I", len(raw)) + raw
    return EMPTY + b"(K\x01(" + numbers + b"t" + FLOATS + b"\x89" + content + b"tb"


SHARED = b")\x94" + b"".join(b"h%ch%c\x86\x94" % (k, k) for k in range(200))
"""Nested tuples whose text has 2 to the power of 200 characters."""

ARRAY = shaped(2, raw=bytes(16))


@pytest.mark.parametrize(
    ("program", "why"),
    [
        (shaped(10**15), "an array has a shape"),
        (shaped(-1), "an array has a shape"),
        (shaped(2, raw=bytes(8)), "an array of the shape (2,) has 8 bytes"),
        (shaped(1, 1, 1, 1, 1, raw=bytes(8)), "an array has a shape"),
        (shaped(10**6, 0, 10**9), "an array has a shape"),
        (DTYPE + text("O") + b"\x85R", "it calls `numpy.dtype` with what that does not take"),
        (DTYPE + text("V100") + b"\x85R", "it calls `numpy.dtype`"),
        (DTYPE + text("(1000000000,)f8") + b"\x85R", "it calls `numpy.dtype`"),
        (DTYPE + text("U99999") + b"\x85R", "it calls `numpy.dtype`"),
        (EMPTY + b"}b", "it gives an array a state"),
        (EMPTY + b"}bh\x00", "it gives an array a state"),
        (b"}}b", "it gives a dict a state"),
        (b"]}b", "it gives a list a state"),
        (text("a") + b")R", "it calls a str"),
        (SET + b"]]a\x85R", "a list is a key"),
        (SET + asked("builtins", "int") + b"\x85R", "with what that does not take"),
        (asked("builtins", "int") + text("9") + b"\x85R", "with what that does not take"),
        (asked("collections", "defaultdict") + text("a") + b"\x85R", "does not take"),
        (b"}G" + bytes(8) + b"Ns", "a float is a key"),
        (b"}K\x01\x85Ns", "a tuple is a key"),
        (b"}\x8a\x09" + bytes(8) + b"\x01Ns", "a whole number of 9 bytes"),
        (b"}\x8a\x08" + bytes(7) + b"\x80Ns", "is a key"),
        (b"(K\x01u", "where there is none"),
        (b"}(K\x01u", "a key has no value"),
        (b"]K\x01s", "where there is none"),
        (b"NK\x01a", "it adds to a NoneType as to a list"),
        (b")K\x01a", "it adds to a tuple as to a list"),
        (b"h\x07", "it refers to its value 7"),
        (b"0", "it takes a value where there is none"),
        (b"(0", "it takes a value where there is none"),
        (b"1", "from a mark on where there is none"),
        (b"\x8c\x02\xff\xfe", "a text is not UTF-8"),
        (b"c\xff\nx\n", "a name is not ASCII"),
        (b"cos\nsystem\n", "it asks for `os.system`"),
        (b"c" + b"x" * 500, "it ends before"),
        (asked("os", "system"), "it asks for `os.system`"),
        (b"K\x01K\x02\x93", "it asks for something by a int and a int"),
        (SHARED + b"\x8c\x01x\x93", "it asks for something by a tuple and a str"),
        (SHARED + b"N\x86R", "it calls "),
        (SHARED + b"}b", "it gives a tuple a state"),
        (SHARED + b"}h\xc8Ns", "a tuple is a key"),
        (SHARED + SET + b"]h\xc8a\x85R", "a tuple is a key"),
        (FLOATS + b"(K\x03" + ARRAY + b"NNNtb", "a state that none has"),
        (EMPTY + b"(K\x01)" + FLOATS + ARRAY + b"C\x00tb", "a state that none has"),
        (asked("_codecs", "encode") + text("a") + ARRAY + b"\x86R", "does not take"),
        (b"(cos\nsystem\no", "it asks for `os.system`"),
        (b"(ios\nsystem\n", "the opcode b'i'"),
        (b"Pharm\n", "the opcode b'P'"),
        (b"NQ", "the opcode b'Q'"),
        (b"\x82\x01", "the opcode b'\\x82'"),
        (asked("builtins", "set") + b")\x81", "the opcode b'\\x81'"),
        (b"I99\n", "the opcode b'I'"),
        (b"\x8b" + struct.pack("<i", 2**31 - 1), "the opcode b'\\x8b'"),
        (b"\x97", "the opcode b'\\x97'"),
        (b"\x8e" + b"\xff" * 8, "it ends before"),
        (b"\x8d" + b"\xff" * 8, "it ends before"),
        (b"\x80\x06", "it is of protocol 6"),
        (b"", "where there is none"),
    ],
)
def test_hostile_programs(tmp_path, program, why):
    with pytest.raises(RulecError) as caught:
        read(tmp_path, b"\x80\x04" + program + b".")
    assert why in str(caught.value)
    assert "at byte" in str(caught.value)


def test_a_large_value_is_not_copied_again_and_again(tmp_path):
    """A list of 100,000 numbers, of which sets are made without end."""
    numbers = b"](" + b"".join(b"M" + struct.pack("<H", k % 65536) for k in range(100_000)) + b"e"
    program = numbers + b"q\x000" + SET + b"q\x010" + b"h\x01h\x00\x85R0" * 1000
    with pytest.raises(RulecError, match="it copies more than there is in it"):
        read(tmp_path, b"\x80\x04" + program + b"N.")


def test_so_many_opcodes_are_refused(tmp_path):
    with pytest.raises(RulecError, match="it has more than 5,000,000 opcodes"):
        read(tmp_path, b"\x80\x04" + b"N0" * 2_500_000)


@pytest.mark.parametrize("content", [b"", b"x", b"(dp0\n.", b"\x80"])
def test_what_is_no_pickle(tmp_path, content):
    with pytest.raises(RulecError):
        read(tmp_path, content)


@given(seed=st.integers(0, 2**32))
def test_whatever_the_bytes_are(tmp_path_factory, seed):
    pick = random.Random(seed)
    data = bytearray(pickle.dumps([PLAIN, np.arange(6.0), np.float32(1)], pick.choice([2, 4, 5])))
    for _ in range(pick.randint(1, 6)):
        at = pick.randrange(len(data))
        match pick.randrange(3):
            case 0:
                data[at] = pick.randrange(256)
            case 1:
                del data[at : at + pick.randint(1, 20)]
            case 2:
                data[at:at] = data[at : at + pick.randint(1, 20)]
    with suppress(RulecError):
        read(tmp_path_factory.mktemp("mutated"), bytes(data))
