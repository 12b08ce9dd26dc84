"""Pages, figures, tables and sentences of results."""
