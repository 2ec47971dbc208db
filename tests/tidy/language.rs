//! Checks the language of documents and of the program's strings, and the targets of links.

use crate::rule::Breaches;
use crate::text::{code_of, prose};
use crate::tree::Tree;

/// Maximum length of a sentence in a document, words. Half of that is better.
const WORDS_MAX: usize = 40;

/// Phrases that a native engineer would not write, each with its replacement.
const PHRASES: [(&str, &str); 24] = [
    ("that is none", "invalid, non-finite"),
    ("came of", "the result"),
    ("comes of", "the result"),
    ("goes by", "uses, follows"),
    ("heed", "follow, accept"),
    ("is told", "receives, is reported"),
    ("milliard", "billion"),
    ("of yours", "your own"),
    ("reckon", "estimate, calculate"),
    ("who has", "the user with, anyone with"),
    ("whoever", "anyone who, the user"),
    ("nothing would come", "would have no effect"),
    ("goes on with", "continues, resumes"),
    ("go on with", "continue, resume"),
    ("surely", "significantly, certainly"),
    ("one at least", "at least one"),
    ("in the mean", "on average"),
    ("is there already", "already exists"),
    ("look at it", "show it, open it"),
    ("thrust zero", "zero thrust"),
    ("inside of", "inside, within"),
    ("outside of", "outside"),
    ("anew", "again"),
    ("numbers went bad", "state became non-finite"),
];

/// Folders of code whose help, messages and comments are checked like documents.
const CODE: [&str; 8] = [
    "src/",
    "gateway/cli/src/",
    "crates/analysis/src/",
    "crates/arena/src/",
    "crates/command_line/src/",
    "crates/experiment/src/",
    "crates/recording/src/",
    "crates/trial/src/",
];

/// Hand-written documents. Generated ones are checked at their source.
fn documents(tree: &Tree) -> impl Iterator<Item = (&String, &String)> {
    let is_written = |path: &str| {
        path.ends_with(".md") && !path.ends_with("REFERENCE.md") && !path.contains("/reference/")
    };
    tree.files.iter().filter(move |(path, _)| is_written(path))
}

/// The comments and the string literals of a source, with their line numbers, up to its tests.
fn texts(source: &str) -> impl Iterator<Item = (usize, String)> {
    source
        .lines()
        .zip(code_of(source))
        .map(|(line, (number, code))| {
            let comment = line.strip_prefix(code).unwrap_or_default();
            let literals = code.split('"').skip(1).step_by(2);
            (
                number,
                literals.chain([comment]).collect::<Vec<_>>().join(" "),
            )
        })
}

/// The phrases in a line that a native engineer would not write. Ignores names in backticks.
fn phrases(path: &str, number: usize, line: &str) -> Breaches {
    let words = line
        .split('`')
        .step_by(2)
        .collect::<Vec<_>>()
        .join(" ")
        .to_lowercase();
    let words = format!(" {} ", words.replace(|c: char| !c.is_alphanumeric(), " "));
    let found = PHRASES
        .iter()
        .filter(|(phrase, _)| words.contains(&format!(" {phrase} ")));
    found
        .map(|(phrase, better)| format!("{path}:{number}: {phrase:?}; better: {better}"))
        .collect()
}

pub(crate) fn language(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    let is_checked = |path: &str| CODE.iter().any(|folder| path.starts_with(folder));
    for (path, text) in tree.sources().filter(|(path, _)| is_checked(path)) {
        breaches.extend(texts(text).flat_map(|(number, line)| phrases(path, number, &line)));
    }
    for (path, text) in documents(tree) {
        breaches.extend(prose(text).flat_map(|(number, line)| phrases(path, number, line)));
        for (number, sentence) in sentences(text) {
            let words = sentence.split_whitespace().count();
            if words > WORDS_MAX {
                let begin: String = sentence.chars().take(50).collect();
                breaches.push(format!(
                    "{path}:{number}: a sentence of {words} words, allowed: {WORDS_MAX}: {begin}"
                ));
            }
        }
    }
    breaches
}

/// The sentences of paragraphs and lists, with the first line number of the paragraph.
fn sentences(text: &str) -> Vec<(usize, String)> {
    let mut paragraphs: Vec<(usize, String)> = vec![];
    let mut is_open = false;
    for (number, line) in prose(text) {
        let is_item = line.starts_with("- ")
            || line
                .split_once(". ")
                .is_some_and(|(n, _)| n.parse::<u8>().is_ok());
        let is_text = !line.is_empty() && !line.starts_with(['|', '#', '!']);
        match paragraphs.last_mut() {
            Some((_, paragraph)) if is_open && is_text && !is_item => {
                *paragraph += &format!(" {line}")
            }
            _ if is_text => paragraphs.push((number, line.to_owned())),
            _ => {}
        }
        is_open = is_text;
    }
    let ends = [". ", "! ", "? ", ": ", "; "];
    let cut = |(number, text): (usize, String)| {
        let text = ends.iter().fold(text, |text, end| text.replace(end, "\n"));
        text.lines()
            .map(|sentence| (number, sentence.to_owned()))
            .collect::<Vec<_>>()
    };
    paragraphs.into_iter().flat_map(cut).collect()
}

pub(crate) fn links(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for (path, text) in tree
        .files
        .iter()
        .filter(|(path, _)| path.ends_with(".md") && !path.contains("/reference/"))
    {
        for (number, line) in prose(text) {
            let targets = line
                .split("](")
                .skip(1)
                .filter_map(|rest| rest.split_once([')', ' ']));
            for (target, _) in targets
                .filter(|(target, _)| !target.contains("://") && !target.starts_with("mailto"))
            {
                let (file, heading) = target.split_once('#').unwrap_or((target, ""));
                let file = if file.is_empty() {
                    path.clone()
                } else {
                    beside(path, file)
                };
                if !tree.has(&file) {
                    breaches.push(format!(
                        "{path}:{number}: the link {target} leads to no file"
                    ));
                } else if !heading.is_empty()
                    && tree
                        .files
                        .get(&file)
                        .is_some_and(|text| !headings(text).iter().any(|one| one == heading))
                {
                    breaches.push(format!(
                        "{path}:{number}: the link {target} leads to no heading"
                    ));
                }
            }
        }
    }
    breaches
}

/// The path of a file named in the document at `path`.
fn beside(path: &str, file: &str) -> String {
    let mut parts: Vec<&str> = path.split('/').collect();
    parts.pop();
    for part in file.split('/') {
        match part {
            ".." => drop(parts.pop()),
            "." | "" => {}
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// The anchors that GitHub generates for a document's headings.
fn headings(text: &str) -> Vec<String> {
    let titles = prose(text).filter_map(|(_, line)| {
        Some(line.trim_start_matches('#').trim()).filter(|_| line.starts_with('#'))
    });
    let anchor = |title: &str| {
        let is_kept = |c: &char| c.is_alphanumeric() || *c == ' ' || *c == '-' || *c == '_';
        title
            .to_lowercase()
            .chars()
            .filter(is_kept)
            .collect::<String>()
            .replace(' ', "-")
    };
    titles.map(anchor).collect()
}
