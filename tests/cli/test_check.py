"""`maggi check`."""

import json


def test_text_and_json(shell):
    name = shell.model()
    assert shell("check", name).stdout == "1 freedom\n"
    said = json.loads(shell("check", name, "--json").stdout)
    assert said["status"] == "complete"
    assert said["model"] == {"freedoms": 1}
