//! Command line arguments that define how and where the page is served.

use super::hub_args::own_address;
use crate::screen::{self, Screen};
use crate::stop;
use crate::style::Names;
use anyhow::{Result, ensure};
use command_line::leaf_args;
use command_line::number::address;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use shore::page::{Background, Page, PageError, PageSettings};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The preferred port of the page.
const PORT: u16 = 8088;
/// The environment variable with the page's token.
const TOKEN_VARIABLE: &str = "SQUALL_PAGE_TOKEN";

#[derive(clap::Args, Clone, Debug)]
pub(crate) struct PageArgs {
    /// Address and port of the page; if other machines can reach it, as with 0.0.0.0:8088, a token
    /// is required [default: 127.0.0.1:8088, or another free port if 8088 is taken]
    #[arg(long, value_name = "ADDRESS", value_parser = address)]
    listen: Option<SocketAddr>,
    /// Token required to pause, stop or drive from the page, but not to watch. Other users of this
    /// machine can read it in the process list: prefer --page-token-file
    #[arg(long, value_name = "TEXT")]
    token: Option<String>,
    /// Reads the page's token from this file instead of the variable SQUALL_PAGE_TOKEN
    #[arg(long, value_name = "FILE", conflicts_with = "token")]
    page_token_file: Option<PathBuf>,
    /// Additional host name of the page; requires a token; may be repeated
    #[arg(long, value_name = "NAME")]
    host: Vec<String>,
    /// Chart to draw beneath the field: GeoJSON, or PNG or JPEG with a world file
    #[arg(long, value_name = "FILE")]
    chart: Option<PathBuf>,
    /// Opens the page in the browser
    #[arg(long)]
    open: bool,
}

impl PageArgs {
    /// Checks, before a game begins, that the page can be served.
    pub(crate) fn check(&self) -> Result<()> {
        let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        Ok(Page::check(
            &self.settings(self.listen.unwrap_or(any), &Arc::default())?,
        )?)
    }

    fn settings(&self, listen: SocketAddr, stop: &Arc<AtomicBool>) -> Result<PageSettings> {
        let background = self.chart.as_deref().map(Background::read).transpose()?;
        let token = self.token()?;
        let hosts = self.host.clone();
        let stop = Arc::clone(stop);
        Ok(PageSettings {
            listen,
            token,
            hosts,
            background,
            stop,
        })
    }

    /// Serves an empty page.
    pub(crate) fn open(&self, stop: &Arc<AtomicBool>) -> Result<Page> {
        let usual = SocketAddr::from((Ipv4Addr::LOCALHOST, PORT));
        let page = match (
            self.listen,
            Page::open(self.settings(self.listen.unwrap_or(usual), stop)?),
        ) {
            // The default port is taken, perhaps by another page.
            (None, Err(PageError::Listen { .. })) => {
                Page::open(self.settings(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)), stop)?)
            }
            (_, page) => page,
        };
        Ok(page?)
    }

    /// Whether any page argument is given.
    pub(crate) fn is_given(&self) -> bool {
        let has_token = self.token.is_some() || self.page_token_file.is_some();
        self.listen.is_some()
            || has_token
            || !self.host.is_empty()
            || self.chart.is_some()
            || self.open
    }

    /// Whether the user chose a page token, which is then part of the page's address.
    pub(crate) fn has_token(&self) -> bool {
        self.token().is_ok_and(|token| token.is_some())
    }

    /// The token that the user chose.
    fn token(&self) -> Result<Option<String>> {
        if self.token.is_some() {
            return Ok(self.token.clone());
        }
        let given = leaf_args::text_of(self.page_token_file.as_deref(), TOKEN_VARIABLE)?;
        let Some((text, place)) = given else {
            return Ok(None);
        };
        let token = text.trim();
        ensure!(
            !token.is_empty() && !token.contains('\n'),
            "{place}: expected a token, one line of text"
        );
        Ok(Some(token.to_owned()))
    }

    /// The page's address for a browser, with the token.
    pub(crate) fn url(&self, page: &Page) -> String {
        // The token was validated before the page was served.
        address_of(page, self.token().unwrap_or_default().as_deref())
    }

    /// The same arguments, with `--open`.
    pub(crate) fn opened(&self) -> PageArgs {
        PageArgs {
            open: true,
            ..self.clone()
        }
    }

    /// Serves a page, on which `put` places the content of the file at this path, until Ctrl-C.
    pub(crate) fn show(
        &self,
        path: &Path,
        stop: &Arc<AtomicBool>,
        put: impl FnOnce(&Page),
    ) -> Result<ExitCode> {
        let page = self.open(stop)?;
        put(&page);
        Screen::new(Names::default()).line(&format!(
            "{} at {} (Ctrl-C to stop)",
            path.display(),
            self.url(&page)
        ));
        self.open_browser(&page);
        stop::wait(stop);
        Ok(ExitCode::SUCCESS)
    }

    /// Opens the page in the browser if requested. Its address has already been printed.
    pub(crate) fn open_browser(&self, page: &Page) {
        if self.open && open::that_detached(self.url(page)).is_err() {
            screen::remark("cannot open a browser");
        }
    }

    /// Passes these arguments to a child process, with the token where no other user can read it.
    pub(crate) fn give_to(&self, command: &mut Command) {
        let listen = self
            .listen
            .iter()
            .map(|listen| ("--listen", listen.to_string()));
        let hosts = self.host.iter().map(|host| ("--host", host.clone()));
        let chart = self
            .chart
            .iter()
            .map(|chart| ("--chart", chart.display().to_string()));
        let words = listen
            .chain(hosts)
            .chain(chart)
            .flat_map(|(name, value)| [name.to_owned(), value]);
        command.args(words.chain(self.open.then(|| "--open".to_owned())));
        if let Ok(Some(token)) = self.token() {
            command.env(TOKEN_VARIABLE, token);
        }
    }
}

