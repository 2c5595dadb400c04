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


HEAD = """# Python

*Reference.* The calls of `import hmax`. [Use hmax from Python](../howto/python.md) shows them at work. This page is made from the
docstrings.

Arrays are of numpy, sparse matrices of scipy.sparse; dense arrays of other types are converted. Input that is wrong raises `ValueError`.
Calls release the GIL; functions that are given are called from the calling thread. After Ctrl-C a call returns at once; what it
computes between two outputs, such as eigenvalues, may go on in the background until the next one. In Python, SUNDIALS
takes elementary functions from libm, the rest of hmax its own.

"""


def first_line(thing):
    return inspect.getdoc(thing).splitlines()[0]


def signature_of(thing):
    text = str(inspect.signature(thing)).replace("typing.", "")
    parameters = re.sub(r": '[^']*'", "", text).replace(" = ", "=")
    return re.sub(r" -> .*", "", parameters).replace("(self, ", "(").replace("(self)", "()")


def section(name, thing, level="##"):
    """A heading with the signature, and the docstring: prose, parameters as a list, the example as a block."""
    text = inspect.getdoc(thing)
    example = text[text.index(">>> import hmax"):] if ">>> import hmax" in text else ""
    prose = text[: len(text) - len(example)] if example else text
    prose = re.sub(r"^(Parameters|Returns)\n-+\n", "", prose, flags=re.M)
    prose = re.sub(r"\n    (\S)", r" \1", prose)  # continued lines
    prose = re.sub(r"^([a-zA-Z0-9_]+(?:, [a-zA-Z0-9_]+)*) : ", lambda found: "- `" + found[1] + "`: ", prose, flags=re.M)
    call = f"hmax.{name}" if level == "##" else name.replace("Body", "body")
    parts = [f"{level} {name}", f"    {call}{signature_of(thing)}", prose.strip()]
    if example:
        parts.append("```pycon\n" + example.strip() + "\n```")
    return "\n\n".join(parts) + "\n\n"


def fields_of(name):
    """The attributes of a dataclass as a table, from the text below each of them."""
    source = inspect.getsource(getattr(hmax, name))
    rows = re.findall(r'^    (\w+): ([^\n=]+?)(?: = [^\n]*)?\n(?:    """(.*?)""")?', source, flags=re.M | re.S)
    lines = [f"## {name}", first_line(getattr(hmax, name)), "| attribute | type | meaning |\n| --- | --- | --- |"]
    table = "\n".join(f"| `{field}` | `{kind}` | {' '.join(meaning.split())} |" for field, kind, meaning in rows)
    return "\n\n".join(lines) + "\n" + table + "\n\n"


def reference():
    calls = [name for name in hmax.__all__ if inspect.isfunction(getattr(hmax, name))]
    page = HEAD + "| call | what it returns |\n| --- | --- |\n"
    page += "".join(f"| [`{name}`](#{name.lower()}) | {first_line(getattr(hmax, name))} |\n" for name in calls)
    page += f"| [`Body`](#body) | {first_line(hmax.Body)} |\n\n"
    page += "".join(section(name, getattr(hmax, name)) for name in calls) + section("Body", hmax.Body)
    for name, method in vars(hmax.Body).items():
        if inspect.isfunction(method) and not name.startswith("_"):
            page += section(f"Body.{name}", method, "###")
    page += "".join(fields_of(name) for name in ("Limit", "Modes", "Run", "Mesh"))
    return page + "## Answer\n\n" + inspect.getdoc(hmax.Answer) + "\n"


def test_the_reference_is_that_of_the_docstrings():
    path = SOURCE / "docs/reference/python.md"
    page = reference()
    if UPDATE:
        path.write_text(page)
    assert path.exists() and path.read_text() == page
