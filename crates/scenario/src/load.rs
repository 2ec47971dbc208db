//! Entry points: load a file by path, or return all its faults.

use super::Scenario;
use super::draw::{Drawing, Drawn, Recipe};
use super::files::Files;
use super::kind::{Kind, ScenarioFile};
use super::loader::{Basis, Loader};
use super::overrides::Overrides;
use super::problem::Problems;
use super::read;
use super::tree::Node;
use crate::strategy::Strategy;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Reads and checks the game file at `path` and all referenced files. Distributions are drawn with
/// the game's own seed; [`Scenario::of_seed`] uses others.
///
/// # Errors
/// All faults in all files, by file, line and column.
pub fn load(path: &Path) -> Result<Scenario, Problems> {
    load_with(path, &Overrides::default())
}

/// Reads and checks a game with overrides.
///
/// # Errors
/// All faults in all files, by file, line and column; or a strategy given for an unknown team.
pub fn load_with(path: &Path, overrides: &Overrides) -> Result<Scenario, Problems> {
    load_with_files(path, overrides, &Arc::default())
}

/// Like [`load_with`], but reads from these files.
///
/// # Errors
/// All faults in all files, as for [`load_with`].
pub fn load_with_files(
    path: &Path,
    overrides: &Overrides,
    files: &Arc<Files>,
) -> Result<Scenario, Problems> {
    let basis = Basis {
        files: Arc::clone(files),
        ..Basis::default()
    };
    load_game(path, overrides, basis)
}

fn load_game(path: &Path, overrides: &Overrides, basis: Basis) -> Result<Scenario, Problems> {
    let loader = Loader::new(Drawing::Least, overrides, basis);
    let (mut least, drawn) = loader.faultless::<Scenario>(path)?;
    if drawn.is_empty() {
        return Ok(least);
    }
    let files = loader.diagnostics.sources.borrow().texts();
    let recipe = Recipe {
        game: path.to_owned(),
        overrides: overrides.clone(),
        files,
        basis: loader.into_basis(),
        seed: None,
    };
    // Check both ends of every distribution, so that most mistakes are found before any game. The
    // combination of numbers is checked again for each seed, which takes less than a millisecond.
    // Drawing on the checked types would be faster, but estimates based on a drawn number would
    // keep their nominal values.
    least.drawn_again(&recipe, Drawing::Greatest)?;
    least.recipe = Some(recipe);
    least.of_seed(least.seed)
}

impl Scenario {
    /// This scenario's game with `seed`: distributions are drawn again.
    ///
    /// # Errors
    /// Faults in the combination of numbers, each of which is valid on its own.
    pub fn of_seed(&self, seed: u64) -> Result<Scenario, Problems> {
        let is_other = |recipe: &&Recipe| recipe.seed != Some(seed);
        let Some(recipe) = self.recipe.as_ref().filter(is_other) else {
            return Ok(Scenario {
                seed,
                ..self.clone()
            });
        };
        let (drawn, basis) = self.drawn_again(recipe, Drawing::Seed(seed))?;
        let recipe = Recipe {
            basis,
            seed: Some(seed),
            ..recipe.clone()
        };
        Ok(Scenario {
            seed,
            recipe: Some(recipe),
            ..drawn
        })
    }

    /// The game of a recipe, with numbers drawn by this method, and the data read for it.
    fn drawn_again(
        &self,
        recipe: &Recipe,
        drawing: Drawing,
    ) -> Result<(Scenario, Basis), Problems> {
        let mut basis = recipe.basis.clone();
        // A recorded recipe contains only the files.
        if basis.checked.is_empty() {
            let texts = recipe.files.iter();
            let texts = texts.map(|(path, text)| (path.clone(), text.clone().into_bytes()));
            let models = self.strategies.iter().flat_map(Strategy::models);
            let models = models.map(|model| (model.name.clone().into(), model.bytes().to_vec()));
            basis.files = Arc::new(Files::kept(texts.chain(models).collect()));
        }
        let loader = Loader::new(drawing, &recipe.overrides, basis);
        let (scenario, drawn) = loader.faultless::<Scenario>(&recipe.game)?;
        Ok((Scenario { drawn, ..scenario }, loader.into_basis()))
    }
}

