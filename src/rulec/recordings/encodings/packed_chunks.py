"""Byte chunks packed with LZ4 or Zstandard, unpacked to at most their stated size."""

from __future__ import annotations


def unpacked(packed: bytes, method: str, size: int) -> bytes:
    """The unpacked bytes of a chunk; ``method`` is ``lz4`` (frames), ``zstd``, or empty for none.

    Raises ValueError if the chunk is damaged, has another size, or uses another method.
    """
    if not method:
        content = packed
    elif method in ("lz4", "zstd"):
        # Few files use this packing
        import cramjam

        buffer = bytearray(size)
        library = cramjam.lz4 if method == "lz4" else cramjam.zstd
        try:
            # It never writes beyond the buffer, whatever size the chunk states
            count = library.decompress_into(packed, buffer)
        except cramjam.DecompressionError:
            raise ValueError(f"it is packed ({method}), and damaged or not of its size") from None
        content = bytes(buffer[:count])
    else:
        raise ValueError("it is packed by another method than lz4 or zstd")
    if len(content) != size:
        raise ValueError(f"it has {len(content):,} bytes instead of {size:,}")
    return content
