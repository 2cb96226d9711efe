"""The arrays of a drive's signals, by name: values, where they are unknown, bounds, texts."""

import numpy as np

from rulec.extraction.signals.signal_columns import Measured, column_of, unknown_flags


def _of(signals, name):
    return signals.world[name] if name in signals.world else signals.about[name]


def values_of(signals, name):
    """The values of a signal; what is unknown of a truth counts as false."""
    return column_of(_of(signals, name))


def unknown_in(signals, name):
    """Where a signal is unknown."""
    flags = unknown_flags(_of(signals, name))
    return np.zeros(values_of(signals, name).shape, dtype=bool) if flags is None else flags


def bounds_of(signals, name):
    """The least and the greatest values of a measured number."""
    return getattr(_of(signals, name), "bounds", None)


def texts_of(signals, name):
    """The texts that a signal's values index."""
    return getattr(_of(signals, name), "texts", None)


def said(signals, name):
    """The values of a signal, texts as themselves."""
    texts, values = texts_of(signals, name), values_of(signals, name)
    return values if texts is None else np.array(texts)[values]


def bounded(signals):
    """The bounds of all measured numbers, by name."""
    every = {**signals.world, **signals.about}
    found = {name: bounds_of(signals, name) for name in every}
    return {name: ends for name, ends in found.items() if ends is not None}


def possible_in(signals, name):
    """Where a truth is possible."""
    return _of(signals, name).possible


def all_said(signals):
    """The values of all signals, texts as themselves."""
    return {name: said(signals, name) for name in (*signals.world, *signals.about)}


def possibly_said(signals, name):
    """As ``said``, but where a truth is possible."""
    values = _of(signals, name)
    return said(signals, name) if isinstance(values, Measured) else values.possible


def letters(signals, name):
    """Where a truth is sure (T), surely not (F) or unknown (?), as a text."""
    truth = _of(signals, name)
    halves = zip(truth.sure.ravel(), truth.possible.ravel(), strict=True)
    return "".join("T" if sure else "?" if possible else "F" for sure, possible in halves)
