"""Pages, figures, tables and sentences of results that are given as data; no analysis is imported."""
