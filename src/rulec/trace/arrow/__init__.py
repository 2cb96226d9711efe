"""Tables read with Arrow, which is installed on request: the only package that imports it."""
