"""What does not keep the house's rules yet; a line here is a debt, and goes when it is paid."""

POSITIONAL_CALLS: frozenset[str] = frozenset()
UNEXPLAINED_IMPORTS: frozenset[str] = frozenset()
WIDE_FOLDERS: frozenset[str] = frozenset()
MODULES_TWICE: frozenset[str] = frozenset()
CLASSES_TWICE: frozenset[str] = frozenset()
ROOMS_WITHOUT_README: frozenset[str] = frozenset()
TYPES_WITHOUT_TERM: frozenset[str] = frozenset()
