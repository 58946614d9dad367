"""The tutorial runs from its first cell to its last, and draws."""

import nbclient
import nbformat

from conftest import ROOT


def test_the_tutorial_runs(tmp_path):
    notebook = nbformat.read(ROOT / "docs" / "tutorial.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    kinds = {kind for output in outputs if "data" in output for kind in output["data"]}
    assert {"text/html", "image/png"} <= kinds
    assert not any(output.output_type == "error" for output in outputs)
