"""Who is there in which state of a trace."""


def there(trace, n):
    """Who is there in a state, and the type of each."""
    always = (0, len(trace.states) - 1)
    stays = {name: trace.present.get(name, always) for name in trace.objects}
    return {name: trace.objects[name] for name, (one, last) in stays.items() if one <= n <= last}
