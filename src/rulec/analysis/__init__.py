"""Questions about rulebooks: how two differ, and what is odd in one."""
