"""The Python blocks of the pages print what the pages show, and the reference is that of the docstrings.

A block that begins with ```python is run, in the order of its page; a block ```text right behind it is what it prints. With
HMAX_UPDATE_PAGES=1 in the environment pages are rewritten.
"""

import contextlib
import inspect
import io
import os
import pathlib
import re
import subprocess
import sys

import hmax
import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
UPDATE = os.environ.get("HMAX_UPDATE_PAGES")
BLOCK = re.compile(r"^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```\n)?", re.M | re.S)


def alike(told, shown):
    """Equal words; numbers may differ by rounding."""
    a, b = told.split(), shown.split()

    def close(x, y):
        if x == y:
            return True
        try:
            return abs(float(x) - float(y)) <= 1e-6 * abs(float(y))
        except ValueError:
            return False

    return len(a) == len(b) and all(map(close, a, b))


def run(code, names):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "page", "exec"), names)  # the pages of this repository
    return out.getvalue()


@pytest.mark.parametrize("page", ["README.md", "docs/howto/python.md"])
def test_blocks_print_what_is_shown(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (SOURCE / page).read_text()
    names, wrong = {"__name__": "page"}, []

    def checked(block):
        printed, shown = run(block[1], names), block[2] or ""
        if alike(printed, shown):
            return block[0]
        wrong.append(printed)
        return f"```python\n{block[1]}```\n\n```text\n{printed}```\n"

    updated, count = BLOCK.subn(checked, text)
    assert count >= 1
    if wrong and UPDATE:
        (SOURCE / page).write_text(updated)
    assert not wrong


def test_a_block_that_prints_something_else_is_found():
    assert alike("a 1.0000000001", "a  1.0") and not alike("a 1.01", "a 1.0") and not alike("a", "a b")


def made_by(*options):
    command = [sys.executable, SOURCE / "scripts/python-reference", *options]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_the_reference_is_that_of_the_docstrings():
    path = SOURCE / "docs/reference/python.md"
    page = made_by("--short")
    if UPDATE:
        path.write_text(page)
    assert path.exists() and path.read_text() == page


def test_the_page_of_the_site_has_every_call_with_parameters_and_example():
    page = made_by()
    for name in hmax.__all__:
        thing = getattr(hmax, name)
        if inspect.isfunction(thing):
            part = page[page.index(f"\n## {name}\n"):].split("\n## ")[1]
            assert f"    hmax.{name}(" in part and ">>> import hmax" in part
            for parameter in inspect.signature(thing).parameters:
                assert parameter in part.split("(", 1)[1], (name, parameter)
    assert "### Body.K" in page and "- `h_max`: " in page
