//! Effects from a TOML file: one table `[[effect]]` each, with name, amplitude, regions, and its numbers and choices by name.

use crate::fault::Fault;
use crate::materials::{Source, number};
use crate::regions::RegionTable;
use std::path::Path;
use thenar_contact::{ActiveEffect, ContactError};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Reads the effects of a file.
///
/// # Errors
/// Names file, line and remedy: unknown effects, numbers, options and regions. Ranges are checked when a skin takes them.
pub fn read(file: &Path, regions: &RegionTable) -> Result<Vec<ActiveEffect>, Fault> {
    let text = crate::table::text(file)?;
    let source = Source { file, text: &text };
    let document = DeTable::parse(&text)
        .map_err(|error| source.fault(error.span().unwrap_or(0..0), error.message().trim()))?;
    let mut effects = Vec::new();
    for (key, value) in document.get_ref() {
        let tables = value.get_ref().as_array();
        let Some(tables) = tables.filter(|_| key.get_ref() == "effect") else {
            let problem = "each effect stands in a table of its own under [[effect]]";
            return Err(source.fault(key.span(), problem));
        };
        for table in tables.iter() {
            let DeValue::Table(entries) = table.get_ref() else {
                return Err(source.fault(table.span(), "an effect must be a table"));
            };
            effects.push(effect(entries, table, (&source, regions))?);
        }
    }
    Ok(effects)
}

fn effect(
    entries: &DeTable<'_>,
    table: &Spanned<DeValue<'_>>,
    (source, regions): (&Source<'_>, &RegionTable),
) -> Result<ActiveEffect, Fault> {
    let text = |key: &str| entries.get(key).and_then(|value| value.get_ref().as_str());
    let Some(name) = text("name") else {
        return Err(source.fault(
            table.span(),
            "an effect needs a name, such as name = \"bone\"",
        ));
    };
    let amplitude = entries.get("amplitude").map_or(Some(1.0), number);
    let Some(amplitude) = amplitude else {
        return Err(source.fault(table.span(), "amplitude must be a number"));
    };
    let fault = |error: ContactError| source.fault(table.span(), &error.to_string());
    let mut effect = ActiveEffect::named(name, amplitude).map_err(fault)?;
    for (key, value) in entries {
        let (name, span): (&str, _) = (key.get_ref(), key.span());
        let refused = |error: ContactError| source.fault(span.clone(), &error.to_string());
        effect = match (name, value.get_ref()) {
            ("name" | "amplitude", _) => effect,
            ("regions", DeValue::Array(named)) => {
                let known = named.iter().map(|region| region_of(region, regions));
                let Some(numbers) = known.collect::<Option<Vec<u32>>>() else {
                    let problem =
                        "regions must be a list of names or numbers of regions that there are";
                    return Err(source.fault(span, problem));
                };
                effect.in_regions(&numbers)
            }
            (_, DeValue::String(option)) if option != "inf" => {
                effect.choose(name, option).map_err(refused)?
            }
            _ => {
                let Some(value) = number(value) else {
                    return Err(source.fault(span, &format!("{name} must be a number")));
                };
                effect.with(name, value).map_err(refused)?
            }
        };
    }
    Ok(effect)
}

fn region_of(value: &Spanned<DeValue<'_>>, regions: &RegionTable) -> Option<u32> {
    let key = match value.get_ref() {
        DeValue::String(name) => name.to_string(),
        DeValue::Integer(number) => number.as_str().to_owned(),
        _ => return None,
    };
    regions
        .find(&key)
        .and_then(|region| u32::try_from(region).ok())
}
