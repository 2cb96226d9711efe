"""Chance for what is drawn as a whole: rulebooks, traces, graphs.

Choice by choice Hypothesis begins with what is small and goes on with what is nearly the same: most
states then say alike, and hardly any path of a graph leads anywhere. A seed has neither habit; nor
does it shrink, so it is not tried (``phases``): what is made of it is small anyway.
"""

from hypothesis import strategies as st

seeds = st.randoms(use_true_random=True)
"""Sources of chance. True they are only by name: Hypothesis draws a seed, and knows it again."""
