from __future__ import annotations

import re

import pytest

from reports.content import Drawing, Report, Section, Table
from reports.pdf import BOTTOM, PAGE_IN, TOP, write_pdf
from reports.pdf_text import column_widths, width_in, wrap


@pytest.fixture(scope="module")
def pdf(report, tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("pdf") / "report.pdf"
    write_pdf(report, path)
    assert [p.name for p in path.parent.iterdir()] == ["report.pdf"]
    return path.read_bytes()


def test_pdf_has_a4_pages(pdf, report):
    assert pdf.startswith(b"%PDF-")
    assert pdf.rstrip().endswith(b"%%EOF")
    boxes = re.findall(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+) ?\]", pdf)
    figures = sum(isinstance(block, Drawing) for section in report.sections for block in section.blocks)
    assert figures / 3 < len(boxes) < 2 * figures  # a page has one to three figures
    for width, height in boxes:
        # A4 in points, to the hundredth of an inch in which the page is given
        assert float(width) == pytest.approx(595.3, abs=0.72)
        assert float(height) == pytest.approx(841.9, abs=0.72)


def test_a_folded_table_is_left_to_the_page(tmp_path):
    rows = tuple((f"quantity {k}", "1.0") for k in range(500))
    sizes = []
    for folded in (False, True):
        section = Section("long", "Long", [Table("Every quantity.", ("what", "value"), rows, folded=folded)])
        write_pdf(Report("Title", "Subtitle", [section], []), tmp_path / "report.pdf")
        sizes.append((tmp_path / "report.pdf").read_bytes().count(b"/MediaBox"))
    assert sizes[0] > 5 and sizes[1] == 1


def test_every_drawing_fits_on_a_page(report):
    room = PAGE_IN[1] - TOP - BOTTOM - 1.0  # caption and heading
    for section in report.sections:
        for block in section.blocks:
            if isinstance(block, Drawing):
                assert block.height_in < room, block.name


def test_columns_keep_within_the_page(report):
    for section in report.sections:
        for block in section.blocks:
            if isinstance(block, Table):
                widths = column_widths(block.columns, block.rows, 7.6, 6.9)
                assert sum(widths) <= 6.9 + 1e-9, block.caption
                assert min(widths) > 0.2, block.caption


def test_lines_are_no_wider_than_asked():
    text = "The relaxed membrane has slack zones beside the hole, " * 5 + "x" * 300
    lines = wrap(text, 10.0, 3.0)
    assert max(width_in(line, 10.0) for line in lines) <= 3.0
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")


def test_marks_of_code_are_left_out():
    assert wrap("run `wrinkle list` or a ` alone", 10.0, 9.0) == ["run wrinkle list or a ` alone"]


def test_empty_text_is_one_line():
    assert wrap("", 10.0, 3.0) == [""]


def test_bold_is_wider_and_width_grows_with_size():
    assert width_in("relaxed membrane", 10.0, True) > width_in("relaxed membrane", 10.0)
    assert width_in("relaxed membrane", 20.0) == pytest.approx(
        2 * width_in("relaxed membrane", 10.0), rel=0.05
    )


def test_letters_beyond_the_first_font_are_measured():
    assert width_in("λ₁", 10.0) > width_in("λ", 10.0)
