use super::super::Study;
use crate::figures::Figure;
pub fn run(_: &Study) -> anyhow::Result<Vec<Figure>> {
    Ok(vec![])
}
