//! The extension zip: staged from `addon`, built and validated by Blender's own script, installed.

use crate::environment::manual;
use crate::environment::python::BLENDER_50;
use crate::places::{Places, shown};
use crate::process;
use crate::stamp::{self, Key};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Blender's packaging script and its list of tags, from `site-packages`.
const SCRIPT: &str = "bpy/5.0/scripts/addons_core/bl_pkg/cli/blender_ext.py";
const TAGS: &str = "bpy/5.0/scripts/modules/_bpy_internal/extensions/tags.py";

/// Beginning and end of the platform tag of the wheels that this project ships, and Blender's names for them.
const PLATFORMS: [(&str, &str, &str); 5] = [
    ("manylinux_2_28_", "x86_64", "linux-x64"),
    ("manylinux_2_28_", "aarch64", "linux-arm64"),
    ("win_", "amd64", "windows-x64"),
    ("win_", "arm64", "windows-arm64"),
    ("macosx_", "_arm64", "macos-arm64"),
];

/// The template that is filled in rather than copied.
const MANIFEST: &str = "blender_manifest.toml";

/// Builds the zip for Linux unless it is up to date; returns its path.
///
/// # Errors
/// If staging, Blender's script or its validation fails.
pub fn build(places: &Places, wheel: &Path) -> Result<PathBuf> {
    let dist = places.target.join("dist");
    let zip = dist.join(format!(
        "thenar-{}-linux_x64.zip",
        env!("CARGO_PKG_VERSION")
    ));
    let key = Key::new("extension")
        .text(env!("CARGO_PKG_VERSION"))
        .text(BLENDER_50.packages[0])
        .files(&places.root.join("addon"))?
        .files(&places.root.join("LICENSE"))?
        .files(wheel)?
        .files(&places.root.join("rust/xtask/src/environment/manual.rs"))?
        .finish();
    let ready = dist.join(".ready");
    if zip.is_file() && stamp::is_current(&ready, &key) {
        return Ok(zip);
    }
    println!("building the extension");
    std::fs::create_dir_all(&dist).with_context(|| format!("cannot make {}", dist.display()))?;
    stamp::remove(&ready)?;
    let stage = stage(places, &[wheel.to_path_buf()])?;
    let output = format!("--output-filepath={}", zip.display());
    blender_ext(
        places,
        &[
            "build",
            &output,
            &source_argument(&stage),
            &tags_argument(places),
        ],
    )?;
    blender_ext(
        places,
        &["validate", &tags_argument(places), &zip.to_string_lossy()],
    )?;
    stamp::write(&ready, &key)?;
    Ok(zip)
}

/// Installs and enables the zip in `target/blender`, unless that is what stands there.
///
/// # Errors
/// If Blender refuses the zip or cannot enable the add-on.
pub fn install(places: &Places, zip: &Path) -> Result<()> {
    let folder = places.blender_resources();
    let key = Key::new("installed").files(zip)?.finish();
    let ready = folder.join(".ready");
    if stamp::is_current(&ready, &key) {
        return Ok(());
    }
    println!("installing the extension in target/blender");
    let partial = folder.with_extension("partial");
    clear(&partial)?;
    std::fs::create_dir_all(&partial)
        .with_context(|| format!("cannot make {}", partial.display()))?;
    let mut command = Command::new(places.python(BLENDER_50.name));
    command
        .arg(
            places
                .root
                .join("rust/xtask/src/environment/install_extension.py"),
        )
        .arg(zip)
        .env("BLENDER_USER_RESOURCES", &partial);
    process::quiet(&mut command, "installing the extension in Blender")?;
    stamp::write(&partial.join(".ready"), &key)?;
    clear(&folder)?;
    std::fs::rename(&partial, &folder).with_context(|| format!("cannot make {}", folder.display()))
}

