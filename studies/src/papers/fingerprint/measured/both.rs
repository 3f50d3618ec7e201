//! Errors on the walks along corridors and on those in the plane.

use foxhunt_host::walks::Walk;

use crate::papers::fingerprint::errors::Errors;

/// The errors on the straight walks and on those in the plane.
#[derive(Default)]
pub struct Both {
    pub straight: Errors,
    pub plane: Errors,
}

impl Both {
    pub fn push(&mut self, walk: &Walk, errors: Vec<f64>) {
        let both = if walk.is_straight {
            &mut self.straight
        } else {
            &mut self.plane
        };
        both.push(errors);
    }
}
