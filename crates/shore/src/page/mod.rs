//! The page: a web server that shows a running game or a recording in browsers.
//!
//! [`Page`] serves the files of the page and communicates with each browser as defined in
//! `PROTOCOL.md`. It shows a [`View`]: `live::LiveView` or [`replay::ReplayView`]. Each page has
//! its own [`Viewer`], which supplies the next message whenever the page can accept one. A slow
//! page therefore gets fewer frames and does not delay others.

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

/// Settings of the page's server.
pub struct PageSettings {
    /// The address to listen on; port 0 chooses any free port.
    pub listen: SocketAddr,
    /// The token that pages need for actions. With `None`, every page may act, except that
    /// operating real boats always needs [`Page::operator_token`].
    pub token: Option<String>,
    /// Additional host names of the server. They require a token, because their users are on other
    /// machines.
    pub hosts: Vec<String>,
    /// The background drawn beneath the field.
    pub background: Option<Background>,
    /// Set by the caller to stop the server.
    pub stop: Arc<AtomicBool>,
}

/// A reason why a page cannot be served.
#[derive(Debug, Error)]
pub enum PageError {
    /// Any machine on the network could act.
    #[error(
        "the page would be open to the network at {0}: listen on a loopback address such as 127.0.0.1, or require a \
         token for actions (--page-token-file)"
    )]
    Open(SocketAddr),
    /// Anyone who uses the name could act: a proxy in front of a loopback address may admit anyone.
    #[error(
        "the page would be open to everyone who reaches it as {0:?} (--host): require a token for actions \
         (--page-token-file)"
    )]
    Named(String),
    /// An empty token.
    #[error("the page's token is empty")]
    EmptyToken,
    /// The server cannot listen on this address.
    #[error("the page cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The system's error.
        source: std::io::Error,
    },
    /// The server's thread cannot be started.
    #[error("cannot start the page's server: {0}")]
    Begin(std::io::Error),
}

/// A web server in its own thread. Dropping it closes the connections to all pages.
pub struct Page {
    /// The address on which it listens.
    pub address: SocketAddr,
    /// The token that pages need to operate real boats: the configured token or a generated one.
    pub operator_token: String,
    shown: Option<watch::Sender<Option<Arc<dyn View>>>>,
    report: LateReport,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Hexadecimal digits of a generated token: 128 bits.
const OPERATOR_TOKEN_DIGITS: usize = 32;
/// Interval between checks whether the server should stop.
const LOOK_AGAIN: Duration = Duration::from_millis(50);
/// Time limit for pages to receive the close message.
const GOODBYE: Duration = Duration::from_millis(200);

impl Page {
    /// Checks whether the page could be opened.
    ///
    /// # Errors
    /// [`PageError`] if it cannot or must not listen on the address.
    pub fn check(settings: &PageSettings) -> Result<(), PageError> {
        listener(settings).map(drop)
    }

    /// Listens and serves pages, initially without a view.
    ///
    /// # Errors
    /// [`PageError`] if it cannot or must not listen on the address.
    pub fn open(settings: PageSettings) -> Result<Page, PageError> {
        let (listener, address) = listener(&settings)?;
        let PageSettings {
            token,
            hosts,
            background,
            stop,
            ..
        } = settings;
        // Use a single thread, to leave the other processors to the game.
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(PageError::Begin)?;
        let (shown, to_show) = watch::channel(None);
        let operator_token = token
            .clone()
            .unwrap_or_else(|| Token::random().hex()[..OPERATOR_TOKEN_DIGITS].to_owned());
        let tokens = Tokens {
            control: token,
            operate: operator_token.clone(),
        };
        let ended = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ended);
        let report = Arc::new(OnceLock::new());
        let to_publish = Arc::clone(&report);
        let serve = move || {
            let access_control = AccessControl::new(address, &hosts, tokens);
            // A socket that the runtime cannot adopt was never a listener.
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
        let thread = std::thread::Builder::new()
            .name("page".to_owned())
            .spawn(serve)
            .map_err(PageError::Begin)?;
        Ok(Page {
            address,
            operator_token,
            shown: Some(shown),
            report,
            ended,
            thread: Some(thread),
        })
    }

    /// Publishes a report with its games. Only the first call has an effect.
    pub fn publish(&self, report: Arc<dyn Report>) {
        self.report.get_or_init(|| report);
    }

    /// Shows the given view on all pages from now on.
    pub fn show(&self, show: Arc<dyn View>) {
        if let Some(shown) = &self.shown {
            shown.send_replace(Some(show));
        }
    }
}

/// The listener, and its address.
fn listener(
    PageSettings {
        listen,
        token,
        hosts,
        ..
    }: &PageSettings,
) -> Result<(TcpListener, SocketAddr), PageError> {
    if token.as_ref().is_some_and(String::is_empty) {
        return Err(PageError::EmptyToken);
    }
    // Watching requires no token, acting does. TLS is left to a proxy: no one maintains
    // certificates for a laptop on a dock.
    if !listen.ip().is_loopback() && token.is_none() {
        return Err(PageError::Open(*listen));
    }
    if let (Some(host), None) = (hosts.first(), token) {
        return Err(PageError::Named(host.clone()));
    }
    let at = |source| PageError::Listen {
        address: *listen,
        source,
    };
    let listener = TcpListener::bind(listen).map_err(at)?;
    listener.set_nonblocking(true).map_err(at)?;
    let address = listener.local_addr().map_err(at)?;
    Ok((listener, address))
}

impl Drop for Page {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        // Pages notice that the channel has closed.
        self.shown = None;
        if let Some(thread) = self.thread.take() {
            // A server that panicked has already reported it.
            drop(thread.join());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(listen: &str, token: Option<&str>) -> Result<Page, PageError> {
        open_named(listen, token, &[])
    }

    fn open_named(listen: &str, token: Option<&str>, hosts: &[&str]) -> Result<Page, PageError> {
        let hosts = hosts.iter().map(|host| (*host).to_owned()).collect();
        let listen = listen.parse().expect("an address");
        let token = token.map(str::to_owned);
        Page::open(PageSettings {
            listen,
            token,
            hosts,
            background: None,
            stop: Arc::default(),
        })
    }

    #[test]
    fn the_network_is_not_let_in_without_a_token() {
        assert!(matches!(open("0.0.0.0:0", None), Err(PageError::Open(_))));
        assert!(matches!(open("[::]:0", None), Err(PageError::Open(_))));
        assert!(matches!(
            open("0.0.0.0:0", Some("")),
            Err(PageError::EmptyToken)
        ));
        assert!(open("0.0.0.0:0", Some("secret")).is_ok());
        assert!(open("127.0.0.1:0", None).is_ok());
    }

    #[test]
    fn a_further_name_needs_a_token() {
        let open = |token| open_named("127.0.0.1:0", token, &["boat.local"]);
        let error = open(None).err().expect("the page is refused").to_string();
        assert!(
            ["boat.local", "--host", "--page-token-file"]
                .iter()
                .all(|word| error.contains(word)),
            "{error}"
        );
        assert!(open(Some("secret")).is_ok());
    }

    #[test]
    fn a_port_that_is_taken_is_an_error() {
        let first = open("127.0.0.1:0", None).expect("any port");
        let again = open(&first.address.to_string(), None);
        assert!(matches!(again, Err(PageError::Listen { .. })));
    }
}
