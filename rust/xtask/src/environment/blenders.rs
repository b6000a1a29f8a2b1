//! Every Blender module of PyPI that Thenar supports: its environment, and the whole life of the extension in it.

use crate::environment::python::{self, BLENDER_45, BLENDER_50, BLENDER_53, Environment};
use crate::places::Places;
use crate::{environment::wheel, setup};
use anyhow::{Result, ensure};

/// The oldest Blender that Thenar supports; files that it saves open in every later one.
pub const BLENDER_42: Environment = bare("venv42", "3.11", &["bpy==4.2.23", "numpy==1.26.4"]);

/// By version of Blender, oldest first. PyPI has those up to 5.0 for CPython 3.11, later ones for 3.13.
const MODULES: [(&str, Environment); 8] = [
    ("4.2", BLENDER_42),
    (
        "4.3",
        bare("venv43", "3.11", &["bpy==4.3.0", "numpy==1.26.4"]),
    ),
    (
        "4.4",
        bare("venv44", "3.11", &["bpy==4.4.0", "numpy==1.26.4"]),
    ),
    ("4.5", BLENDER_45),
    ("5.0", BLENDER_50),
    (
        "5.1",
        bare("venv51", "3.13", &["bpy==5.1.2", "numpy==2.3.5"]),
    ),
    (
        "5.2",
        bare("venv52", "3.13", &["bpy==5.2.3", "numpy==2.3.5"]),
    ),
    ("5.3", BLENDER_53),
];

/// Those whose environments hold the test tools and the wheel: the whole of `tests/blender` runs in them.
const TESTED_WHOLE: [&str; 3] = ["4.5", "5.0", "5.3"];

/// The word for every version.
const ALL: &str = "all";

const fn bare(
    name: &'static str,
    version: &'static str,
    packages: &'static [&'static str],
) -> Environment {
    Environment {
        name,
        version,
        packages,
    }
}

/// `cargo xtask samples` needs the oldest Blender with the wheel.
///
/// # Errors
/// If the set-up fails.
pub fn oldest(places: &Places) -> Result<&'static str> {
    setup::user_environment(places)?;
    let wheel = setup::wheel(places)?;
    python::make(places, &BLENDER_42)?;
    wheel::install(places, BLENDER_42.name, &wheel)?;
    Ok(BLENDER_42.name)
}

/// The versions that the words name, `all` or none for every one, oldest first.
///
/// # Errors
/// If a word names no version; the message lists those that there are.
pub fn chosen(words: &[String]) -> Result<Vec<&'static str>> {
    let asked: Vec<&str> = words.iter().flat_map(|word| word.split(',')).collect();
    for word in &asked {
        ensure!(
            *word == ALL || MODULES.iter().any(|(version, _)| version == word),
            "there is no Blender '{word}' among those that Thenar is tested in: {}, or {ALL}",
            MODULES.map(|(version, _)| version).join(", ")
        );
    }
    let is_chosen =
        |version: &str| asked.is_empty() || asked.contains(&ALL) || asked.contains(&version);
    Ok(MODULES
        .iter()
        .map(|(version, _)| *version)
        .filter(|version| is_chosen(version))
        .collect())
}

/// The versions of `cargo xtask blenders --tests`: those that the words name, the newest if none.
///
/// # Errors
/// If a word names no version, or one in which only the whole life of the extension is tested.
pub fn chosen_for_tests(words: &[String]) -> Result<Vec<&'static str>> {
    if words.is_empty() {
        return Ok(TESTED_WHOLE.last().copied().into_iter().collect());
    }
    let is_all = words.iter().any(|word| word == ALL);
    let (whole, lived): (Vec<_>, Vec<_>) = chosen(words)?
        .into_iter()
        .partition(|version| TESTED_WHOLE.contains(version));
    ensure!(
        is_all || lived.is_empty(),
        "the whole of tests/blender runs in Blender {}; in {} run `cargo xtask blenders {}`",
        TESTED_WHOLE.join(", "),
        lived.join(", "),
        lived.join(" ")
    );
    Ok(whole)
}

