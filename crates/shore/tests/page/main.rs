//! The page's server as a browser sees it: over TCP, with WebSockets.

mod access;
mod client;
mod live;
mod operate;
mod replay;
mod report;
mod session;
mod source;

use client::Client;
use shore::page::{Page, PageSettings, View};
use std::sync::Arc;

/// A server on a free port without a view.
fn empty_page(token: Option<&str>, hosts: &[&str]) -> Page {
    Page::open(settings(token, hosts)).expect("a free port")
}

fn settings(token: Option<&str>, hosts: &[&str]) -> PageSettings {
    PageSettings {
        listen: "127.0.0.1:0".parse().expect("an address"),
        token: token.map(str::to_owned),
        hosts: hosts.iter().map(|host| (*host).to_owned()).collect(),
        background: None,
        stop: Arc::default(),
    }
}

/// A server on a free port that shows this view.
fn page(show: Arc<dyn View>, token: Option<&str>, hosts: &[&str]) -> Page {
    let page = empty_page(token, hosts);
    page.show(show);
    page
}

/// A server on a free port that shows this view, and a page connected to it.
fn visit(show: Arc<dyn View>) -> (Page, Client) {
    let page = page(show, None, &[]);
    let client = open_viewer(&page);
    (page, client)
}

/// A page connected to the server.
fn open_viewer(page: &Page) -> Client {
    Client::connect(page.address, "/ws", &[]).expect("everyone may watch")
}
