//! Adam (Kingma and Ba, ICLR 2015), with gradient norm clipping.

use serde::{Deserialize, Serialize};

/// Settings of Adam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdamSettings {
    /// Decay rate of the gradients' mean.
    pub beta_1: f32,
    /// Decay rate of the squared gradients' mean.
    pub beta_2: f32,
    /// Term added to the square root of the mean squared gradient.
    pub epsilon: f32,
    /// Maximum norm; longer gradients are scaled down to it. `None` means unlimited.
    pub norm_max: Option<f32>,
}

impl Default for AdamSettings {
    fn default() -> AdamSettings {
        AdamSettings {
            beta_1: 0.9,
            beta_2: 0.999,
            epsilon: 1e-5,
            norm_max: Some(0.5),
        }
    }
}

/// The state of an optimiser.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    settings: AdamSettings,
    /// The powers of the two decay rates.
    powers: (f32, f32),
    mean: Vec<f32>,
    square: Vec<f32>,
}

impl Adam {
    /// An optimiser for the given number of parameters.
    pub fn new(parameters: usize, settings: AdamSettings) -> Adam {
        Adam {
            settings,
            powers: (1.0, 1.0),
            mean: vec![0.0; parameters],
            square: vec![0.0; parameters],
        }
    }

    /// Takes one step along the negative gradient. Returns the gradient's norm before clipping.
    pub fn step(&mut self, parameters: &mut [f32], gradient: &[f32], learning_rate: f32) -> f32 {
        let AdamSettings {
            beta_1,
            beta_2,
            epsilon,
            norm_max,
        } = self.settings;
        let norm = gradient
            .iter()
            .map(|number| f64::from(*number) * f64::from(*number))
            .sum::<f64>()
            .sqrt() as f32;
        let scale = norm_max.map_or(1.0, |most| if norm > most { most / norm } else { 1.0 });
        self.powers = (beta_1 * self.powers.0, beta_2 * self.powers.1);
        let left_1 = 1.0 - self.powers.0;
        let left_2 = 1.0 - self.powers.1;
        let rate = learning_rate / left_1;
        for (((parameter, gradient), mean), square) in parameters
            .iter_mut()
            .zip(gradient)
            .zip(&mut self.mean)
            .zip(&mut self.square)
        {
            let gradient = scale * gradient;
            *mean = beta_1 * *mean + (1.0 - beta_1) * gradient;
            *square = beta_2 * *square + (1.0 - beta_2) * gradient * gradient;
            *parameter -= rate * *mean / ((*square / left_2).sqrt() + epsilon);
        }
        norm
    }
}
