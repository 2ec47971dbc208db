//! Entry points: load a file by path, or return all its faults.

use super::Scenario;
use super::diagnostics::Diagnostics;
use super::draw::{Drawing, Drawn, Recipe};
use super::files::Files;
use super::kept::Reading;
use super::kind::{Kind, ScenarioFile};
use super::overrides::Overrides;
use super::problem::Problems;
use super::read;
use super::tree::Node;
use crate::strategy::Strategy;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads and checks the game file at `path` and every file it refers to. Distributions are drawn
/// with the game's own seed; [`Scenario::of_seed`] draws others.
///
/// # Errors
/// All faults of all files, by file, line and column.
pub fn load(path: &Path) -> Result<Scenario, Problems> {
    load_with(path, &Overrides::default())
}

/// Reads and checks a game with overrides.
///
/// # Errors
/// All faults of all files, by file, line and column; or a strategy for an unknown team.
pub fn load_with(path: &Path, overrides: &Overrides) -> Result<Scenario, Problems> {
    load_with_files(path, overrides, &Arc::default())
}

/// As [`load_with`], from these files.
///
/// # Errors
/// All faults of all files, as above.
pub fn load_with_files(
    path: &Path,
    overrides: &Overrides,
    files: &Arc<Files>,
) -> Result<Scenario, Problems> {
    load_knowing(&Reading::default(), path, overrides, files)
}

/// As [`load_with_files`], with some files already read with the same settings.
fn load_knowing(
    known: &Reading,
    path: &Path,
    overrides: &Overrides,
    files: &Arc<Files>,
) -> Result<Scenario, Problems> {
    let mut diagnostics = Diagnostics::new(Drawing::Least);
    diagnostics.resume(known);
    diagnostics.overrides = overrides.clone();
    diagnostics.files = Arc::clone(files);
    let mut least = game_of(&mut diagnostics, path)?;
    if least.drawn.is_empty() {
        return Ok(least);
    }
    let files = diagnostics.sources.texts();
    let reading = Reading::of(diagnostics);
    let recipe = Recipe {
        game: path.to_owned(),
        overrides: overrides.clone(),
        files,
        reading,
        seed: None,
    };
    // At both ends of every distribution, so that most mistakes are found before any game. The
    // combination of numbers is checked again for each seed, which takes a tenth of a millisecond.
    // Drawing on the checked types would be faster, but would leave estimates from a drawn number
    // at their nominal values.
    least.drawn_again(&recipe, Drawing::Greatest)?;
    least.recipe = Some(recipe);
    least.of_seed(least.seed)
}

fn game_of(diagnostics: &mut Diagnostics, path: &Path) -> Result<Scenario, Problems> {
    let (scenario, drawn) = diagnostics.faultless::<Scenario>(path)?;
    Ok(Scenario { drawn, ..scenario })
}

impl Scenario {
    /// This scenario's game with `seed`: distributions are drawn again.
    ///
    /// # Errors
    /// Faults of the combination of numbers, each valid alone.
    pub fn of_seed(&self, seed: u64) -> Result<Scenario, Problems> {
        let Some(recipe) = self
            .recipe
            .as_ref()
            .filter(|recipe| recipe.seed != Some(seed))
        else {
            return Ok(Scenario {
                seed,
                ..self.clone()
            });
        };
        let (drawn, reading) = self.drawn_again(recipe, Drawing::Seed(seed))?;
        let reading = if recipe.reading.0.is_some() {
            recipe.reading.clone()
        } else {
            reading
        };
        Ok(Scenario {
            seed,
            recipe: Some(Recipe {
                reading,
                seed: Some(seed),
                ..recipe.clone()
            }),
            ..drawn
        })
    }

