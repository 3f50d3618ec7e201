//! The cost of any method: the calls that it makes of the model.

use std::cell::Cell;

use foxhunt::{
    kalman::Covariance,
    model::{Dynamics, Likelihood},
    proposal::{Sensor, Transition},
    random::Rng,
};

/// Counts calls.
#[derive(Default)]
pub struct Counter(Cell<u64>);

impl Counter {
    /// The same model, counted.
    pub fn of<M>(&self, model: M) -> Counted<'_, M> {
        Counted {
            model,
            counter: self,
        }
    }

    pub fn add(&self, calls: usize) {
        self.0.set(self.0.get() + calls as u64);
    }

    pub fn calls(&self) -> u64 {
        self.0.get()
    }
}

/// A model whose calls are counted: each density, likelihood, mean or draw of one state is one.
#[derive(Clone, Copy)]
pub struct Counted<'a, M> {
    model: M,
    counter: &'a Counter,
}

impl<const D: usize, M: Likelihood<D>> Likelihood<D> for Counted<'_, M> {
    fn log_likelihood(&self, state: &[f32; D]) -> f32 {
        self.counter.add(1);
        self.model.log_likelihood(state)
    }

    fn log_likelihoods(&self, columns: &[&[f32]; D], out: &mut [f32]) {
        self.counter.add(out.len());
        self.model.log_likelihoods(columns, out);
    }
}

impl<const D: usize, M: Dynamics<D>> Dynamics<D> for Counted<'_, M> {
    fn step<R: Rng + ?Sized>(&self, state: [f32; D], dt: f32, rng: &mut R) -> [f32; D] {
        self.counter.add(1);
        self.model.step(state, dt, rng)
    }
}

impl<const D: usize, M: Transition<D>> Transition<D> for Counted<'_, M> {
    fn mean(&self, from: &[f32; D], dt: f32) -> [f32; D] {
        self.counter.add(1);
        self.model.mean(from, dt)
    }

    fn noise(&self, dt: f32) -> Covariance<D> {
        self.model.noise(dt)
    }

    fn log_transition(&self, from: &[f32; D], to: &[f32; D], dt: f32) -> f32 {
        self.counter.add(1);
        self.model.log_transition(from, to, dt)
    }
}

impl<const D: usize, const M: usize, S: Sensor<D, M>> Sensor<D, M> for Counted<'_, S> {
    fn residual(&self, state: &[f32; D]) -> [f32; M] {
        self.counter.add(1);
        self.model.residual(state)
    }

    fn noise(&self) -> Covariance<M> {
        self.model.noise()
    }
}
