"""Cells of CSV files that a spreadsheet takes for text, whoever has written them."""

_FORMULA = ("=", "+", "-", "@", "\t", "\r")  # by which a spreadsheet begins to compute


def harmless(cell: object) -> object:
    return f"'{cell}" if isinstance(cell, str) and cell.startswith(_FORMULA) else cell
