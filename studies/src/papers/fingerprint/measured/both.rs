//! Errors on the walks along corridors and on those in the plane.

use foxhunt_host::walks::Walk;

use crate::papers::fingerprint::errors::Errors;

/// The errors on the straight walks and on those in the plane.
#[derive(Default)]
pub struct Both {
    pub straight: Errors,
    pub plane: Errors,
    /// The same of the steps from the tenth second on.
    pub late: [Errors; 2],
}

/// Steps of two seconds before the tenth.
const EARLY: usize = 4;

impl Both {
    pub fn push(&mut self, walk: &Walk, errors: Vec<f64>) {
        let [straight, plane] = &mut self.late;
        let (all, late) = if walk.is_straight {
            (&mut self.straight, straight)
        } else {
            (&mut self.plane, plane)
        };
        late.push(errors.iter().skip(EARLY).copied().collect());
        all.push(errors);
    }
}
