//! How large a hand is: percentiles of published surveys, or measurements of one's own.

use crate::error::HandError;

/// Which population the percentile is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sex {
    /// Adult men.
    Male,
    /// Adult women.
    Female,
}

/// Which hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The right hand; +X points to the thumb.
    Right,
    /// The exact mirror image of the right hand in the plane x = 0.
    Left,
}

/// Mean and standard deviation of one measurement, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Mean, mm.
    pub mean_mm: f64,
    /// Standard deviation, mm.
    pub sd_mm: f64,
}

impl Survey {
    /// The value at a percentile (0..100) of a normal distribution, mm.
    pub fn at(&self, percentile: f64) -> f64 {
        self.mean_mm + self.sd_mm * normal_quantile(percentile / 100.0)
    }
}

/// Hand length, wrist crease to middle fingertip, British adults 19 to 65 (Pheasant & Haslegrave 2006, Bodyspace, hand table).
pub fn hand_length(sex: Sex) -> Survey {
    match sex {
        Sex::Male => Survey {
            mean_mm: 189.0,
            sd_mm: 10.0,
        },
        Sex::Female => Survey {
            mean_mm: 174.0,
            sd_mm: 9.0,
        },
    }
}

/// Hand breadth across the metacarpal heads without the thumb (same table as [`hand_length`]).
/// City University of Hong Kong's reprint of the British figures, rounded to 5 mm, has 85 and 75 mm with deviations of 5 and 4.
pub fn hand_breadth(sex: Sex) -> Survey {
    match sex {
        Sex::Male => Survey {
            mean_mm: 87.0,
            sd_mm: 5.0,
        },
        Sex::Female => Survey {
            mean_mm: 76.0,
            sd_mm: 4.0,
        },
    }
}

/// What to build: a person's percentile, or that person's own length and breadth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandShape {
    /// Wrist crease to middle fingertip, fingers straight, mm; `None` takes it from `sex` and `percentile`.
    pub length_mm: Option<f64>,
    /// Breadth across the metacarpal heads without the thumb, mm; `None` as above.
    pub breadth_mm: Option<f64>,
    /// Right or left.
    pub side: Side,
    /// Population of the percentile.
    pub sex: Sex,
    /// Percentile of length and breadth, 1 to 99.
    pub percentile: f64,
    /// Edge length aimed at on the palmar skin, mm, 1 to 6. Nails are meshed at half of it.
    pub spacing_mm: f64,
}

impl Default for HandShape {
    /// The right hand of a man of median size at 2.5 mm, the vertex spacing of Xie et al.
    fn default() -> Self {
        HandShape {
            length_mm: None,
            breadth_mm: None,
            side: Side::Right,
            sex: Sex::Male,
            percentile: 50.0,
            spacing_mm: 2.5,
        }
    }
}

impl HandShape {
    /// Length and breadth this shape stands for, mm.
    ///
    /// # Errors
    /// [`HandError::OutOfRange`] for a measurement no hand has.
    pub fn length_and_breadth(&self) -> Result<(f64, f64), HandError> {
        check("percentile", "", self.percentile, (1.0, 99.0))?;
        check("vertex spacing", "mm", self.spacing_mm, (1.0, 6.0))?;
        let length = self
            .length_mm
            .unwrap_or_else(|| hand_length(self.sex).at(self.percentile));
        let breadth = self
            .breadth_mm
            .unwrap_or_else(|| hand_breadth(self.sex).at(self.percentile));
        check("hand length", "mm", length, (120.0, 240.0))?;
        check(
            "hand breadth",
            "mm",
            breadth,
            (0.38 * length, 0.54 * length),
        )?;
        Ok((length, breadth))
    }
}

fn check(
    what: &'static str,
    unit: &'static str,
    found: f64,
    (low, high): (f64, f64),
) -> Result<(), HandError> {
    if (low..=high).contains(&found) {
        Ok(())
    } else {
        Err(HandError::OutOfRange {
            what,
            unit,
            found,
            low,
            high,
        })
    }
}

/// Inverse of the standard normal distribution by bisection on the series of its integral (Abramowitz & Stegun 26.2.11).
fn normal_quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (-6.0_f64, 6.0_f64);
    for _ in 0..60 {
        let z = 0.5 * (low + high);
        if normal_integral(z) < probability {
            low = z
        } else {
            high = z
        }
    }
    0.5 * (low + high)
}

fn normal_integral(z: f64) -> f64 {
    let (mut term, mut sum, mut odd) = (z, z, 1.0);
    while term.abs() > 1e-17 {
        odd += 2.0;
        term *= z * z / odd;
        sum += term;
    }
    0.5 + sum * (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_follow_the_normal_distribution() {
        // 1.6449 standard deviations leave 5 % on one side.
        let survey = Survey {
            mean_mm: 100.0,
            sd_mm: 10.0,
        };
        assert!((survey.at(50.0) - 100.0).abs() < 1e-9);
        assert!((survey.at(95.0) - 116.4485).abs() < 1e-3);
        assert!((survey.at(5.0) + survey.at(95.0) - 200.0).abs() < 1e-9);
    }

    #[test]
    fn impossible_measurements_are_refused() {
        let shape = HandShape {
            length_mm: Some(f64::NAN),
            ..HandShape::default()
        };
        assert!(matches!(
            shape.length_and_breadth(),
            Err(HandError::OutOfRange {
                what: "hand length",
                ..
            })
        ));
        let shape = HandShape {
            spacing_mm: 0.2,
            ..HandShape::default()
        };
        assert!(matches!(
            shape.length_and_breadth(),
            Err(HandError::OutOfRange {
                what: "vertex spacing",
                ..
            })
        ));
    }
}
