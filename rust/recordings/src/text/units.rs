//! Units as makers write them, and the factors to mm, N, s and kPa.

/// The unit that numbers of one quantity leave this crate in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    Time,
    Length,
    Force,
    Pressure,
    Area,
    Stiffness,
}

impl Quantity {
    /// Unit inside the library, as a person reads it.
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::Time => "s",
            Quantity::Length => "mm",
            Quantity::Force => "N",
            Quantity::Pressure => "kPa",
            Quantity::Area => "mm2",
            Quantity::Stiffness => "N/mm",
        }
    }

    /// The same as the end of a name.
    pub fn suffix(self) -> &'static str {
        match self {
            Quantity::Time => "s",
            Quantity::Length => "mm",
            Quantity::Force => "n",
            Quantity::Pressure => "kpa",
            Quantity::Area => "mm2",
            Quantity::Stiffness => "n_per_mm",
        }
    }
}

/// A unit: what it measures, and how many of the library's units it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unit {
    pub quantity: Quantity,
    pub factor: f64,
}

/// One standard gravity, m/s2; kilogram-force and its kin.
const GRAVITY: f64 = 9.80665;

/// Name in lower case, quantity, factor.
const UNITS: &[(&str, Quantity, f64)] = &[
    ("s", Quantity::Time, 1.0),
    ("sec", Quantity::Time, 1.0),
    ("secs", Quantity::Time, 1.0),
    ("second", Quantity::Time, 1.0),
    ("seconds", Quantity::Time, 1.0),
    ("ms", Quantity::Time, 1e-3),
    ("us", Quantity::Time, 1e-6),
    ("min", Quantity::Time, 60.0),
    ("mm", Quantity::Length, 1.0),
    ("millimeters", Quantity::Length, 1.0),
    ("cm", Quantity::Length, 10.0),
    ("centimeters", Quantity::Length, 10.0),
    ("m", Quantity::Length, 1e3),
    ("meters", Quantity::Length, 1e3),
    ("um", Quantity::Length, 1e-3),
    ("nm", Quantity::Length, 1e-6),
    ("in", Quantity::Length, 25.4),
    ("inches", Quantity::Length, 25.4),
    ("n", Quantity::Force, 1.0),
    ("kn", Quantity::Force, 1e3),
    ("mn", Quantity::Force, 1e-3),
    ("un", Quantity::Force, 1e-6),
    ("nn", Quantity::Force, 1e-9),
    ("pn", Quantity::Force, 1e-12),
    ("kgf", Quantity::Force, GRAVITY),
    ("kg", Quantity::Force, GRAVITY),
    ("kgs", Quantity::Force, GRAVITY),
    ("gf", Quantity::Force, GRAVITY * 1e-3),
    ("lbf", Quantity::Force, 4.448_221_615_260_5),
    ("lb", Quantity::Force, 4.448_221_615_260_5),
    ("lbs", Quantity::Force, 4.448_221_615_260_5),
    ("pa", Quantity::Pressure, 1e-3),
    ("kpa", Quantity::Pressure, 1.0),
    ("mpa", Quantity::Pressure, 1e3),
    ("gpa", Quantity::Pressure, 1e6),
    ("bar", Quantity::Pressure, 100.0),
    ("mbar", Quantity::Pressure, 0.1),
    ("psi", Quantity::Pressure, 6.894_757_293_168),
    // Conventional millimetre of mercury: 133.322387415 Pa (NIST SP 811, B.8).
    ("mmhg", Quantity::Pressure, 0.133_322_387_415),
    ("n/mm2", Quantity::Pressure, 1e3),
    ("n/cm2", Quantity::Pressure, 10.0),
    ("n/m2", Quantity::Pressure, 1e-3),
    ("kg/cm2", Quantity::Pressure, GRAVITY * 10.0),
    ("kgf/cm2", Quantity::Pressure, GRAVITY * 10.0),
    ("g/cm2", Quantity::Pressure, GRAVITY * 1e-2),
    ("mm2", Quantity::Area, 1.0),
    ("cm2", Quantity::Area, 100.0),
    ("m2", Quantity::Area, 1e6),
    ("um2", Quantity::Area, 1e-6),
    ("in2", Quantity::Area, 645.16),
    ("n/mm", Quantity::Stiffness, 1.0),
    ("n/m", Quantity::Stiffness, 1e-3),
    ("n_per_m", Quantity::Stiffness, 1e-3),
    ("n_per_mm", Quantity::Stiffness, 1.0),
];

/// What a unit is, in any case of letters (no unit here changes its meaning with it); `None` if it is not known.
pub(crate) fn unit(text: &str) -> Option<Unit> {
    let text = text.trim();
    if text == "Nm" {
        return None;
    }
    let name: String = text
        .chars()
        .map(|c| match c {
            '²' => '2',
            'µ' | 'μ' => 'u',
            c => c.to_ascii_lowercase(),
        })
        .filter(|c| *c != '^')
        .collect();
    let (_, quantity, factor) = UNITS.iter().find(|(known, ..)| *known == name)?;
    Some(Unit {
        quantity: *quantity,
        factor: *factor,
    })
}

/// `5.08 mm`, `0.127 centimeters`: a number of one quantity, in the library's unit. Or what is wrong with it.
pub(crate) fn measure(text: &str, quantity: Quantity) -> Result<f64, String> {
    let mut words = text.split_whitespace();
    let value = crate::text::fields::value(words.next().unwrap_or(""))?;
    let name = words.next().unwrap_or("");
    match unit(name) {
        Some(unit) if unit.quantity == quantity => Ok(value * unit.factor),
        _ => Err(format!(
            "{} is not a unit of what stands in {} here",
            crate::fault::shown(name.as_bytes()),
            quantity.unit()
        )),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn units_agree_with_their_definitions() {
        for (text, quantity, factor) in [
            ("mmHg", Quantity::Pressure, 0.133_322_387_415),
            ("KPa", Quantity::Pressure, 1.0),
            ("µN", Quantity::Force, 1e-6),
            ("cm²", Quantity::Area, 100.0),
            ("in", Quantity::Length, 25.4),
        ] {
            let unit = unit(text).unwrap();
            assert_eq!((unit.quantity, unit.factor), (quantity, factor), "{text}");
        }
        assert_eq!(unit("Nm"), None);
        assert_eq!(unit("furlong"), None);
        // A pound per square inch, from the pound-force and the inch.
        let psi = 4.448_221_615_260_5 / 645.16 * 1e3;
        assert!((unit("PSI").unwrap().factor / psi - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_measure_needs_a_unit_of_its_kind() {
        assert_eq!(measure("0,5 centimeters", Quantity::Length), Ok(5.0));
        assert_eq!(measure("25.8064 mm2", Quantity::Area), Ok(25.8064));
        assert!(measure("5.08 s", Quantity::Length).is_err());
        assert!(measure("5.08", Quantity::Length).is_err());
    }
}