/// The page's address for operators of real boats.
pub(crate) fn operator_url(page: &Page) -> String {
    address_of(page, Some(&page.operator_token))
}

fn address_of(page: &Page, token: Option<&str>) -> String {
    let token = token
        .map(|token| format!("#token={}", in_address(token)))
        .unwrap_or_default();
    let mut address = page.address;
    if address.ip().is_unspecified() {
        address.set_ip(own_address().unwrap_or(Ipv4Addr::LOCALHOST.into()));
    }
    format!("http://{address}/{token}")
}

/// A string, escaped for a URL.
fn in_address(text: &str) -> String {
    const SPELLED: &AsciiSet = &NON_ALPHANUMERIC
        .remove(b'-')
        .remove(b'.')
        .remove(b'_')
        .remove(b'~');
    utf8_percent_encode(text, SPELLED).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{Args as _, FromArgMatches as _};

    fn page_args(words: &[&str]) -> PageArgs {
        let command = PageArgs::augment_args(clap::Command::new("page").no_binary_name(true));
        PageArgs::from_arg_matches(&command.get_matches_from(words))
            .expect("they are options of the page")
    }

    #[test]
    fn no_other_user_can_read_the_token_of_a_page_that_a_game_starts() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("token");
        std::fs::write(&file, "sesame\n").expect("it is written");
        for words in [
            ["--token", "sesame"],
            ["--page-token-file", file.to_str().expect("text")],
        ] {
            let mut command = Command::new("squall");
            page_args(&words).give_to(&mut command);
            assert!(
                !format!("{:?}", command.get_args().collect::<Vec<_>>()).contains("sesame"),
                "{command:?}"
            );
            let given: Vec<_> = command.get_envs().collect();
            assert_eq!(given, [(TOKEN_VARIABLE.as_ref(), Some("sesame".as_ref()))]);
        }
        for (text, why) in [("", "expected a token"), ("two\nlines", "one line of text")] {
            std::fs::write(&file, text).expect("it is written");
            let error = page_args(&["--page-token-file", file.to_str().expect("text")])
                .check()
                .expect_err(text);
            assert!(
                error.to_string().contains(why) && error.to_string().contains("token"),
                "{error}"
            );
        }
    }

    #[test]
    fn a_token_stands_in_an_address_as_one_word() {
        for (token, want) in [
            ("secret-1", "secret-1"),
            ("a b&c#é", "a%20b%26c%23%C3%A9"),
            ("50%+", "50%25%2B"),
        ] {
            assert_eq!(in_address(token), want);
        }
    }
}
