# SPDX-License-Identifier: Apache-2.0
"""Validates the JSON of the commands with the installed schemas.

The schemas allow additional keys for later versions; this test does not, so that a key without a schema fails.
"""
import json
import pathlib
import re

try:
    import jsonschema
except ImportError:
    jsonschema = None

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "tools/ifog/schemas"


def strict(node):
    """The schema with all objects closed that list properties."""
    if isinstance(node, dict):
        node = {key: strict(value) for key, value in node.items()}
        if isinstance(node.get("properties"), dict):
            node.setdefault("additionalProperties", False)
        return node
    return [strict(item) for item in node] if isinstance(node, list) else node


def of(name):
    """The schema of "ifog.allan/1"."""
    path = FOLDER / (re.fullmatch(r"ifog\.(\w+)/(\d+)", name).expand(r"\1-\2") + ".schema.json")
    assert path.exists(), f"{name} has no schema: {path.name} is missing in tools/ifog/schemas"
    return json.loads(path.read_text())


def check(document):
    """AssertionError with place and reason if a document does not agree with its schema."""
    if jsonschema is None:
        return  # the test of the schemas reports that
    schema = of(document["schema"])
    jsonschema.Draft202012Validator.check_schema(schema)
    errors = [f"{'.'.join(map(str, error.absolute_path)) or 'the document'}: {error.message[:200]}"
              for error in jsonschema.Draft202012Validator(strict(schema)).iter_errors(document)]
    assert not errors, f"{document['schema']}: {'; '.join(errors)}"
