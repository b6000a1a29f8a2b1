"""Platforms: release workflow, manifest and README name the same; Blender's script makes a valid zip for each."""

import os
import re
import tomllib
import zipfile

import products
import pytest

ASKED = os.environ.get("THENAR_BLENDERS", " ".join(products.BLENDERS.values())).split()
OF_TARGET = {
    "x86_64-unknown-linux-gnu": ("linux-x64", "manylinux_2_28_x86_64"),
    "aarch64-unknown-linux-gnu": ("linux-arm64", "manylinux_2_28_aarch64"),
    "x86_64-pc-windows-msvc": ("windows-x64", "win_amd64"),
    "aarch64-apple-darwin": ("macos-arm64", "macosx_11_0_arm64"),
}
"""Rust's target: what Blender calls it, and the tag of its wheel."""


def released():
    """Targets for which the release workflow builds wheels."""
    return re.findall(r"[{ ]target: ([\w-]+)", (products.ROOT / ".github/workflows/release.yml").read_text())


def test_workflow_and_manifest_name_the_same_platforms():
    template = tomllib.loads((products.ROOT / "addon/blender_manifest.toml").read_text())
    assert [OF_TARGET[target][0] for target in released()] == template["platforms"]


def test_readme_names_every_platform_of_the_manifest():
    template = tomllib.loads((products.ROOT / "addon/blender_manifest.toml").read_text())
    readme = (products.ROOT / "README.md").read_text()
    assert not [name for name in template["platforms"] if f"`{name}`" not in readme]


@pytest.mark.parametrize("version", [version for version in products.MATRIX if version in ASKED])
def test_blender_makes_one_valid_zip_for_each_platform(version, tmp_path):
    """Names only: every platform gets a copy of the Linux wheel under the name that its own would have."""
    environment = products.MATRIX[version]
    if not (products.TARGET / environment).exists():
        pytest.skip(f"Blender {version}: target/{environment} is missing; `cargo xtask blenders {version}` makes it")
    stage = tmp_path / "stage"
    with zipfile.ZipFile(products.ZIP) as archive:
        archive.extractall(stage)
    wheel = stage / "wheels" / products.WHEEL.name
    platforms = dict(OF_TARGET[target] for target in released())
    names = [wheel.name.replace("manylinux_2_28_x86_64", tag) for tag in platforms.values()]
    for name in names:
        (stage / "wheels" / name).write_bytes(wheel.read_bytes())
    manifest = stage / "blender_manifest.toml"
    text = re.sub(r"(?m)^platforms = .*$", f"platforms = {list(platforms)}", manifest.read_text())
    text = re.sub(r"(?m)^wheels = .*$", f"wheels = {[f'./wheels/{name}' for name in names]}", text)
    manifest.write_text(text)
    scripts = products.blender_scripts(environment)
    script = scripts / "addons_core/bl_pkg/cli/blender_ext.py"
    tags = f"--valid-tags={scripts / 'modules/_bpy_internal/extensions/tags.py'}"
    out = tmp_path / "dist"
    out.mkdir()
    call = [script, "build", "--split-platforms", f"--source-dir={stage}", f"--output-dir={out}", tags]
    built = products.run(environment, call, seconds=300)
    assert built.returncode == 0, built.stdout + built.stderr
    assert len(list(out.iterdir())) == len(platforms)
    for platform, name in zip(platforms, names, strict=True):
        path = out / f"thenar-{products.VERSION}-{platform.replace('-', '_')}.zip"
        with zipfile.ZipFile(path) as archive:
            assert [each for each in archive.namelist() if each.endswith(".whl")] == [f"wheels/{name}"]
            generated = tomllib.loads(archive.read("blender_manifest.toml").decode())["build"]["generated"]
            assert generated["platforms"] == [platform], "what Blender reads in place of the manifest's own list"
        valid = products.run(environment, [script, "validate", tags, path])
        assert valid.returncode == 0, valid.stdout + valid.stderr
