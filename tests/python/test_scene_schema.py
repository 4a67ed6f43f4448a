"""What `sandgate schema` says of scene files, read by an independent checker: every case meets it, wrong ones do not.

SANDGATE (program)
"""

import json
import os
import pathlib
import subprocess
import tomllib

import jsonschema
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASES = sorted(path for folder in (".", "phases", "paper_a", "paper_b", "validation") for path in (ROOT / "cases" / folder).glob("*.toml"))


@pytest.fixture(scope="module")
def schema():
    text = subprocess.run([os.environ["SANDGATE"], "schema"], capture_output=True, check=True, text=True).stdout
    schema = json.loads(text)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("path", CASES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_a_case_meets_the_schema(schema, path):
    assert [error.message for error in schema.iter_errors(tomllib.loads(path.read_text()))] == []


@pytest.mark.parametrize(
    "old, new",
    [
        ("spacing = ", "spacign = "),
        ("dimension = ", "dimension = 1 # "),
        ('law = "', 'law = "no_'),
        ("[run]", "[run]\nuntill = 3"),
        ("name = ", "nome = "),
        ("[log]", '[log]\nrequired = "yes"'),
        ('name = "', f'name = "{"a" * 48}'),
        ("[walls.", f"[walls.{'a' * 48}"),
        ("\nspacing = ", '\nspacing = "5 parsec" # '),
        ("\nspacing = ", '\nspacing = "50 %" # '),
        ("\nstep = ", '\nstep = "2 mm" # '),
    ],
)
def test_a_wrong_case_does_not(schema, old, new):
    texts = {path: path.read_text() for path in CASES}
    having = {path: text for path, text in texts.items() if old in text}
    # Only templates of validation do without a log or walls.
    assert all(path in having for path in CASES if path.parent.name != "validation")
    for path, text in having.items():
        assert not schema.is_valid(tomllib.loads(text.replace(old, new, 1))), f"{path.name}: {new} passes"


def test_text_has_a_unit_of_its_quantity_or_none(schema):
    """Patterns against the units beside them: each is taken, spaced in any way, and those of other quantities are not."""
    found = {}

    def walk(value):
        if isinstance(value, dict):
            if "x-units" in value:
                found[value["x-quantity"]] = value
            for inner in value.values():
                walk(inner)
        elif isinstance(value, list):
            for inner in value:
                walk(inner)

    walk(schema.schema)
    assert len(found) >= 10
    # "1" is a digit more behind any number.
    units = {unit for quantity in found.values() for unit in quantity["x-units"]} - {"1"}
    for quantity in found.values():
        taken = jsonschema.Draft202012Validator({"type": quantity["type"], "pattern": quantity["pattern"]}).is_valid
        own = set(quantity["x-units"])
        for form in ("2 {}", "2{}", " -1.5e-3  {} ", ".5 {}", "+2. {}"):
            assert all(taken(form.format(unit)) for unit in own | {""})
            assert not any(taken(form.format(unit)) for unit in (units | {"parsec"}) - own)
        assert not taken("") and not taken("m") and not taken("two m") and taken(2.0)
    length, angle = found["length"]["pattern"], found["angle"]["pattern"]
    for pattern, text in ((length, "20 µm"), (length, "20 μm"), (angle, "30°")):
        jsonschema.validate(text, {"pattern": pattern})
