//! A protocol: offset, depth or force of the product against time.

use thenar_surface::Vec3;

use crate::ContactError;

/// What a row of a protocol asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Demand {
    /// The product is moved this far along the direction from where it was given, mm.
    Offset(f64),
    /// The product is moved this far beyond first touch along the direction, mm; negative stays away.
    Depth(f64),
    /// The product is moved along the direction until this force is reached, N; 0 takes it off the skin.
    Force(f64),
}

/// One moment of a protocol.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Time, s; grows from row to row.
    pub time_s: f64,
    /// What is asked for.
    pub demand: Demand,
    /// Motion of the product besides, such as along the skin, mm.
    pub slide: Vec3,
}

/// A protocol.
#[derive(Debug, Clone, PartialEq)]
pub struct Protocol {
    /// Moments in their order.
    pub rows: Vec<Row>,
    /// Where the product moves to press, towards the skin; unit length not needed. None: mean normal of the contact.
    pub direction: Option<Vec3>,
}

impl Protocol {
    /// Depths against time (mm beyond first touch, s).
    pub fn of_depth(times_s: &[f64], depths_mm: &[f64]) -> Protocol {
        let row = |(time, depth): (&f64, &f64)| Row {
            time_s: *time,
            demand: Demand::Depth(*depth),
            slide: Vec3::zeros(),
        };
        Protocol {
            rows: times_s.iter().zip(depths_mm).map(row).collect(),
            direction: None,
        }
    }

    /// Checks every row.
    ///
    /// # Errors
    /// [`ContactError::Protocol`] naming the row, what is wrong and what is admissible.
    pub fn validate(&self) -> Result<(), ContactError> {
        if self.rows.is_empty() {
            return Err(ContactError::EmptyProtocol);
        }
        let mut last = None;
        for (row, moment) in self.rows.iter().enumerate() {
            moment.check((row, last))?;
            last = Some(moment.time_s);
        }
        Ok(())
    }
}

impl Row {
    /// Checks this row, number `row` of its protocol, that follows one at the time `last` (s).
    ///
    /// # Errors
    /// [`ContactError::Protocol`] naming the row, what is wrong and what is admissible.
    pub fn check(&self, (row, last): (usize, Option<f64>)) -> Result<(), ContactError> {
        let refuse = |problem: String| Err(ContactError::Protocol { row, problem });
        if !(self.time_s.is_finite() && last.is_none_or(|last| self.time_s > last)) {
            return refuse(format!(
                "time_s is {}, but must be finite and larger than in the row before",
                self.time_s
            ));
        }
        let (name, value) = match self.demand {
            Demand::Offset(value) => ("offset_mm", value),
            Demand::Depth(value) => ("depth_mm", value),
            Demand::Force(value) if value < 0.0 => {
                return refuse(format!("force_n is {value}, but must be 0 or more"));
            }
            Demand::Force(value) => ("force_n", value),
        };
        if !value.is_finite() {
            return refuse(format!("{name} is {value}, but must be finite"));
        }
        if !self.slide.iter().all(|c| c.is_finite()) {
            return refuse("its slide is not finite".to_owned());
        }
        Ok(())
    }
}
