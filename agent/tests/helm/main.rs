//! Helm decisions, in which programs are applied to pictures; and observations of pictures.

mod behaviour;
mod knowledge;
mod mode;
mod place;
mod pyquaticus;
mod scene;
mod symmetry;
