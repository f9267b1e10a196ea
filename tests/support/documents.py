"""What the pages in docs/ state: their tables and fenced blocks, for the tests that hold them against the code."""

import importlib
import re
from pathlib import Path

from tests.support.programs import ROOT

Row = dict[str, str]


def page(name: str) -> str:
    """The text of docs/<name>."""
    return (ROOT / "docs" / name).read_text()


def kubernetes_pages() -> str:
    """The text of k3s/README.md and of its pages in docs/."""
    pages = [ROOT / "k3s/README.md", *sorted((ROOT / "docs").glob("kubernetes-*.md"))]
    return "\n".join(path.read_text() for path in pages)


def blocks(text: str, language: str) -> list[str]:
    """The contents of the fenced blocks of that language, in order."""
    return re.findall(rf"^ *```{language}\n(.*?)^ *```$", text, re.MULTILINE | re.DOTALL)


def table(text: str, heading: str) -> list[Row]:
    """The rows of the first table below that heading, each a cell's text by its column's name, without backquotes."""
    section = re.split(r"^#+ ", text.split(f"# {heading}\n", 1)[1], maxsplit=1, flags=re.MULTILINE)[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    columns, _, *rows = [[cell.strip().replace("`", "") for cell in line.strip("|").split("|")] for line in lines]
    assert rows, heading
    return [dict(zip(columns, cells, strict=True)) for cells in rows]


def value_of(constant: str) -> float:
    """The value that the code gives to `module: NAME` (Python) or `file.h: NAME` (C++)."""
    place, name = constant.split(": ")
    if Path(place).suffix in {".h", ".cpp"}:
        (value,) = re.findall(rf"\b{name} = (\d+);", (ROOT / place).read_text())
        return float(value)
    return float(getattr(importlib.import_module(place), name))
