"""Tables read with Arrow, an optional dependency: its names are imported at their first use."""

from typing import TYPE_CHECKING

from rulec.lazy_loading import lazy_names

if TYPE_CHECKING:
    from rulec.trace.formats.arrow.arrow_arrays import array_of_lists as array_of_lists
    from rulec.trace.formats.arrow.arrow_arrays import array_of_numbers as array_of_numbers
    from rulec.trace.formats.arrow.arrow_arrays import array_of_texts as array_of_texts
    from rulec.trace.formats.arrow.arrow_arrays import cells_in as cells_in
    from rulec.trace.formats.arrow.arrow_arrays import codes_in as codes_in
    from rulec.trace.formats.arrow.arrow_arrays import whole_array as whole_array
    from rulec.trace.formats.arrow.arrow_arrays import with_plain_texts as with_plain_texts
    from rulec.trace.formats.arrow.arrow_blocks import cut as cut
    from rulec.trace.formats.arrow.arrow_csv import pieces as pieces
    from rulec.trace.formats.arrow.parquet import parquet_names as parquet_names
    from rulec.trace.formats.arrow.table_groups import extent as extent
    from rulec.trace.formats.arrow.table_groups import groups as groups
    from rulec.trace.formats.arrow.table_groups import joined as joined
    from rulec.trace.formats.arrow.table_groups import key_texts as key_texts
    from rulec.trace.formats.arrow.table_groups import not_utf8 as not_utf8
    from rulec.trace.formats.arrow.table_groups import rows_where as rows_where
    from rulec.trace.formats.arrow.table_groups import table_of_batch as table_of_batch
    from rulec.trace.formats.arrow.table_groups import trace_outlines as trace_outlines
    from rulec.trace.formats.arrow.table_groups import traces_of_table as traces_of_table
    from rulec.trace.formats.arrow.table_groups import without_rows as without_rows
else:
    __getattr__ = lazy_names(__name__)
