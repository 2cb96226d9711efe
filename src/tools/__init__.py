"""Programs of rulec's developers, which write the files that are made from others."""
