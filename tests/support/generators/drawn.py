"""Examples of a Hypothesis strategy outside of a property."""


def drawn(strategy, n):
    """``n`` examples of a strategy, always the same ones."""
    from hypothesis import HealthCheck, Phase, given, seed, settings

    found = []

    @seed(1)
    @settings(
        max_examples=n,
        phases=[Phase.generate],
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(strategy)
    def collect(example):
        found.append(example)

    collect()
    return found
