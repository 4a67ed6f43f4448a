"""Every case's FMUs under the checks of others: FMPy's validation, fmu-manipulation-toolbox, the schemas, zip rules.

SANDGATE_FMUS holds the paths. Run by tests/it/drivers.rs, which packs them first.
"""

import logging
import os
import sys
import zipfile

import fmpy
import pytest
from fmpy.validation import validate_fmu
from fmu_manipulation_toolbox.cli.fmutool import fmutool
from lxml import etree

FMUS = os.environ["SANDGATE_FMUS"].split(os.pathsep)
each = pytest.mark.parametrize("path", FMUS, ids=[os.path.basename(path) for path in FMUS])


@each
def test_fmpy_finds_no_fault(path):
    assert validate_fmu(path) == []


@each
def test_the_manipulation_toolbox_finds_no_fault(path, monkeypatch, caplog):
    """`fmutool -input x.fmu -summary -check`: no error, no warning."""
    monkeypatch.setattr(sys, "argv", ["fmutool", "-input", path, "-summary", "-check"])
    with caplog.at_level(logging.INFO):
        try:
            code = fmutool()
        except SystemExit as end:
            code = end.code
    assert code in (None, 0)
    bad = [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]
    assert bad == []


@each
def test_the_archive_keeps_the_rules_of_zip_files_in_fmus(path):
    size = os.path.getsize(path)
    assert size < 4_000_000
    with open(path, "rb") as file:
        raw = file.read()
    # No zip64: neither its end record nor its locator, and no entry that asks for its version.
    assert b"PK\x06\x06" not in raw[-200:] and b"PK\x06\x07" not in raw[-200:]
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None and archive.comment == b""
        entries = archive.infolist()
        names = [entry.orig_filename for entry in entries]
        assert len(set(name.lower() for name in names)) == len(names)
        for entry in entries:
            assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
            assert entry.date_time == (1980, 1, 1, 0, 0, 0)
            assert "\\" not in entry.orig_filename and not entry.filename.startswith("/")
            assert ".." not in entry.filename.split("/") and entry.filename.isascii()
            # Not encrypted, no data descriptor behind the entry, no extra field (zip64 would be one).
            assert entry.flag_bits & ~0x800 == 0 and entry.extra == b"" and entry.extract_version <= 20
            header = raw[entry.header_offset : entry.header_offset + 30]
            assert header[:4] == b"PK\x03\x04" and int.from_bytes(header[28:30], "little") == 0
    assert names[0] == "modelDescription.xml"


@each
def test_what_the_archive_holds(path):
    description = fmpy.read_model_description(path)
    id = description.coSimulation.modelIdentifier
    with zipfile.ZipFile(path) as archive:
        names = set(archive.namelist())
        binaries = {name for name in names if name.startswith("binaries/")}
        folder = "linux64" if description.fmiVersion == "2.0" else "x86_64-linux"
        assert binaries == {f"binaries/{folder}/{id}.so"}
        page = archive.read("documentation/index.html").decode()
        scene = archive.read("resources/scene.toml")
        (binary,) = binaries
        assert scene in archive.read(binary), "the scene is inside the library"
        for name in ("license.txt", "license.spdx", "third_party.txt"):
            assert archive.read(f"documentation/licenses/{name}")
        extra = "extra/org.fmi-standard.fmi-ls-ref/"
        manifest = etree.fromstring(archive.read(extra + "fmi-ls-manifest.xml"))
    ls = "{http://fmi-standard.org/fmi-ls-manifest}"
    assert manifest.tag == "fmiReferences"
    assert manifest.get(ls + "fmi-ls-name") == "org.fmi-standard.fmi-ls-ref"
    roles = {}
    for related in manifest.iter("Related"):
        source = os.path.normpath(extra + related.get("source"))
        assert source in names and related.get("type") and related.get("description")
        roles[related.get("role")] = source
    assert set(roles) == {"testcase", "result", "model", "document"}
    # Well-formed but for HTML's entities: none are used. All variables are there, and a picture.
    html = etree.fromstring(page.replace("<!DOCTYPE html>", "").replace('<meta charset="utf-8">', ""))
    shown = {code.text for code in html.iter("code")}
    assert {v.name for v in description.modelVariables} <= shown
    assert html.find(".//{http://www.w3.org/2000/svg}svg") is not None
    assert "Zenoh" in page and "MCAP" in page
