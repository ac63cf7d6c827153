"""What the documents say is true: models are read, keys and paths are all there, snippets run."""

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import fake_runs
import pytest
from ruamel.yaml import YAML

import maggi
from maggi.modelfile import json_schema, read_text
from maggi.results.contract import columns, constants
from maggi.results.store import FileRecorder

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]


def blocks(page, language):
    """The fenced blocks of a page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


WHOLE, *FRAGMENTS = blocks(DOCS / "model-file.md", "yaml")
(README_MODEL,) = blocks(ROOT / "README.md", "yaml")


@pytest.mark.parametrize("text", [WHOLE, README_MODEL], ids=["model-file.md", "README.md"])
def test_whole_models(text):
    model, _ = read_text(text)
    found = maggi.check(model)
    assert found.problems == ()
    assert found.unused in ((), ("bar.tip",))


@pytest.mark.parametrize("fragment", FRAGMENTS, ids=lambda text: text.split("\n")[1].strip(" :")[:20])
def test_fragments(fragment):
    """Each goes into the page's whole model."""
    yaml = YAML(typ="safe")
    whole, part = yaml.load(WHOLE), yaml.load(fragment)
    for key, value in part.items():
        whole[key] = {**whole.get(key, {}), **value}
    model, _ = read_text(json.dumps(whole))
    assert maggi.check(model).problems == ()


def test_every_key_is_explained():
    page = (DOCS / "model-file.md").read_text(encoding="utf-8")
    schema = json_schema()
    keys = {key for part in [schema, *schema["$defs"].values()] for key in part.get("properties", {})}
    missing = {key for key in keys if not re.search(rf"(?<![\w.]){re.escape(key)}(?![\w])", page)}
    assert missing == set()


def test_every_table_of_the_result_file_is_explained():
    page = (DOCS / "results.md").read_text(encoding="utf-8")
    layout = fake_runs.layout(1)
    kept = ("bodies", "attachments", "displacement", "joints", "energy", "residuals")
    for path in [one.path for one in columns(layout, kept)] + [one.path for one in constants(layout)]:
        path = re.sub(r"^(bodies|joints)/[^/]+", r"\1/<name>", path)
        path = re.sub(r"attachments/[^/]+", "attachments/<att>", path)
        path = re.sub(r"cells/[^/]+", "cells/<type>", path)
        group, _, name = path.rpartition("/")
        rows = [line for line in page.splitlines() if line.startswith("| `/")]
        assert any(f"`/{path}`" in line or (f"`/{group}/" in line and f"`{name}`" in line) for line in rows), path


def test_snippets_about_results_run(tmp_path):
    (snippet,) = blocks(DOCS / "results.md", "python")
    fake_runs.record(FileRecorder(tmp_path / "slider_crank.h5"), 5)
    found = subprocess.run([sys.executable, "-c", snippet], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert float(found.stdout.split()[1]) == pytest.approx(0.8 * fake_runs.FORCE, rel=0.01)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_and_paths_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)\)", text):
        assert (page.parent / target).exists(), target
    for name in re.findall(r"`((?:\w+/)+\w+\.py)`", text):
        assert any((start / name).exists() for start in (ROOT, ROOT / "src" / "maggi")), name


@pytest.mark.slow
def test_commands_and_snippet_of_the_readme(tmp_path):
    """On the same model, run for a shorter time."""
    text = README_MODEL.replace("duration: 0.2", "duration: 0.002")
    assert text != README_MODEL
    (tmp_path / "bar.yml").write_text(text)
    (commands,) = [block for block in blocks(ROOT / "README.md", "sh") if "maggi check" in block]
    environment = {**os.environ, "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])}
    for line in commands.splitlines():
        command = line.replace(".venv/bin/maggi", f"{shlex.quote(sys.executable)} -m maggi")
        subprocess.run(command, shell=True, cwd=tmp_path, env=environment, check=True, capture_output=True)
    assert {"bar.h5", "bar_model.png", "bar_mechanism.png", "bar_joints.csv"} <= set(os.listdir(tmp_path))
    (snippet,) = blocks(ROOT / "README.md", "python")
    said = subprocess.run([sys.executable, "-c", snippet], cwd=tmp_path, capture_output=True, text=True, check=True)
    lines = said.stdout.splitlines()
    assert float(lines[0]) > 0.0
    # 6 and all nodes' velocities but those that the two rigid ends tie, less 5 + 6 + 1 rows
    assert int(lines[-1]) == maggi.check(maggi.load(tmp_path / "bar.yml")).mobility.velocities - 12
