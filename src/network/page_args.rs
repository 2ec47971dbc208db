//! The command line's way of saying where the page is served.

use crate::screen;
use anyhow::Result;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use shore::page::{Background, Page, PageError, PageSettings};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The port of the page, if it is free.
const PORT: u16 = 8088;

/// Where the page is served.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct PageArgs {
    /// Address of the page; beyond this machine, for example 0.0.0.0:8088, it needs a token [default: 127.0.0.1:8088, or
    /// another port if that is taken]
    #[arg(long, value_name = "ADDRESS")]
    listen: Option<SocketAddr>,
    /// What a page has to show to pause, stop or drive; looking is free
    #[arg(long, value_name = "TEXT")]
    token: Option<String>,
    /// A further name under which the page may be asked for; it needs a token
    #[arg(long, value_name = "NAME")]
    host: Vec<String>,
    /// What is drawn below the field: GeoJSON, or PNG or JPEG with its world file
    #[arg(long, value_name = "FILE")]
    chart: Option<PathBuf>,
    /// Opens the page in the browser
    #[arg(long)]
    open: bool,
}

impl PageArgs {
    /// Whether the page can be served, to be asked before a game begins.
    pub(crate) fn check(&self) -> Result<()> {
        let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        Ok(Page::check(&self.settings(self.listen.unwrap_or(any), &Arc::default())?)?)
    }

    fn settings(&self, listen: SocketAddr, stop: &Arc<AtomicBool>) -> Result<PageSettings> {
        let background = self.chart.as_deref().map(Background::read).transpose()?;
        let (token, hosts, stop) = (self.token.clone(), self.host.clone(), Arc::clone(stop));
        Ok(PageSettings { listen, token, hosts, background, stop })
    }

    /// Serves a page that shows nothing yet.
    pub(crate) fn open(&self, stop: &Arc<AtomicBool>) -> Result<Page> {
        let usual = SocketAddr::from((Ipv4Addr::LOCALHOST, PORT));
        let page = match (self.listen, Page::open(self.settings(self.listen.unwrap_or(usual), stop)?)) {
            // Another page is there already.
            (None, Err(PageError::Listen { .. })) => {
                Page::open(self.settings(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)), stop)?)
            }
            (_, page) => page,
        };
        Ok(page?)
    }

    /// Whether anything is said of the page.
    pub(crate) fn is_given(&self) -> bool {
        self.listen.is_some() || self.token.is_some() || !self.host.is_empty() || self.chart.is_some() || self.open
    }

    /// Whether pages have to show a token that somebody chose, which the page's address has.
    pub(crate) fn has_token(&self) -> bool {
        self.token.is_some()
    }

    /// Where a browser finds the page, with its rights.
    pub(crate) fn url(&self, page: &Page) -> String {
        address_of(page, self.token.as_deref())
    }

    /// The same, and the page is opened in the browser.
    pub(crate) fn opened(&self) -> PageArgs {
        PageArgs { open: true, ..self.clone() }
    }

    /// Opens the page in the browser if that was asked for; where there is none people have its address.
    pub(crate) fn open_browser(&self, page: &Page) {
        if self.open && open::that_detached(self.url(page)).is_err() {
            screen::remark("no browser can be opened from here");
        }
    }

    /// The same as arguments of another process of this program.
    pub(crate) fn words(&self) -> Vec<String> {
        let listen = self.listen.iter().map(|listen| ("--listen", listen.to_string()));
        let token = self.token.iter().map(|token| ("--token", token.clone()));
        let hosts = self.host.iter().map(|host| ("--host", host.clone()));
        let chart = self.chart.iter().map(|chart| ("--chart", chart.display().to_string()));
        let words = listen.chain(token).chain(hosts).chain(chart).flat_map(|(name, value)| [name.to_owned(), value]);
        words.chain(self.open.then(|| "--open".to_owned())).collect()
    }
}

/// Where a browser finds the page, for those who may operate real boats.
pub(crate) fn operator_url(page: &Page) -> String {
    address_of(page, Some(page.operator_token()))
}

fn address_of(page: &Page, token: Option<&str>) -> String {
    let token = token.map(|token| format!("#token={}", in_address(token))).unwrap_or_default();
    let mut address = page.address();
    if let (true, Some(own)) = (address.ip().is_unspecified(), own_ip()) {
        address.set_ip(own);
    }
    format!("http://{address}/{token}")
}

/// A text as it may stand in an address.
fn in_address(text: &str) -> String {
    const SPELLED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~');
    utf8_percent_encode(text, SPELLED).to_string()
}

/// The address of this machine on the network, if it is on one. Nothing is sent for it.
fn own_ip() -> Option<IpAddr> {
    // An address that is kept free for documents (RFC 5737): the way there is the way out.
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).ok()?;
    socket.local_addr().ok().map(|address| address.ip())
}

#[cfg(test)]
mod tests {
    use super::in_address;

    #[test]
    fn a_token_stands_in_an_address_as_one_word() {
        for (token, want) in [("secret-1", "secret-1"), ("a b&c#é", "a%20b%26c%23%C3%A9"), ("50%+", "50%25%2B")] {
            assert_eq!(in_address(token), want);
        }
    }
}
