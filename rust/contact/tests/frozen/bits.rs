//! A hash over the bits of results (FNV-1a, 64 bits).

use thenar_contact::{Contact, Convergence, Course, RegionResult, Residual, Shear, Step};
use thenar_surface::Vec3;

const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// The hash of what was added so far.
pub struct Bits {
    state: u64,
}

impl Default for Bits {
    fn default() -> Bits {
        Bits { state: BASIS }
    }
}

impl Bits {
    pub fn hash(&self) -> u64 {
        self.state
    }

    pub fn whole(&mut self, value: u64) {
        for byte in value.to_le_bytes() {
            self.state = (self.state ^ u64::from(byte)).wrapping_mul(PRIME);
        }
    }

    pub fn count(&mut self, value: usize) {
        self.whole(value as u64);
    }

    /// The sign of what is no number is the compiler's choice, and does not count.
    pub fn number(&mut self, value: f64) {
        self.whole(if value.is_nan() {
            f64::NAN.to_bits() & (u64::MAX >> 1)
        } else {
            value.to_bits()
        });
    }

    pub fn numbers(&mut self, values: &[f64]) {
        self.count(values.len());
        values.iter().for_each(|value| self.number(*value));
    }

    pub fn vector(&mut self, vector: &Vec3) {
        vector.iter().for_each(|value| self.number(*value));
    }

    pub fn vectors(&mut self, vectors: &[Vec3]) {
        self.count(vectors.len());
        vectors.iter().for_each(|vector| self.vector(vector));
    }

    /// Everything in a contact but its wall times and its words; of these, how grave they are.
    pub fn contact(&mut self, contact: &Contact) {
        let grade = contact.grade() as u64;
        let Contact {
            displacement,
            nodal_force,
            pressure,
            gap,
            normal,
            total_force,
            total_moment,
            center_of_pressure,
            contact_area,
            peak_pressure,
            mean_pressure,
            patch_peak,
            regions,
            product_pressure,
            offset,
            direction,
            adhesion,
            shear,
            residual,
            convergence,
            warnings: _,
            seconds: _,
        } = contact;
        self.vectors(displacement);
        self.vectors(normal);
        for field in [nodal_force, pressure, gap, product_pressure, adhesion] {
            self.numbers(field);
        }
        for vector in [total_force, total_moment, center_of_pressure, direction] {
            self.vector(vector);
        }
        for number in [
            contact_area,
            peak_pressure,
            mean_pressure,
            patch_peak,
            offset,
        ] {
            self.number(*number);
        }
        regions.iter().for_each(|region| self.region(region));
        self.count(usize::from(shear.is_some()));
        shear.iter().for_each(|shear| self.shear(shear));
        self.end(residual, convergence);
        self.whole(grade);
    }

    pub fn course(&mut self, course: &Course) {
        course.steps.iter().for_each(|step| self.step(step));
        self.vector(&course.direction);
        self.number(course.touch_offset.unwrap_or(f64::NAN));
        self.contact(&course.last);
    }

    pub fn step(&mut self, step: &Step) {
        let Step {
            time_s,
            offset,
            force,
            total_force,
            shear,
            slip_loss,
            area,
            peak_pressure,
            region_force,
            work,
            pressure,
            loads,
            has_converged,
        } = step;
        for number in [time_s, offset, force, slip_loss, area, peak_pressure, work] {
            self.number(*number);
        }
        self.vector(total_force);
        self.vector(shear);
        self.numbers(region_force);
        for (vertex, pressure) in pressure {
            self.whole(u64::from(*vertex));
            self.number(*pressure);
        }
        for load in loads {
            self.vector(&load.position);
            self.number(load.force_n);
            self.number(load.area_mm2);
        }
        self.count(usize::from(*has_converged));
    }

    fn region(&mut self, region: &RegionResult) {
        let RegionResult {
            index,
            force,
            area,
            peak,
            mean,
            max_penetration,
            shear_modulus,
        } = region;
        self.count(*index);
        for number in [force, area, peak, mean, max_penetration, shear_modulus] {
            self.number(*number);
        }
    }

    fn shear(&mut self, shear: &Shear) {
        let Shear {
            force,
            traction,
            slip,
            margin,
            is_sticking,
            total,
            travel,
            turn,
            dissipated,
            stored,
            residual,
        } = shear;
        self.vectors(force);
        self.vectors(slip);
        self.numbers(traction);
        self.numbers(margin);
        is_sticking
            .iter()
            .for_each(|sticks| self.count(usize::from(*sticks)));
        for vector in [total, travel, turn] {
            self.vector(vector);
        }
        for number in [dissipated, stored, residual] {
            self.number(*number);
        }
    }

    fn end(&mut self, residual: &Residual, convergence: &Convergence) {
        let Residual {
            complementarity,
            penetration_mm,
            load_balance,
            far_field,
        } = residual;
        for number in [complementarity, penetration_mm, load_balance, far_field] {
            self.number(*number);
        }
        let Convergence {
            has_converged,
            passes,
            pivots,
            cg_steps,
        } = convergence;
        self.count(usize::from(*has_converged));
        for count in [passes, pivots, cg_steps] {
            self.count(*count);
        }
    }
}
