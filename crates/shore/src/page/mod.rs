//! The live page: a web server that shows a game, or a recording of one, to browsers.
//!
//! [`Page`] serves the files of the page and talks with each browser that opens it as `PROTOCOL.md` says. What it shows
//! is a [`View`]: `live::LiveView` or [`replay::ReplayView`]. Each page has a [`Viewer`] of its own, which is asked what
//! to say next whenever the page can take it; so a slow page sees fewer frames, and nobody waits for it.

mod access;
mod asset;
mod background;
mod chart;
pub mod live;
mod message;
mod preparing;
pub mod replay;
mod report;
mod request;
mod rose;
mod routes;
mod session;
mod socket;
mod view;

pub use background::{Background, BackgroundError};
pub use message::Mode;
pub use preparing::PreparingView;
pub use report::{Report, Showing, Shown};
pub use request::PageRequest;
pub use rose::{HelmAnswer, is_sound};
pub use session::PageSession;
pub use view::{Access, Budget, Changes, Outgoing, View, Viewer};

use access::{AccessControl, Tokens};
use bus::Token;
use report::LateReport;
use std::net::{SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::Duration;
use thiserror::Error;
use tokio::sync::watch;

/// What a page's server needs to know.
pub struct PageSettings {
    /// Where it listens; port 0 is any that is free.
    pub listen: SocketAddr,
    /// What pages that may act have to show. Without one all may.
    pub token: Option<String>,
    /// Further names under which it may be asked for. They need a token: whoever has a name for it comes from elsewhere.
    pub hosts: Vec<String>,
    /// What is drawn below the field.
    pub background: Option<Background>,
    /// Set from outside to end it.
    pub stop: Arc<AtomicBool>,
}

/// Why a page cannot be served.
#[derive(Debug, Error)]
pub enum PageError {
    /// Everybody on the network could act.
    #[error(
        "the page would be open to the network at {0}: listen on a loopback address such as 127.0.0.1, or give a token \
         (--page-token-file) that those who may act have to show"
    )]
    Open(SocketAddr),
    /// Everybody who comes by the name could act: a proxy in front of a loopback address lets in whom it likes.
    #[error(
        "the page would be open to all who reach it as {0:?} (--host): give a token (--page-token-file) that those who may \
         act have to show"
    )]
    Named(String),
    /// A token that is none.
    #[error("the page's token is empty")]
    EmptyToken,
    /// It cannot listen there.
    #[error("the page cannot listen on {address}: {source}")]
    Listen {
        /// Where.
        address: SocketAddr,
        /// What the system says.
        source: std::io::Error,
    },
    /// The server's thread cannot be had.
    #[error("the page's server cannot begin: {0}")]
    Begin(std::io::Error),
}

/// A web server in a thread of its own; dropped, it closes the connections to all pages.
pub struct Page {
    address: SocketAddr,
    operator_token: String,
    shown: Option<watch::Sender<Option<Arc<dyn View>>>>,
    report: LateReport,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Hexadecimal digits of a token that nobody chose: 128 bits.
const OPERATOR_TOKEN_DIGITS: usize = 32;
/// How often the server checks whether it shall end.
const LOOK_AGAIN: Duration = Duration::from_millis(50);
/// How long pages have to receive the close message.
const GOODBYE: Duration = Duration::from_millis(200);

impl Page {
    /// Whether it could be opened.
    ///
    /// # Errors
    /// [`PageError`] if it cannot listen there, or should not.
    pub fn check(settings: &PageSettings) -> Result<(), PageError> {
        listener(settings).map(drop)
    }

