"""Confines the calling process: it can write no file, open no connection and run no program.

Spot is native code that reads formulas from strangers; it needs only its memory and two pipes.
Landlock (Linux from 5.13; its rules are in the kernel's ``include/uapi/linux/landlock.h``) blocks
files and signals, seccomp blocks connections and programs. Reading files stays possible, because
Python's modules and Spot's libraries have to be loaded.
"""

from __future__ import annotations

import ctypes
import os
import struct
import sys
from typing import Any, NamedTuple

_SET_NO_NEW_PRIVILEGES = 38
_CREATE_RULESET, _RESTRICT_SELF = 444, 446
_VERSION_OF_LANDLOCK = 1

_RIGHTS = ((5, 1 << 15), (3, 1 << 14), (2, 1 << 13))
"""Landlock's version and the right on files that it added."""
_FIRST_RIGHTS = ((1 << 13) - 1) & ~(1 << 2 | 1 << 3)
"""All rights of version 1 except reading files and folders."""
_TCP, _SCOPES = 0b11, 0b11
"""Binding and connecting (from version 4); abstract sockets and signals (from version 6)."""

_ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
_SECCOMP = {"x86_64": 317, "aarch64": 277}
_DENIED = {
    # execve, execveat, socket, socketpair, connect, ptrace, process_vm_writev, io_uring_setup
    "x86_64": (59, 322, 41, 53, 42, 101, 311, 425),
    "aarch64": (221, 281, 198, 199, 203, 117, 271, 425),
}
_FOREIGN_CALLS = 0x40000000
"""Numbers from here on belong to x86-64's second calling convention (x32)."""
_LOAD, _JUMP_IF_EQUAL, _JUMP_IF_AT_LEAST, _RETURN = 0x20, 0x15, 0x35, 0x06
_NUMBER, _ARCHITECTURE = 0, 4
_ALLOWED, _REFUSED = 0x7FFF0000, 0x00050001
"""Results of a filter: allow, or fail with EPERM."""
_FILTER, _ALL_THREADS = 1, 1


class Confinement(NamedTuple):
    """Whether a process is kept from changing files, and from connecting and running programs."""

    files: bool
    connections: bool


def confine() -> Confinement:
    """Confine this process permanently as far as the kernel can; return what is confined.

    Must be called before other threads exist: Landlock applies to the calling thread.
    """
    if sys.platform != "linux":
        return Confinement(files=False, connections=False)
    system = ctypes.CDLL(None)
    if system.prctl(_SET_NO_NEW_PRIVILEGES, 1, 0, 0, 0) != 0:
        return Confinement(files=False, connections=False)
    return Confinement(files=_without_files(system), connections=_without_connections(system))


def _without_files(system: Any) -> bool:
    version = system.syscall(_CREATE_RULESET, None, 0, _VERSION_OF_LANDLOCK)
    if version < 1:
        return False
    rights = _FIRST_RIGHTS | sum(right for since, right in _RIGHTS if version >= since)
    rules = struct.pack("=Q", rights)
    rules += struct.pack("=Q", _TCP) if version >= 4 else b""
    rules += struct.pack("=Q", _SCOPES) if version >= 6 else b""
    ruleset = system.syscall(_CREATE_RULESET, rules, len(rules), 0)
    if ruleset < 0:
        return False
    try:
        return bool(system.syscall(_RESTRICT_SELF, ruleset, 0) == 0)
    finally:
        os.close(ruleset)


def _without_connections(system: Any) -> bool:
    machine = os.uname().machine
    if machine not in _DENIED or sys.maxsize < 2**32:
        return False
    denied = _DENIED[machine]
    # Each line: operation, lines to skip if true and if false, operand.
    lines = [
        (_LOAD, 0, 0, _ARCHITECTURE),
        (_JUMP_IF_EQUAL, 0, len(denied) + 3, _ARCHITECTURES[machine]),
        (_LOAD, 0, 0, _NUMBER),
        (_JUMP_IF_AT_LEAST, len(denied) + 1, 0, _FOREIGN_CALLS),
        *((_JUMP_IF_EQUAL, len(denied) - n, 0, number) for n, number in enumerate(denied)),
        (_RETURN, 0, 0, _ALLOWED),
        (_RETURN, 0, 0, _REFUSED),
    ]
    code = b"".join(struct.pack("=HBBI", *line) for line in lines)
    held = ctypes.create_string_buffer(code, len(code))  # kept alive until the call ends
    program = struct.pack("@HP", len(lines), ctypes.addressof(held))
    answer = system.syscall(_SECCOMP[machine], _FILTER, _ALL_THREADS, program)
    return bool(answer == 0)
