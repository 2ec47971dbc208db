//! Memory turn limit: discourages turns away from the mean recent heading.

use super::{BehaviourLogic, BehaviourOutput};
use crate::ivp::{Objective, Peak};
use crate::situation::Situation;
use primitives::{SimTime, math};
use scenario::strategy::MemoryTurnLimit;
use std::collections::VecDeque;
use std::f64::consts::PI;

/// Maximum number of remembered headings.
const MOST: usize = 256;

#[derive(Clone)]
pub(super) struct MemoryTurnLimitBehaviour {
    task: MemoryTurnLimit,
    headings: VecDeque<(SimTime, f64)>,
}

impl MemoryTurnLimitBehaviour {
    pub(super) fn new(task: MemoryTurnLimit) -> MemoryTurnLimitBehaviour {
        MemoryTurnLimitBehaviour {
            task,
            headings: VecDeque::with_capacity(MOST),
        }
    }

    /// The mean of the remembered headings as directions, rad.
    fn mean_rad(&self) -> f64 {
        let mut sum_sin = 0.0;
        let mut sum_cos = 0.0;
        for (_, heading_rad) in &self.headings {
            let (sin, cos) = math::sin_cos(*heading_rad);
            // Average directions, not angles: the mean of 359 and 1 degrees is north.
            (sum_sin, sum_cos) = (sum_sin + sin, sum_cos + cos);
        }
        math::atan2(sum_sin, sum_cos)
    }
}

impl BehaviourLogic for MemoryTurnLimitBehaviour {
    fn begin(&mut self, _situation: &Situation) {
        self.headings.clear();
    }

    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        let memory = SimTime::from_s(self.task.memory_s.value(situation));
        while self
            .headings
            .front()
            .is_some_and(|(at, _)| *at + memory < situation.now)
        {
            self.headings.pop_front();
        }
        // Space the stored headings evenly if the memory is too long to store every decision.
        let spacing = SimTime::from_s(memory.as_s() / (MOST - 1) as f64);
        if self
            .headings
            .back()
            .is_none_or(|(at, _)| *at + spacing <= situation.now)
            && self.headings.len() < MOST
        {
            self.headings
                .push_back((situation.now, situation.own.nav.psi_rad));
        }
        let range_rad = self.task.turn_range_deg.value(situation).to_radians();
        output.add(&Objective::course(Peak {
            summit: self.mean_rad(),
            peak_width: range_rad,
            base_width: (PI - range_rad).max(0.0),
            summit_delta: 0.0,
            height: 100.0,
        }));
    }
}