/// Reads and checks the file at `path` as a file of kind `F`.
///
/// # Errors
/// All faults in the file, its bases and referenced files, by file, line and column.
pub fn load_file<F: ScenarioFile>(path: &Path) -> Result<F, Problems> {
    F::load(path)
}

/// Reads and checks the file at `path` as a file of kind `F`, and draws its numbers as in the game
/// with this seed.
///
/// # Errors
/// All faults in the file, its bases and referenced files, by file, line and column.
pub fn draw_file<F: ScenarioFile>(path: &Path, seed: u64) -> Result<(F, Vec<Drawn>), Problems> {
    let read = |drawing: Drawing| {
        Loader::new(drawing, &Overrides::default(), Basis::default()).faultless::<F>(path)
    };
    let (value, drawn) = read(Drawing::Least)?;
    if drawn.is_empty() {
        return Ok((value, drawn));
    }
    read(Drawing::Greatest)?;
    read(Drawing::Seed(seed))
}

/// Checks a game with these overrides, and with others that set the same keys. Files that no
/// setting changes are checked once.
///
/// # Errors
/// All faults in any of the game's files.
pub fn check_variants(
    game: &Path,
    first: &Overrides,
    others: impl Iterator<Item = Overrides>,
) -> Result<(), Problems> {
    let loader = Loader::new(Drawing::Least, first, Basis::default());
    loader.read::<Scenario>(game, None, Scenario::NAME);
    let mut basis = loader.into_basis();
    let is_unchanged = |kind: &str| !first.has_settings(kind);
    basis.checked.retain(|(kind, ..), _| is_unchanged(kind));
    let all = std::iter::once(first.clone()).chain(others);
    let faults = all.filter_map(|overrides| load_game(game, &overrides, basis.clone()).err());
    Problems::of(faults.flat_map(|Problems(found)| found).collect())
}

/// The value of an empty file of kind `F`.
///
/// # Errors
/// If a key has no default.
pub fn default_of<F: ScenarioFile>() -> Result<F, Problems> {
    let path = Path::new("default.toml");
    let basis = Basis {
        files: Arc::new(Files::kept(vec![(path.to_owned(), vec![])])),
        ..Basis::default()
    };
    let loader = Loader::new(Drawing::Least, &Overrides::default(), basis);
    loader.faultless(path).map(|(value, _)| value)
}

/// Reads and checks a scenario file of any of these kinds, and returns its kind.
///
/// The folder determines the kind. In any other folder, it is the kind with the most of the file's
/// top-level keys, including those of its bases; ties go to the first of `kinds`.
///
/// # Errors
/// All faults in the file, its bases and referenced files.
pub fn check_file(kinds: &[Kind], path: &Path) -> Result<Kind, Problems> {
    let kind =
        Kind::by_folder(kinds, path).unwrap_or_else(|| Kind::by_keys(kinds, &top_keys(path)));
    kind.check(path).map(|()| kind)
}

/// The kind to which a file clearly belongs by its folder or keys, if not the expected one.
pub fn other_kind(kinds: &[Kind], path: &Path, expected: Kind) -> Option<Kind> {
    match Kind::by_folder(kinds, path) {
        Some(kind) => (kind != expected).then_some(kind),
        None => expected.other_by_keys(kinds, &top_keys(path)),
    }
}

/// The top-level keys of a file and its bases; the check reports their faults later.
fn top_keys(path: &Path) -> BTreeSet<String> {
    let loader = Loader::new(Drawing::Least, &Overrides::default(), Basis::default());
    let tree = read::tree(&loader, path, None, &[]);
    let entries = tree.iter().flat_map(Node::entries);
    entries.map(|(key, _)| key.clone()).collect()
}
