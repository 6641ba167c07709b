"""The notebook is what its source says, and runs from top to bottom."""

import os
import re
from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
for name in ("ipykernel", "matplotlib", "sklearn"):
    pytest.importorskip(name)

SOURCE = Path(__file__).parents[1] / "notebook.py"
NOTEBOOK = SOURCE.with_suffix(".ipynb")


def made():
    """The notebook of the source: a cell begins with `# %%`."""
    notebook = nbformat.v4.new_notebook(metadata={"kernelspec": {"name": "python3", "display_name": "Python 3"}})
    for number, text in enumerate(re.split(r"^# %%", SOURCE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]):
        head, text = text.split("\n", 1)
        if "markdown" in head:
            cell = nbformat.v4.new_markdown_cell(re.sub("^# ?", "", text.strip(), flags=re.MULTILINE))
        else:
            cell = nbformat.v4.new_code_cell(text.strip())
        cell.id = f"cell-{number}"
        notebook.cells.append(cell)
    return notebook


def test_the_notebook_is_its_source():
    text = nbformat.writes(made()) + "\n"
    if os.environ.get("UPDATE_EXPECT"):
        NOTEBOOK.write_text(text, encoding="utf-8")
    assert NOTEBOOK.read_text(encoding="utf-8") == text
    assert len(made().cells) <= 15


def test_the_notebook_runs(tmp_path):
    notebook = made()
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}}).execute()
    pictures = [
        data
        for cell in notebook.cells
        for output in cell.get("outputs", ())
        for data in output.get("data", {})
        if data in ("image/png", "image/svg+xml")
    ]
    assert sorted(pictures) == ["image/png"] * 4 + ["image/svg+xml"] * 2
    if folder := os.environ.get("NOTEBOOK_OUT"):
        nbformat.write(notebook, Path(folder) / "notebook.ipynb")
