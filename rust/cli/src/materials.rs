//! Materials by region from a TOML file: one table per region number, region name, or `default`.

use crate::fault::Fault;
use crate::regions::RegionTable;
use std::ops::Range;
use std::path::Path;
use thenar_contact::parameters::PARAMETERS;
use thenar_contact::{Material, Model};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The preset of the model for every region.
pub fn presets(model: Model, regions: &RegionTable) -> Vec<Material> {
    vec![model.preset(); regions.count()]
}

/// Reads one material per region. Numbers that a table leaves out take the parameter table's defaults.
///
/// # Errors
/// Names file, line and remedy: unknown tables and keys, numbers that no tissue has, regions without a material.
pub fn read(file: &Path, model: Model, regions: &RegionTable) -> Result<Vec<Material>, Fault> {
    let text = crate::table::text(file)?;
    let source = Source { file, text: &text };
    let document = DeTable::parse(&text)
        .map_err(|error| source.fault(error.span().unwrap_or(0..0), error.message().trim()))?;
    let mut found = vec![None; regions.count()];
    let mut default = None;
    for (key, value) in document.get_ref() {
        let name: &str = key.get_ref();
        let DeValue::Table(table) = value.get_ref() else {
            let problem = format!(
                "{name} stands outside a table; put it under [default] or the name of a region"
            );
            return Err(source.fault(key.span(), &problem));
        };
        let place = match regions.find(name) {
            Some(region) => &mut found[region],
            None if name == "default" => &mut default,
            None => {
                return Err(source.fault(
                    key.span(),
                    &format!("there is no region {name:?}; use {}", known(regions)),
                ));
            }
        };
        *place = Some(material(table, key, &source)?);
    }
    let is_used = |region: usize| regions.regions.contains(&(region as i32));
    let missing = (0..found.len()).find(|region| found[*region].is_none() && is_used(*region));
    if let (Some(region), None) = (missing, default) {
        let name = regions.name(region);
        let file = file.display();
        return Err(Fault::Input(format!(
            "{file}: region {name} has no material; add a table [{name}] or [default]"
        )));
    }
    Ok(found
        .into_iter()
        .map(|material| material.or(default).unwrap_or_else(|| model.preset()))
        .collect())
}

fn known(regions: &RegionTable) -> String {
    let names: Vec<String> = (0..regions.count())
        .map(|region| regions.name(region))
        .collect();
    let shown = if names.len() > 24 {
        format!("0 to {}", names.len() - 1)
    } else {
        names.join(", ")
    };
    format!("{shown} or default")
}

/// A file for messages.
pub struct Source<'a> {
    pub file: &'a Path,
    pub text: &'a str,
}

impl Source<'_> {
    /// The sentence for a problem at a place of the file.
    pub fn fault(&self, span: Range<usize>, problem: &str) -> Fault {
        let before = self.text.as_bytes().get(..span.start).unwrap_or_default();
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        let problem = problem.replace('\n', " ");
        Fault::Input(format!("{}, line {line}: {problem}", self.file.display()))
    }
}

fn material<K: AsRef<str>>(
    table: &DeTable<'_>,
    name: &Spanned<K>,
    source: &Source<'_>,
) -> Result<Material, Fault> {
    let mut material = Material::default();
    for (key, value) in table {
        let fault = |problem: String| source.fault(key.span(), &problem);
        let key: &str = key.get_ref();
        if key == "swelling" {
            let parts: Option<Vec<f64>> = value
                .get_ref()
                .as_array()
                .and_then(|array| array.iter().map(number).collect());
            let Some([height, radius, width]) = parts
                .as_deref()
                .and_then(|parts| <[f64; 3]>::try_from(parts).ok())
            else {
                return Err(fault(
                    "swelling must be three numbers: height mm/N, radius mm, width mm".into(),
                ));
            };
            set(&mut material, "swelling_height_mm_per_n", height);
            set(&mut material, "swelling_radius_mm", radius);
            set(&mut material, "swelling_width_mm", width);
            continue;
        }
        if !PARAMETERS.iter().any(|parameter| parameter.name == key) {
            let names: Vec<&str> = PARAMETERS.iter().map(|parameter| parameter.name).collect();
            return Err(fault(format!(
                "there is no material number {key:?}; there are {} and swelling",
                names.join(", ")
            )));
        }
        let number = number(value).ok_or_else(|| fault(format!("{key} must be a number")))?;
        set(&mut material, key, number);
        let mut alone = Material::default();
        set(&mut alone, key, number);
        alone
            .validate(name.get_ref().as_ref())
            .map_err(|error| fault(error.to_string()))?;
    }
    material
        .validate(name.get_ref().as_ref())
        .map_err(|error| source.fault(name.span(), &error.to_string()))?;
    Ok(material)
}

/// A TOML number, or the text "inf".
pub fn number(value: &Spanned<DeValue<'_>>) -> Option<f64> {
    match value.get_ref() {
        DeValue::Integer(number) if number.radix() == 10 => {
            number.as_str().replace('_', "").parse().ok()
        }
        DeValue::Float(number) => number.as_str().replace('_', "").parse().ok(),
        DeValue::String(text) if text == "inf" => Some(f64::INFINITY),
        _ => None,
    }
}

fn set(material: &mut Material, name: &str, value: f64) {
    let place = match name {
        "g0_mpa" => &mut material.g0_mpa,
        "g_lim_mpa" => &mut material.g_lim_mpa,
        "d_lim_mm" => &mut material.d_lim_mm,
        "thickness_mm" => &mut material.thickness_mm,
        "poisson_ratio" => &mut material.poisson_ratio,
        "stiffening" => &mut material.stiffening,
        "bone_half_width_mm" => &mut material.bone_half_width_mm,
        "bone_half_length_mm" => &mut material.bone_half_length_mm,
        "zone_mm" => &mut material.zone_mm,
        "swelling_height_mm_per_n" => &mut material.swelling.height_mm_per_n,
        "swelling_radius_mm" => &mut material.swelling.radius_mm,
        "swelling_width_mm" => &mut material.swelling.width_mm,
        _ => return,
    };
    *place = value;
}
