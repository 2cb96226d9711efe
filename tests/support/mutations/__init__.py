"""Files of every format with mistakes in them: they are read, or refused in one sentence."""