    /// Listens, and serves pages that have no view yet.
    ///
    /// # Errors
    /// [`PageError`] if it cannot listen there, or should not.
    pub fn open(settings: PageSettings) -> Result<Page, PageError> {
        let (listener, address) = listener(&settings)?;
        let PageSettings { token, hosts, background, stop, .. } = settings;
        // One thread, beside the game's: a page must never cost the game a processor.
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(PageError::Begin)?;
        let (shown, to_show) = watch::channel(None);
        let operator_token = token.clone().unwrap_or_else(|| Token::random().hex()[..OPERATOR_TOKEN_DIGITS].to_owned());
        let tokens = Tokens { control: token, operate: operator_token.clone() };
        let ended = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ended);
        let report = Arc::new(OnceLock::new());
        let to_publish = Arc::clone(&report);
        let serve = move || {
            let access_control = AccessControl::new(address, &hosts, tokens);
            // What cannot be taken over by the runtime was never a listener.
            drop(runtime.block_on(routes::serve(
                listener,
                access_control,
                (Shown::to_all(to_show), to_publish, background),
                async {
                    while !end.load(Ordering::Relaxed) && !stop.load(Ordering::Relaxed) {
                        tokio::time::sleep(LOOK_AGAIN).await;
                    }
                },
            )));
            runtime.block_on(async { tokio::time::sleep(GOODBYE).await });
            runtime.shutdown_timeout(GOODBYE);
        };
        let thread = std::thread::Builder::new().name("page".to_owned()).spawn(serve).map_err(PageError::Begin)?;
        Ok(Page { address, operator_token, shown: Some(shown), report, ended, thread: Some(thread) })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What a page has to show to operate real boats: the token, or where none is set one of its own.
    #[must_use]
    pub fn operator_token(&self) -> &str {
        &self.operator_token
    }

    /// Publishes a report with its games; the first stays.
    pub fn publish(&self, report: Arc<dyn Report>) {
        self.report.get_or_init(|| report);
    }

    /// From now on all pages are shown this.
    pub fn show(&self, show: Arc<dyn View>) {
        if let Some(shown) = &self.shown {
            shown.send_replace(Some(show));
        }
    }
}

/// Where pages come in, and under which address.
fn listener(PageSettings { listen, token, hosts, .. }: &PageSettings) -> Result<(TcpListener, SocketAddr), PageError> {
    if token.as_ref().is_some_and(String::is_empty) {
        return Err(PageError::EmptyToken);
    }
    // Watching is free, acting is not. TLS is left to a proxy: nobody maintains certificates
    // for a laptop on a dock.
    if !listen.ip().is_loopback() && token.is_none() {
        return Err(PageError::Open(*listen));
    }
    if let (Some(host), None) = (hosts.first(), token) {
        return Err(PageError::Named(host.clone()));
    }
    let at = |source| PageError::Listen { address: *listen, source };
    let listener = TcpListener::bind(listen).map_err(at)?;
    listener.set_nonblocking(true).map_err(at)?;
    let address = listener.local_addr().map_err(at)?;
    Ok((listener, address))
}

impl Drop for Page {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        // Pages notice by the end of the channel.
        self.shown = None;
        if let Some(thread) = self.thread.take() {
            // A server that panicked has said so by itself.
            drop(thread.join());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(listen: &str, token: Option<&str>) -> Result<Page, PageError> {
        let listen = listen.parse().expect("an address");
        let token = token.map(str::to_owned);
        Page::open(PageSettings { listen, token, hosts: vec![], background: None, stop: Arc::default() })
    }

    #[test]
    fn the_network_is_not_let_in_without_a_token() {
        assert!(matches!(open("0.0.0.0:0", None), Err(PageError::Open(_))));
        assert!(matches!(open("[::]:0", None), Err(PageError::Open(_))));
        assert!(matches!(open("0.0.0.0:0", Some("")), Err(PageError::EmptyToken)));
        assert!(open("0.0.0.0:0", Some("secret")).is_ok());
        assert!(open("127.0.0.1:0", None).is_ok());
    }

    #[test]
    fn a_further_name_needs_a_token() {
        let open = |token: Option<&str>| {
            let (listen, hosts) = ("127.0.0.1:0".parse().unwrap(), vec!["boat.local".to_owned()]);
            Page::open(PageSettings {
                listen,
                token: token.map(str::to_owned),
                hosts,
                background: None,
                stop: Arc::default(),
            })
        };
        let error = open(None).err().expect("it is refused").to_string();
        assert!(["boat.local", "--host", "--token"].iter().all(|word| error.contains(word)), "{error}");
        assert!(open(Some("secret")).is_ok());
    }

    #[test]
    fn a_port_that_is_taken_is_an_error() {
        let first = open("127.0.0.1:0", None).expect("any port");
        let again = open(&first.address().to_string(), None);
        assert!(matches!(again, Err(PageError::Listen { .. })));
    }
}