fn clear(folder: &Path) -> Result<()> {
    if folder.exists() {
        std::fs::remove_dir_all(folder)
            .with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    Ok(())
}

/// `cargo xtask bundle WHEEL...`: one zip per platform from wheels that were built elsewhere.
///
/// # Errors
/// If no wheel is given, a wheel is for no known platform, or Blender's script refuses the result.
pub fn bundle_command(places: &Places, wheels: &[String]) -> Result<ExitCode> {
    ensure!(
        !wheels.is_empty(),
        "name the wheels to bundle: cargo xtask bundle WHEEL..."
    );
    crate::environment::python::make(places, &BLENDER_50)?;
    let wheels: Vec<PathBuf> = wheels.iter().map(PathBuf::from).collect();
    let stage = stage(places, &wheels)?;
    let dist = places.target.join("dist");
    std::fs::create_dir_all(&dist).with_context(|| format!("cannot make {}", dist.display()))?;
    // The zip of setup may be written over.
    stamp::remove(&dist.join(".ready"))?;
    let output = format!("--output-dir={}", dist.display());
    let tags = tags_argument(places);
    blender_ext(
        places,
        &[
            "build",
            "--split-platforms",
            &output,
            &source_argument(&stage),
            &tags,
        ],
    )?;
    println!("the zips are in {}", shown(&dist, &places.root));
    Ok(ExitCode::SUCCESS)
}

/// Copies the add-on, the license and the wheels, makes the manual, and writes the manifest that names them.
fn stage(places: &Places, wheels: &[PathBuf]) -> Result<PathBuf> {
    let stage = places.target.join("stage");
    clear(&stage)?;
    let addon = places.root.join("addon");
    for file in stamp::files_below(&addon)? {
        let name = file
            .strip_prefix(&addon)
            .context("a file outside of addon")?;
        if name != Path::new(MANIFEST) {
            copy(&file, &stage.join(name))?;
        }
    }
    copy(&places.root.join("LICENSE"), &stage.join("LICENSE"))?;
    manual::write(&addon.join("docs"), &stage.join("manual"))?;
    let mut names = Vec::new();
    for wheel in wheels {
        let name = wheel
            .file_name()
            .context("a wheel without a name")?
            .to_string_lossy()
            .into_owned();
        copy(wheel, &stage.join("wheels").join(&name))?;
        names.push(name);
    }
    let template = addon.join(MANIFEST);
    let text = std::fs::read_to_string(&template)
        .with_context(|| format!("cannot read {}", template.display()))?;
    let manifest = manifest(&text, &names)?;
    std::fs::write(stage.join(MANIFEST), manifest).context("cannot write the staged manifest")?;
    Ok(stage)
}

/// The manifest of a zip: the template with version, platforms and wheels written in.
fn manifest(template: &str, wheels: &[String]) -> Result<String> {
    let mut platforms = Vec::new();
    for wheel in wheels {
        let tag = wheel
            .trim_end_matches(".whl")
            .rsplit('-')
            .next()
            .unwrap_or_default();
        let platform = PLATFORMS
            .iter()
            .find(|(start, end, _)| tag.starts_with(start) && tag.ends_with(end));
        let (_, _, platform) = platform
            .with_context(|| format!("{wheel} is for no platform that Thenar ships for"))?;
        ensure!(
            wheel.contains("-cp311-abi3-"),
            "{wheel} is not a cp311-abi3 wheel, so Blender 5.1 would refuse it"
        );
        platforms.push(format!("\"{platform}\""));
    }
    let wheels: Vec<String> = wheels
        .iter()
        .map(|wheel| format!("\"./wheels/{wheel}\""))
        .collect();
    let written = [
        ("version", format!("\"{}\"", env!("CARGO_PKG_VERSION"))),
        ("platforms", format!("[{}]", platforms.join(", "))),
        ("wheels", format!("[{}]", wheels.join(", "))),
    ];
    let is_written = |line: &&str| {
        let name = line.split_once('=').map_or("", |(name, _)| name.trim());
        !written.iter().any(|(own, _)| *own == name)
    };
    let mut text: String = written
        .iter()
        .map(|(name, value)| format!("{name} = {value}\n"))
        .collect();
    text.extend(
        template
            .lines()
            .filter(is_written)
            .flat_map(|line| [line, "\n"]),
    );
    ensure!(
        template.contains("license = [\"SPDX:GPL-3.0-or-later\"]"),
        "addon/blender_manifest.toml must state the license SPDX:GPL-3.0-or-later; Blender's script does not check it"
    );
    Ok(text)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    if let Some(parent) = to.parent() {
        std::fs::create_dir_all(parent)
            .with_context(|| format!("cannot make {}", parent.display()))?;
    }
    std::fs::copy(from, to)
        .with_context(|| format!("cannot copy {} to {}", from.display(), to.display()))?;
    Ok(())
}

fn blender_ext(places: &Places, arguments: &[&str]) -> Result<()> {
    let mut command = Command::new(places.python(BLENDER_50.name));
    command.arg(in_packages(places, SCRIPT)).args(arguments);
    process::quiet(&mut command, &format!("blender_ext.py {}", arguments[0])).map(|_| ())
}

fn source_argument(stage: &Path) -> String {
    format!("--source-dir={}", stage.display())
}

fn tags_argument(places: &Places) -> String {
    format!("--valid-tags={}", in_packages(places, TAGS).display())
}

fn in_packages(places: &Places, name: &str) -> PathBuf {
    places
        .target
        .join(BLENDER_50.name)
        .join("lib/python3.11/site-packages")
        .join(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEMPLATE: &str = "schema_version = \"1.0.0\"\nid = \"thenar\"\nversion = \"0.0.0\"\nlicense = [\"SPDX:GPL-3.0-or-later\"]\nplatforms = []\nwheels = []\n";

    fn names(tags: &[&str]) -> Vec<String> {
        tags.iter()
            .map(|tag| format!("thenar-1.2.3-{tag}.whl"))
            .collect()
    }

    #[test]
    fn manifest_names_version_platforms_and_wheels() {
        let wheels = names(&[
            "cp311-abi3-manylinux_2_28_x86_64",
            "cp311-abi3-manylinux_2_28_aarch64",
            "cp311-abi3-win_amd64",
            "cp311-abi3-win_arm64",
            "cp311-abi3-macosx_11_0_arm64",
        ]);
        let text = manifest(TEMPLATE, &wheels).unwrap();
        assert!(text.contains(&format!("version = \"{}\"\n", env!("CARGO_PKG_VERSION"))));
        let platforms = "platforms = [\"linux-x64\", \"linux-arm64\", \"windows-x64\", \"windows-arm64\", \"macos-arm64\"]";
        assert!(text.contains(platforms), "{text}");
        assert!(text.contains("\"./wheels/thenar-1.2.3-cp311-abi3-win_amd64.whl\""));
        assert_eq!(
            text.matches("version = ").count(),
            2,
            "schema_version and version, once each: {text}"
        );
    }

    #[test]
    fn manifest_refuses_what_blender_would_let_pass() {
        let error =
            |template: &str, tag: &str| manifest(template, &names(&[tag])).unwrap_err().to_string();
        assert!(error(TEMPLATE, "cp311-abi3-linux_riscv64").contains("no platform"));
        assert!(error(TEMPLATE, "cp311-abi3-macosx_10_12_x86_64").contains("no platform"));
        assert!(error(TEMPLATE, "cp311-cp311-win_amd64").contains("not a cp311-abi3"));
        assert!(
            error(
                &TEMPLATE.replace("GPL-3.0-or-later", "MIT"),
                "cp311-abi3-win_amd64"
            )
            .contains("license")
        );
    }
}