/// Environments, oldest first, of those of these versions in which the whole of `tests/blender` can run here; a version
/// whose CPython is missing is left out, as `make` says.
pub fn with_tests(versions: &[&str]) -> Vec<&'static str> {
    MODULES
        .iter()
        .filter(|(version, _)| versions.contains(version) && TESTED_WHOLE.contains(version))
        .filter(|(_, environment)| python::find(environment.version).is_ok())
        .map(|(_, environment)| environment.name)
        .collect()
}

/// Makes the environments of these versions. One whose CPython is missing is named and left out: its tests are then
/// skipped with that reason, but where the variable `CI` is set it is an error.
///
/// # Errors
/// If pip fails, the wheel does not build or, in CI, an interpreter is missing.
pub fn make(places: &Places, versions: &[&str]) -> Result<()> {
    let wheel = setup::wheel(places)?;
    let _alone = setup::lock(places)?;
    for (version, environment) in MODULES
        .iter()
        .filter(|(version, _)| versions.contains(version))
    {
        match python::find(environment.version) {
            Ok(_) => {
                python::make(places, environment)?;
                if TESTED_WHOLE.contains(version) {
                    wheel::install(places, environment.name, &wheel)?;
                }
            }
            Err(error) if std::env::var_os("CI").is_none() => {
                println!("Blender {version} is left out: {error}");
            }
            Err(error) => {
                return Err(error.context(format!("Blender {version} must not be left out in CI")));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_string).collect()
    }

    #[test]
    fn versions_are_chosen_by_name_and_unknown_ones_are_refused() {
        let all = chosen(&[]).unwrap();
        assert_eq!(all.len(), 8);
        assert_eq!(chosen(&words("all")).unwrap(), all);
        assert_eq!(chosen(&words("5.3,4.2")).unwrap(), ["4.2", "5.3"]);
        assert_eq!(chosen(&words("5.3 4.2")).unwrap(), ["4.2", "5.3"]);
        let error = chosen(&words("4.1")).unwrap_err().to_string();
        assert!(
            error.contains("'4.1'") && error.contains("4.2, 4.3"),
            "{error}"
        );
    }

    #[test]
    fn all_tests_run_in_the_newest_unless_others_of_them_are_named() {
        assert_eq!(chosen_for_tests(&[]).unwrap(), ["5.3"]);
        assert_eq!(chosen_for_tests(&words("5.3 4.5")).unwrap(), ["4.5", "5.3"]);
        assert_eq!(chosen_for_tests(&words("all")).unwrap(), TESTED_WHOLE);
        let error = chosen_for_tests(&words("5.3 4.2")).unwrap_err().to_string();
        assert!(error.contains("4.5, 5.0, 5.3; in 4.2 run"), "{error}");
        assert!(chosen_for_tests(&words("4.1")).is_err());
    }

    /// An environment without the test tools would fail every step that runs in it.
    #[test]
    fn environments_of_all_tests_hold_pytest_and_only_asked_ones_are_run() {
        for (version, environment) in MODULES {
            let holds = environment
                .packages
                .iter()
                .any(|package| package.starts_with("pytest=="));
            assert_eq!(holds, TESTED_WHOLE.contains(&version), "{version}");
        }
        assert!(with_tests(&["4.2", "5.1"]).is_empty());
        if python::find("3.11").is_ok() {
            assert_eq!(with_tests(&["4.2", "5.0", "4.5"]), ["venv45", "venv"]);
        }
    }

    #[test]
    fn every_environment_pins_the_blender_of_its_version() {
        for (version, environment) in MODULES {
            let start = format!("bpy=={version}.");
            assert!(environment.packages[0].starts_with(&start), "{version}");
        }
    }

    /// The tests find an environment by its folder below `target`.
    #[test]
    fn tests_know_the_same_versions_and_folders() {
        let products = include_str!("../../../../tests/packaging/products.py");
        for (version, environment) in MODULES {
            let entry = format!("\"{version}\": \"{}\"", environment.name);
            assert!(products.contains(&entry), "{entry}");
        }
    }
}
