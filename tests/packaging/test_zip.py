"""The extension zip: holds the add-on, the wheel and the license, nothing else, and Blender accepts it."""

import html.parser
import tomllib
import zipfile

import products
import pytest

ADDON = products.ROOT / "addon"
NOT_SHIPPED = {"__pycache__", "docs", "CHANGELOG.md"}
"""Parts of `addon` that stay in the repository: the documents are read there."""
PLATFORMS = {"linux-x64", "windows-x64", "macos-arm64", "macos-x64", "windows-arm64", "linux-arm64"}


@pytest.fixture(scope="module")
def names():
    with zipfile.ZipFile(products.ZIP) as archive:
        assert archive.testzip() is None
        return set(archive.namelist())


@pytest.fixture(scope="module")
def manifest():
    with zipfile.ZipFile(products.ZIP) as archive:
        return tomllib.loads(archive.read("blender_manifest.toml").decode())


def test_zip_holds_the_add_on_and_nothing_else(names):
    sources = {
        path.relative_to(ADDON).as_posix()
        for path in ADDON.rglob("*")
        if path.is_file() and not NOT_SHIPPED & set(path.parts) and not path.name.startswith(".")
    }
    expected = sources | {"LICENSE", f"wheels/{products.WHEEL.name}"}
    assert {name for name in names if not name.endswith("/") and not name.startswith("manual/")} == expected


def test_manual_has_every_page_and_no_link_leads_nowhere(names):
    """Read by the standard library's HTML parser: pages, anchors and pictures that are linked are in the zip."""
    pages = {}
    with zipfile.ZipFile(products.ZIP) as archive:
        for name in sorted(names):
            if name.startswith("manual/") and name.endswith(".html"):
                pages[name.removeprefix("manual/")] = Links(archive.read(name).decode("utf-8"))
    assert set(pages) == {f"{path.stem}.html" for path in (ADDON / "docs").glob("*.md")}
    for name, page in pages.items():
        assert len(page.anchors) > 2, name
        for link in page.links:
            if link.startswith("https://"):
                continue
            file, _, anchor = link.partition("#")
            assert f"manual/{file or name}" in names, (name, link)
            assert not anchor or anchor in pages[file or name].anchors, (name, link)


class Links(html.parser.HTMLParser):
    """`links` and `anchors` of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        self.anchors.update(filter(None, [values.get("id")]))
        self.links.extend(filter(None, [values.get("href"), values.get("src")]))


def test_zip_holds_no_tests_caches_or_sources(names):
    forbidden = ("__pycache__", ".pyc", ".rs", "test_", "conftest", ".git", ".blend1", "egg-info", "docs/")
    assert not [name for name in names if any(word in name for word in forbidden)]


def test_zip_holds_the_wheel_that_was_built():
    with zipfile.ZipFile(products.ZIP) as archive:
        assert archive.read(f"wheels/{products.WHEEL.name}") == products.WHEEL.read_bytes()


def test_manifest_follows_the_platform_rules(manifest):
    assert manifest["id"] == "thenar" and manifest["type"] == "add-on"
    assert manifest["version"] == products.VERSION
    assert manifest["platforms"] == ["linux-x64"] and set(manifest["platforms"]) <= PLATFORMS
    assert manifest["wheels"] == [f"./wheels/{products.WHEEL.name}"]
    assert manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert manifest["blender_version_min"] == "4.2.0" and "blender_version_max" not in manifest
    assert len(manifest["tagline"]) <= 64 and manifest["tagline"][-1].isalnum()
    assert "blender" not in manifest["name"].lower()
    assert set(manifest["permissions"]) == {"files", "network"}
    assert all(len(text) <= 64 and not text.endswith(".") for text in manifest["permissions"].values())


@pytest.mark.parametrize("environment", products.BLENDERS)
def test_blender_validates_the_zip(environment):
    assert validate(environment, products.ZIP).returncode == 0


@pytest.mark.parametrize("environment", products.BLENDERS)
def test_validation_sees_an_unknown_tag(environment, tmp_path):
    with zipfile.ZipFile(products.ZIP) as archive:
        text = archive.read("blender_manifest.toml").decode()
    broken = tmp_path / "broken.zip"
    with zipfile.ZipFile(broken, "w") as archive:
        archive.writestr("__init__.py", "")
        archive.writestr("blender_manifest.toml", text.replace('"Physics"', '"NotATag"'))
    end = validate(environment, broken)
    assert end.returncode != 0 and "NotATag" in end.stdout + end.stderr


def validate(environment, zip_path):
    scripts = products.blender_scripts(environment)
    tags = scripts / "modules/_bpy_internal/extensions/tags.py"
    script = scripts / "addons_core/bl_pkg/cli/blender_ext.py"
    return products.run(environment, [script, "validate", f"--valid-tags={tags}", zip_path])
