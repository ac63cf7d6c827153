"""Progress displays."""

from maggi.cli.progress import Bar, Lines, Silent, display


def run(progress, steps=1000):
    with progress as shown:
        shown.stage("factorising rod (30,123 freedoms)")
        for step in range(1, steps + 1):
            shown.advance(step, steps, 1e-3 * step, "1 iteration")
    assert progress.step == steps


def test_lines_are_few(capsys):
    run(Lines())
    said = capsys.readouterr()
    lines = said.err.splitlines()
    assert lines[0] == "factorising rod (30,123 freedoms)"
    assert lines[1] == " 10 %  step 100 of 1,000  t = 0.1 s  1 iteration"
    assert len(lines) == 11
    assert said.out == ""


def test_silent(capsys):
    run(Silent())
    assert capsys.readouterr() == ("", "")


def test_bar(capsys):
    run(Bar())
    said = capsys.readouterr()
    assert "factorising rod (30,123 freedoms)" in said.err
    assert said.out == ""


def test_choice(monkeypatch):
    assert type(display(quiet=True)) is Silent
    assert type(display(quiet=False)) is Lines  # pytest's standard error is no terminal
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    assert type(display(quiet=False)) is Bar
