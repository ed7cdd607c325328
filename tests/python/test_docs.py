"""The examples of docs/python.md do what they say."""

import re

from conftest import BUNNY, ROOT

import aerate


def test_the_examples_run(fresh, capsys):
    text = (ROOT / "docs/python.md").read_text()
    (fresh / "model.stl").write_bytes(BUNNY.read_bytes())
    names = {}
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.M | re.S)
    assert len(blocks) >= 3
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert names["result"].report["schema"] == "aerate.hollow"
    assert capsys.readouterr().out


def test_the_docstring_of_the_module_runs(fresh, capsys):
    (fresh / "model.stl").write_bytes(BUNNY.read_bytes())
    lines = [line[4:] for line in aerate.__doc__.splitlines() if line.startswith("    ")]
    code = "\n".join(lines).replace(", escape_hole=(12, 20, 0)", "")
    exec(compile(code, "aerate.__doc__", "exec"), {})
    assert capsys.readouterr().out
