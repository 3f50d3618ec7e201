//! The README and the guide, so that their examples run with the others. Compiled for documentation tests only.

/// Runs the examples of a page.
macro_rules! pages {
    ($($name:ident: $file:literal),+ $(,)?) => {$(
        #[doc = include_str!($file)]
        struct $name;
    )+};
}

pages! {
    Readme: "../README.md",
    Contributing: "../CONTRIBUTING.md",
    Introduction: "../docs/src/introduction.md",
    FirstFix: "../docs/src/first-fix.md",
    YourModel: "../docs/src/your-model.md",
    YourBoard: "../docs/src/your-board.md",
    ChoosingN: "../docs/src/choosing-n.md",
    WhichLocator: "../docs/src/which-locator.md",
    Uncertainty: "../docs/src/uncertainty.md",
    Numerics: "../docs/src/numerics.md",
    Papers: "../docs/src/papers.md",
    Tunnel: "../docs/src/tunnel.md",
    Gateway: "../docs/src/gateway.md",
    Snapshots: "../docs/src/snapshots.md",
}
