"""Every block of Python in docs/python.md runs, but those that say why not."""

import re

from conftest import ROOT

BLOCK = re.compile(r"(?:^<!-- not run: [^\n]+? -->\n)?^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def test_the_blocks_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "python.md").read_text()
    blocks = [match.group(1) for match in BLOCK.finditer(text) if not match.group(0).startswith("<!--")]
    assert len(blocks) >= 4
    exec(compile("\n".join(blocks), "docs/python.md", "exec"), {})
