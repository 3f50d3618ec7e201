//! The two forms of a refinement.

/// Whether particles gather at the modes of the target or stay a sample of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Acceptance {
    /// As published: fish and fireflies go where their rules send them, evolution keeps the better of two. The
    /// cloud shrinks towards the modes; means profit from it at times, credible regions never.
    #[default]
    Greedy,
    /// As Metropolis-Hastings proposals, with the probability of the way back where it is another than that of
    /// the way there: the target stays invariant, whatever the number of particles and iterations.
    Metropolis,
}
