"""The report as one self-contained HTML page."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from fdsolver.checkpoint import write_atomically
from reports.code_words import pieces, plain
from reports.content import Drawing, Report, Table, Text
from reports.drawing import data_uri


def render_page(report: Report) -> str:
    """Return the page: style and images inside, nothing fetched from anywhere, all text escaped."""
    import jinja2

    folder = resources.files("reports")
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.tests |= {
        "drawing": lambda block: isinstance(block, Drawing),
        "table": lambda block: isinstance(block, Table),
        "prose": lambda block: isinstance(block, Text),
    }
    environment.globals |= {"data_uri": data_uri, "numeric_columns": numeric_columns}
    environment.filters |= {"pieces": pieces, "plain": plain}
    template = environment.from_string((folder / "templates" / "report.html").read_text(encoding="utf-8"))
    # the stylesheet is ours and holds no user text
    style = (folder / "static" / "report.css").read_text(encoding="utf-8")
    return template.render(report=report, style=style)


def is_number(cell: str) -> bool:
    """Whether a cell is a number, a sign of absence, or numbers with a slash between."""
    return all(c in "0123456789.+−-–e/ \u2009%" for c in cell)


def numeric_columns(table: Table) -> list[bool]:
    """Which columns of a table are numbers throughout, to be set flush right."""
    return [all(is_number(row[k]) for row in table.rows) for k in range(len(table.columns))]


def write_page(report: Report, path: Path) -> None:
    """Write the page, whole or not at all. Raises StorageError."""
    text = render_page(report).encode()
    write_atomically(path, lambda file: file.write(text))