    /// The game of its recipe with numbers drawn like this, and what was read for it.
    fn drawn_again(
        &self,
        recipe: &Recipe,
        drawing: Drawing,
    ) -> Result<(Scenario, Reading), Problems> {
        let mut diagnostics = Diagnostics::new(drawing);
        diagnostics.overrides.clone_from(&recipe.overrides);
        if !diagnostics.resume(&recipe.reading) {
            let texts = recipe
                .files
                .iter()
                .map(|(path, text)| (path.clone(), text.clone().into_bytes()));
            let models = self.strategies.iter().flat_map(Strategy::models);
            let models = models.map(|model| (model.name.clone().into(), model.bytes().to_vec()));
            diagnostics.files = Arc::new(Files::kept(texts.chain(models).collect()));
        }
        let scenario = game_of(&mut diagnostics, &recipe.game)?;
        Ok((scenario, Reading::of(diagnostics)))
    }
}

/// Reads and checks the file at `path` as one of its kind.
///
/// # Errors
/// All faults of it, its bases and the files it refers to, by file, line and column.
pub fn load_file<F: ScenarioFile>(path: &Path) -> Result<F, Problems> {
    F::load(path)
}

/// Reads and checks the file at `path` as one of its kind, and draws its numbers as in the game
/// with this seed.
///
/// # Errors
/// All faults of it, its bases and the files it refers to, by file, line and column.
pub fn draw_file<F: ScenarioFile>(path: &Path, seed: u64) -> Result<(F, Vec<Drawn>), Problems> {
    let read = |drawing: Drawing| Diagnostics::new(drawing).faultless::<F>(path);
    let (value, drawn) = read(Drawing::Least)?;
    if drawn.is_empty() {
        return Ok((value, drawn));
    }
    read(Drawing::Greatest)?;
    read(Drawing::Seed(seed))
}

/// A game that is loaded repeatedly with different values. Files without changed values are read
/// once.
pub struct GameVariants {
    game: PathBuf,
    known: Reading,
    files: Arc<Files>,
}

impl GameVariants {
    /// Reads the game with these values; later ones must set the same keys. [`GameVariants::load`]
    /// returns the faults.
    pub fn new(game: &Path, overrides: &Overrides) -> GameVariants {
        let mut diagnostics = Diagnostics::new(Drawing::Least);
        diagnostics.overrides = overrides.clone();
        let files = Arc::clone(&diagnostics.files);
        drop(game_of(&mut diagnostics, game));
        GameVariants {
            game: game.to_owned(),
            known: Reading::of_unchanged(diagnostics),
            files,
        }
    }

    /// The game with these values.
    ///
    /// # Errors
    /// All faults of any of its files.
    pub fn load(&self, overrides: &Overrides) -> Result<Scenario, Problems> {
        load_knowing(&self.known, &self.game, overrides, &self.files)
    }
}

/// The result of an empty file of a kind.
///
/// # Errors
/// If a key has no default.
pub fn default_of<F: ScenarioFile>() -> Result<F, Problems> {
    let path = Path::new("default.toml");
    let mut diagnostics = Diagnostics::new(Drawing::Least);
    diagnostics.files = Arc::new(Files::kept(vec![(path.to_owned(), vec![])]));
    diagnostics.faultless(path).map(|(value, _)| value)
}

/// Reads and checks a scenario file of any of these kinds, and returns its kind.
///
/// The folder determines the kind. In any other folder it is the kind with the most of the file's
/// top-level keys, including those of its bases; ties go to the first of `kinds`.
///
/// # Errors
/// All faults of it, its bases and the files it refers to.
pub fn check_file(kinds: &[Kind], path: &Path) -> Result<Kind, Problems> {
    let kind =
        Kind::by_folder(kinds, path).unwrap_or_else(|| Kind::by_keys(kinds, &top_keys(path)));
    kind.check(path).map(|()| kind)
}

/// The kind that a file belongs to by its folder or its keys, if clearly not the expected one.
pub fn other_kind(kinds: &[Kind], path: &Path, expected: Kind) -> Option<Kind> {
    match Kind::by_folder(kinds, path) {
        Some(kind) => (kind != expected).then_some(kind),
        None => expected.other_by_keys(kinds, &top_keys(path)),
    }
}

/// The top-level keys of a file and its bases; the check reports their faults later.
fn top_keys(path: &Path) -> BTreeSet<String> {
    let tree = read::tree(&mut Diagnostics::new(Drawing::Least), path, None, &[]);
    tree.iter()
        .flat_map(Node::entries)
        .map(|(key, _)| key.clone())
        .collect()
}
