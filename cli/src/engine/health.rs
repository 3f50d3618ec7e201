//! What became of what came in.

use std::collections::BTreeMap;

use super::search::Engine;

/// What an input has said.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Heard {
    /// Lines and messages.
    pub lines: u64,
    /// Those that were used.
    pub used: u64,
    /// Those that were not, by the reason.
    pub refused: BTreeMap<String, u64>,
}

impl Engine {
    /// What the inputs have said, in their order.
    pub fn heard(&self) -> Vec<Heard> {
        let inputs = self.inputs.iter().enumerate();
        inputs.map(|(index, _)| self.heard_by(index)).collect()
    }

    fn heard_by(&self, index: usize) -> Heard {
        let input = &self.inputs[index];
        let mut heard = Heard::default();
        if let Some(site) = input.site.and_then(|site| self.sites.get(site)) {
            return Heard {
                lines: site.lines,
                used: site.used,
                refused: site.refused.clone(),
            };
        }
        let ports = self.ports.iter().enumerate();
        for (port, _) in ports.filter(|(_, port)| port.input == index) {
            let Some(counters) = self.hunt.port_counters(port) else {
                continue;
            };
            heard.lines += u64::from(counters.lines);
            heard.used += u64::from(counters.sentences) + u64::from(counters.bearings);
        }
        heard.used += input.reports;
        heard.lines += input.refused_messages;
        heard.refused.clone_from(&input.refused);
        heard
    }
}
