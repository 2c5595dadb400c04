"""Scripts as pages: scripts/notebook, and the page of the example."""

import html
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import unittest.mock

import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]

SCRIPT = '''# %% [markdown]
# # A page
# Words with `code` & more.

# %%
x = "a < b"  # a note
print(x)

# %%
import matplotlib.pyplot as plt
plt.plot([0, 1], [0, 1])
'''


def text_of(markup):
    return html.unescape(re.sub(r"<[^>]*>", "", markup))


def code_cells(script):
    parts = re.split(r"^# %%(.*)\n", script, flags=re.M)[1:]
    return [body.strip("\n") for head, body in zip(parts[::2], parts[1::2]) if "markdown" not in head]


def code_blocks(page):
    return [text_of(block) for block in re.findall(r'<pre class="code">(.*?)</pre>', page, flags=re.S)]


def test_a_page_has_text_code_output_and_figures(tmp_path):
    if not importlib.util.find_spec("matplotlib"):
        pytest.skip("matplotlib is not installed")
    (tmp_path / "script.py").write_text(SCRIPT)
    command = [sys.executable, SOURCE / "scripts/notebook", tmp_path / "script.py", tmp_path / "page.html"]
    subprocess.run(command, check=True, env={**os.environ, "MPLCONFIGDIR": str(tmp_path)})
    page = (tmp_path / "page.html").read_text()
    assert "<h1>A page</h1>" in page and "<p>Words with <code>code</code> &amp; more.</p>" in page
    assert code_blocks(page) == code_cells(SCRIPT)
    assert '<pre class="output">a &lt; b\n</pre>' in page
    assert page.count("<figure><svg") == 1
    assert "http://" not in re.sub(r'xmlns[^ ]*="[^"]*"|rdf:[^ ]*="[^"]*"|<!DOCTYPE[^>]*>|<metadata>.*?</metadata>', "", page, flags=re.S)


def test_the_tour_becomes_a_page_with_its_figures(tmp_path):
    if not importlib.util.find_spec("matplotlib"):
        pytest.skip("matplotlib is not installed")
    script = SOURCE / "python/examples/python_tour.py"
    command = [sys.executable, SOURCE / "scripts/notebook", script, tmp_path / "tour.html"]
    subprocess.run(command, check=True, env={**os.environ, "MPLCONFIGDIR": str(tmp_path)})
    page = (tmp_path / "tour.html").read_text()
    assert code_blocks(page) == code_cells(script.read_text())
    assert len(page) < 1_000_000 and page.count("<figure>") == 4


def test_every_cell_of_the_tour_runs():
    """Without matplotlib too: figures are dropped, the calls of hmax are run."""
    cells = code_cells((SOURCE / "python/examples/python_tour.py").read_text())
    assert len(cells) > 5
    pyplot = unittest.mock.MagicMock()
    modules = {"matplotlib": unittest.mock.MagicMock(pyplot=pyplot), "matplotlib.pyplot": pyplot}
    names = {"__name__": "__main__"}
    with unittest.mock.patch.dict(sys.modules, modules):
        for cell in cells:
            exec(compile(cell, "python_tour.py", "exec"), names)
