"""The README and the pages: short enough, and every link in the project leads somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / f"{name}.md" for name in ("README", "CONTRIBUTING", "SECURITY", "CHANGELOG")]
PAGES += sorted((ROOT / "docs").rglob("*.md"))
PAGES += sorted((ROOT / "nodes").glob("*/README.md"))


def test_the_readme_is_read_in_a_few_minutes():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").split()) <= 900


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text(encoding="utf-8"))
    inside = [link for link in links if "://" not in link and not link.startswith("mailto:")]
    assert [link for link in inside if not (page.parent / link).exists()] == []


def slugs(page: Path) -> set[str]:
    """Anchors of a page's headings, as GitHub and MyST make them."""
    titles = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w\s-]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_to_sections_lead_to_a_heading(page):
    links = re.findall(r"\]\(([^)#\s:]*)#([\w-]+)\)", page.read_text(encoding="utf-8"))
    assert [
        f"{target}#{anchor}"
        for target, anchor in links
        if anchor not in slugs(page.parent / target if target else page)
    ] == []


@pytest.mark.parametrize("page", sorted((ROOT / "docs").rglob("*.md")), ids=lambda page: page.stem)
def test_pages_of_the_site_link_to_no_page_outside_of_it(page):
    links = re.findall(r"\]\(([^)#\s:]+\.md)", page.read_text(encoding="utf-8"))
    outside = [li for li in links if ROOT / "docs" not in (page.parent / li).resolve().parents]
    assert outside == []


def test_the_floor_plan_names_every_room():
    plan = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split("## Words")[0]
    package = ROOT / "facecrf_ocio"
    rooms = {f"{p.parent.name}/" for p in package.glob("*/__init__.py")}
    modules = {p.name for p in package.glob("*.py") if p.name != "__init__.py"}
    named = set(re.findall(r"`([a-z_]+(?:/|\.py))`", plan))
    assert (rooms | modules) - named == set()
    assert {name for name in named if not (package / name).exists()} == {
        "nodes/",
        "luts/",
        "examples/",
    }


def test_what_is_sought_stands_where_the_table_says():
    table = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split("## Where is")[1]
    files = re.findall(r"`([a-z_/]+\.py)`", table.split("## Tests")[0])
    assert len(files) >= 5
    assert [name for name in files if not (ROOT / "facecrf_ocio" / name).exists()] == []


def test_every_page_is_in_a_table_of_contents():
    listed = "\n".join(p.read_text(encoding="utf-8") for p in (ROOT / "docs").rglob("*.md"))
    pages = [p for p in (ROOT / "docs").rglob("*.md") if p.name != "index.md"]
    assert [p.stem for p in pages if not re.search(rf"^(\w+/)?{p.stem}$", listed, re.M)] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_prose_is_broken_at_120_columns(page):
    """Tables and pictures may be wider: a line of theirs cannot be broken."""
    lines = page.read_text(encoding="utf-8").splitlines()
    prose = [line for line in lines if not line.lstrip().startswith(("|", "!["))]
    assert [line for line in prose if len(line) > 120] == []


def test_the_page_of_results_begins_with_the_findings():
    findings = (ROOT / "examples" / "results" / "findings.md").read_text(encoding="utf-8")
    results = (ROOT / "examples" / "RESULTS.md").read_text(encoding="utf-8")
    assert results.startswith(f"# Results\n\n{findings.strip()}\n\n## ")
    named = re.findall(r"`(docs/[\w./-]+)`", findings)
    assert named
    assert [name for name in named if not (ROOT / name).exists()] == []
