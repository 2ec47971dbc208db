//! The web site: which request gets which answer.

use super::asset;
use super::guard::Guard;
use super::line::Quay;
use super::show::Guest;
use super::socket::{self, HEARD_MAX, Shown};
use axum::Router;
use axum::body::Body;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::{Request, State};
use axum::http::header::{HOST, HeaderMap, HeaderName, ORIGIN};
use axum::http::{Method, Response, StatusCode, Uri};
use axum::middleware::{self, Next};
use axum::routing::get;
use std::future::Future;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// The most pages that look at a time.
const PAGES_MAX: usize = 64;

/// What all requests have in common.
#[derive(Clone)]
struct Desk {
    guard: Arc<Guard>,
    shown: Shown,
    places: Arc<Semaphore>,
}

/// Answers until the end.
pub(super) async fn serve(
    listener: std::net::TcpListener,
    guard: Guard,
    shown: Shown,
    end: impl Future<Output = ()>,
) -> std::io::Result<()> {
    let quay = Quay::new(tokio::net::TcpListener::from_std(listener)?);
    let desk = Desk { guard: Arc::new(guard), shown, places: Arc::new(Semaphore::new(PAGES_MAX)) };
    let site = Router::new()
        .route("/ws", get(upgrade))
        .fallback(file)
        .layer(middleware::from_fn_with_state(desk.clone(), check))
        .with_state(desk);
    tokio::select! {
        served = axum::serve(quay, site) => served,
        () = end => Ok(()),
    }
}

/// Lets nothing through that is not meant for this server, and seals what it answers.
async fn check(State(desk): State<Desk>, request: Request, next: Next) -> Response<Body> {
    let mut response = match desk.guard.check_host(text_of(request.headers(), &HOST)) {
        Ok(()) => next.run(request).await,
        Err(reason) => asset::text(StatusCode::FORBIDDEN, &reason),
    };
    asset::seal(response.headers_mut());
    response
}

async fn file(method: Method, uri: Uri) -> Response<Body> {
    match method {
        Method::GET | Method::HEAD => asset::answer(uri.path()),
        _ => asset::text(StatusCode::METHOD_NOT_ALLOWED, "There are only files here.\n"),
    }
}

async fn upgrade(
    State(desk): State<Desk>,
    headers: HeaderMap,
    uri: Uri,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response<Body> {
    let Ok(upgrade) = upgrade else { return asset::text(StatusCode::BAD_REQUEST, "Only websockets here.\n") };
    if let Err(reason) = Guard::check_origin(text_of(&headers, &HOST), text_of(&headers, &ORIGIN)) {
        return asset::text(StatusCode::FORBIDDEN, &reason);
    }
    let Ok(place) = desk.places.try_acquire_owned() else {
        return asset::text(StatusCode::SERVICE_UNAVAILABLE, "Too many pages look already.\n");
    };
    let guest = Guest { rights: desk.guard.has_rights(uri.query()) };
    let upgrade = upgrade.max_message_size(HEARD_MAX).max_frame_size(HEARD_MAX);
    upgrade.on_upgrade(move |socket| socket::serve(socket, desk.shown, guest, place))
}

/// A header, if it is a text. One that is there and is none is as good as a wrong one.
fn text_of<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    headers.get(name).map(|value| value.to_str().unwrap_or("?"))
}
