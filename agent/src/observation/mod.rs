//! Observations: a boat's knowledge at a decision, encoded as a policy's input.
//!
//! The same code encodes observations in training and on the boat. They come only from the pictures
//! that the boat's agent receives: its own sensors, its team's radio and the referee's messages,
//! never from the simulator's true state.

mod numbers;
mod pyquaticus;
mod squall;

use crate::situation::Situation;
use numbers::Numbers;
use scenario::observation::ObservationSpace;

/// Writes the observations of one boat.
#[derive(Clone, Debug)]
pub(crate) struct Observer {
    space: ObservationSpace,
    /// The values of the last decisions, newest first.
    pub(crate) frames: Vec<f32>,
    begun: bool,
}

impl Observer {
    pub(crate) fn new(space: ObservationSpace, situation: &Situation) -> Observer {
        let size = space.size(situation.model.mates.len(), situation.model.enemies.len());
        Observer {
            space,
            frames: vec![0.0; size],
            begun: false,
        }
    }

    /// The observation for this decision of the policy.
    pub(crate) fn observe(&mut self, situation: &Situation) -> &[f32] {
        if let Some(edition) = self.space.edition() {
            pyquaticus::write(situation, edition, &mut Numbers::new(&mut self.frames));
        }
        if let ObservationSpace::Squall {
            mates,
            enemies,
            frames,
        } = self.space
        {
            let size = self.frames.len() / usize::from(frames.max(1));
            let kept = self.frames.len() - size;
            self.frames.copy_within(..kept, size);
            let (newest, older) = self.frames.split_at_mut(size);
            squall::write(
                situation,
                (usize::from(mates), usize::from(enemies)),
                &mut Numbers::new(newest),
            );
            if !self.begun {
                // At the first decision all older frames repeat the current one.
                older
                    .chunks_exact_mut(size)
                    .for_each(|frame| frame.copy_from_slice(newest));
            }
        }
        self.begun = true;
        &self.frames
    }
}
