"""XML, Protocol Buffers and the like, read within bounds."""
