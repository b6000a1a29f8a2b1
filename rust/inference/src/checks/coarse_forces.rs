//! Forces that are read in steps which are larger than their noise: what cannot be seen in them.

use crate::forward::surrogate::force_recording::ForceRecording;
use crate::number_format::number;

/// How coarse forces are read, and what is not judged for it; None where no recording is coarse.
pub fn coarse_forces_note(courses: &[ForceRecording]) -> Option<String> {
    let coarse = || courses.iter().filter(|course| course.is_coarse);
    let steps = coarse().flat_map(|course| &course.rows);
    let most = steps.map(|row| row.force_step_n).fold(0.0, f64::max);
    let (count, step, all) = (coarse().count(), number(1000.0 * most), courses.len());
    (count > 0).then(|| {
        format!(
            "the force of {count} of {all} recordings is read in steps of up to {step} mN, which are larger than its noise: what is smaller than half \
             a step is not seen, and rhythms and noise under load are not judged. Use a finer range of the load cell to have smaller effects seen"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forward::surrogate::synthetic::{ready, tool};
    use crate::observe::measured::Phase;

    #[test]
    fn coarse_recordings_are_counted_with_their_widest_step() {
        let read = |k: u32| {
            let depth = 0.1 * f64::from(k);
            (depth, depth, Phase::Load, depth)
        };
        let all: Vec<_> = (0..3).map(|_| (0, (0..9).map(read).collect())).collect();
        let (mut made, _) = ready(vec![tool(1.0, |d| d, |_| 1.0)], &all, 0.1);
        // Steps that noise hides.
        made.courses[0].rows[0].force_step_n = 0.5;
        assert_eq!(coarse_forces_note(&made.courses), None);
        for (course, step_n) in made.courses[1..].iter_mut().zip([0.01, 0.02]) {
            course.is_coarse = true;
            course.rows[3].force_step_n = step_n;
        }
        let said = coarse_forces_note(&made.courses).unwrap();
        assert!(
            said.starts_with("the force of 2 of 3 recordings is read in steps of up to 20 mN"),
            "{said}"
        );
    }
}
