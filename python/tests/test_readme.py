"""The README's blocks run one after the other in an empty folder, as a new user pastes them."""

import re
from pathlib import Path

import pytest

README = Path(__file__).parents[1] / "README.md"


def test_blocks_run_in_an_empty_folder(tmp_path, monkeypatch, capsys):
    pytest.importorskip("sklearn")
    monkeypatch.chdir(tmp_path)
    names = {}
    blocks = re.findall(r"```(python|json)\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    for kind, text in blocks:
        if kind == "json":
            Path("lake.geojson").write_text(text)
        else:
            exec(compile(text, str(README), "exec"), names)
    assert capsys.readouterr().out.startswith("known ")
    assert abs(names["answer"].estimate["slope"] - 0.41) < 0.05
    assert names["model"].predict_proba(names["grid"]).shape == (81 * 81, 2)
    assert len(names["flight"].front) > 10
    assert '"kind": "track"' in Path("track.geojson").read_text()
    assert names["planner"].plan().pose.keys() == {"lat", "lon", "heading"}
    assert {row["field"] for row in names["rows"]} == set(range(100))
