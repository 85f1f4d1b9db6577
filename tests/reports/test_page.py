from __future__ import annotations

import base64
import re
from html.parser import HTMLParser

import pytest

from reports.content import Drawing, Report, Section, Table, Text
from reports.drawing import data_uri
from reports.page import is_number, numeric_columns, render_page, write_page
from tests.reports.conftest import HOSTILE, MISSING, REFUSED, STALLED

VOID = {"meta", "link", "img", "br", "hr"}


class Reader(HTMLParser):
    """Keeps the tags with their attributes, the visible text, and every tag that is closed out of order."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.misnested: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.misnested.append(tag)

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.text.append(data)


@pytest.fixture(scope="module")
def read(page):
    reader = Reader()
    reader.feed(page)
    reader.close()
    return reader


def visible(reader: Reader) -> str:
    return re.sub(r"\s+", " ", "".join(reader.text))


def test_tags_are_closed_in_order(read):
    assert not read.misnested
    assert not read.open


def test_page_fetches_nothing(read, page):
    for tag, attributes in read.tags:
        for name in ("src", "href", "srcset", "action", "poster"):
            if name in attributes:
                assert attributes[name].startswith(("data:", "#")), f"{tag} fetches {attributes[name][:60]}"
    style = re.search(r"<style>(.*?)</style>", page, re.DOTALL).group(1)
    assert "url(" not in style
    assert "@import" not in style
    assert not {"script", "iframe", "object", "embed"} & {tag for tag, _ in read.tags}


def test_every_link_leads_somewhere(read):
    anchors = [attributes["id"] for _, attributes in read.tags if "id" in attributes]
    assert len(anchors) == len(set(anchors))
    links = [attributes["href"] for tag, attributes in read.tags if tag == "a"]
    assert len(links) >= 5
    assert {link.removeprefix("#") for link in links} <= set(anchors)


def test_every_image_has_its_own_text_and_real_content(read, report):
    images = [attributes for tag, attributes in read.tags if tag == "img"]
    drawings = [
        block for section in report.sections for block in section.blocks if isinstance(block, Drawing)
    ]
    assert len(images) == len(drawings) >= 10
    for image in images:
        assert len(image["alt"]) > 30
        head, data = image["src"].split(",", 1)
        content = base64.b64decode(data)
        magic = {"data:image/png;base64": b"\x89PNG", "data:image/svg+xml;base64": b"<?xml"}[head]
        assert content.startswith(magic)
        assert len(content) > 5000  # an empty figure is smaller


def test_hostile_text_is_shown_and_not_obeyed(read, page):
    assert "<script" not in page.lower()
    assert visible(read).count(HOSTILE) >= 2  # as a title and in a refusal


def test_runs_that_failed_are_named_with_their_reason(read):
    text = visible(read)
    assert f"{STALLED}. Stalled: the residual no longer falls" in text
    assert f"{REFUSED}. refused: No mesh for" in text
    # together with the pulls of the strip that have no result here
    assert re.search(rf"{MISSING}, [^:]* others\. not run: No result folder was found", text)


def test_paper_figures_are_all_there(read):
    text = visible(read)
    for figure in (
        "Fig. 3.",
        "Fig. 4.",
        "Fig. 5.",
        "Fig. 6.",
        "Fig. 7.",
        "Fig. 8 a.",
        "Fig. 8 b, c.",
        "Fig. 9.",
        "Fig. 10 a.",
        "Fig. 10 b.",
    ):
        assert figure in text


def test_verification_shows_value_limit_and_reason(read):
    text = visible(read)
    for words in (
        "0 of 1 verification runs passed",
        "3.100e-4",
        "at most 0.0003",
        "second order at this mesh",
        "NO",
    ):
        assert words in text
    assert "Annulus against its <closed> form" in text
    assert "Every quantity of the verification runs, with its limit. 1 rows." in text
    assert [tag for tag, _ in read.tags].count("details") == 1  # closed until a reader opens it
    assert re.search(r"limits held.*failed *0 of 1", text)


def test_footer_has_versions_and_machine(read):
    text = visible(read)
    footer = text[text.index("Versions and machine") :]
    assert "numpy" in footer


def test_unknown_block_text_is_escaped_in_tables_and_lists():
    blocks = [Table("<c>", ("<h>",), (("<r>",),)), Text("<t>", ("<i>",))]
    page = render_page(Report("<title>", "<s>", [Section("a", "<S>", blocks)], ["<f>"]))
    for raw in ("<c>", "<h>", "<r>", "<t>", "<i>", "<s>", "<S>", "<f>"):
        assert raw not in page
        assert raw.replace("<", "&lt;").replace(">", "&gt;") in page


def test_words_between_backticks_are_code_and_nothing_else_is():
    texts = ("run `wrinkle <x>` twice", "a ` alone", "`a` and `b`")
    blocks = [Table(texts[0], (texts[2],), ((texts[1],),)), Text(texts[0], (texts[2],))]
    page = render_page(Report("t", "s", [Section("a", "S", blocks)], ["f"]))
    assert page.count("run <code>wrinkle &lt;x&gt;</code> twice") == 2
    assert page.count("<code>a</code> and <code>b</code>") == 2
    assert "a ` alone" in page
    assert 'aria-label="run wrinkle &lt;x&gt; twice"' in page


@pytest.mark.parametrize("vector", [True, False])
def test_equal_results_give_equal_images_at_any_time(report, page, vector):
    blocks = [block for section in report.sections for block in section.blocks]
    assert data_uri(next(b for b in blocks if isinstance(b, Drawing) and b.vector is vector)) in page


@pytest.mark.parametrize(
    ("cell", "number"), [("1.2e-5", True), ("−3", True), ("20\u2009100", True), ("–", True), ("yes", False)]
)
def test_is_number(cell, number):
    assert is_number(cell) is number


def test_numeric_column_has_no_word():
    assert numeric_columns(Table("", ("a", "b"), (("1", "1"), ("2", "stalled")))) == [True, False]


def test_failed_write_leaves_the_old_page(tmp_path, monkeypatch):
    target = tmp_path / "index.html"
    target.write_text("old")
    monkeypatch.setattr("reports.page.render_page", lambda report: "half a surrogate \ud800")
    with pytest.raises(UnicodeEncodeError):
        write_page(Report("", "", [], []), target)
    assert target.read_text() == "old"
