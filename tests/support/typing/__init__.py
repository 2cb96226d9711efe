"""A session of typing into Germany's rulebook, stored key by key."""
