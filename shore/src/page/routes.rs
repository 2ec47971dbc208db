//! The routes of the web server: which request gets which response.

use super::access::AccessControl;
use super::asset;
use super::connection::{Connection, Listener};
use super::socket::{self, RECEIVED_MAX, Shown};
use super::view::Access;
use axum::Router;
use axum::body::Body;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::{Request, State};
use axum::http::header::{HOST, HeaderMap, HeaderName, ORIGIN};
use axum::http::{Method, Response, StatusCode, Uri};
use axum::middleware::{self, Next};
use axum::routing::get;
use hyper_util::rt::{TokioExecutor, TokioIo, TokioTimer};
use hyper_util::server::conn::auto::Builder;
use hyper_util::service::TowerToHyperService;
use std::future::Future;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// The most pages at a time.
const PAGES_MAX: usize = 64;
/// Connections reserved for pages with the token, so that observers cannot shut out operators.
const OPERATORS_MAX: usize = 8;
/// How long a request may take to arrive, counted from the connection's beginning or the response before.
const REQUEST: Duration = Duration::from_secs(10);

/// What all requests have in common.
#[derive(Clone)]
struct AppState {
    guard: Arc<AccessControl>,
    shown: Shown,
    places: Arc<Semaphore>,
    masters: Arc<Semaphore>,
}

impl AppState {
    /// A permit for a page with this query, and what it may do.
    fn open_viewer(&self, query: Option<&str>) -> Option<(OwnedSemaphorePermit, Access)> {
        let access = Access { rights: self.guard.has_rights(query) };
        let free = |places: &Arc<Semaphore>| Arc::clone(places).try_acquire_owned().ok();
        let own = if access.rights && self.guard.has_token() { free(&self.masters) } else { None };
        Some((own.or_else(|| free(&self.places))?, access))
    }
}

/// Answers until the end.
pub(super) async fn serve(
    listener: std::net::TcpListener,
    guard: AccessControl,
    shown: Shown,
    end: impl Future<Output = ()>,
) -> std::io::Result<()> {
    let quay = Listener::new(tokio::net::TcpListener::from_std(listener)?);
    let places = |places| Arc::new(Semaphore::new(places));
    let app = AppState { guard: Arc::new(guard), shown, places: places(PAGES_MAX), masters: places(OPERATORS_MAX) };
    let site = Router::new()
        .route("/ws", get(upgrade))
        .fallback(file)
        .layer(middleware::from_fn_with_state(app.clone(), check))
        .with_state(app);
    let answer_all = async {
        loop {
            let line = quay.accept().await;
            // An error ends the connection of one browser only.
            let answer = answer(line, site.clone());
            tokio::spawn(async { drop(answer.await) });
        }
    };
    tokio::select! {
        () = answer_all => {}
        () = end => {}
    }
    Ok(())
}

/// Serves one connection. `axum::serve` would wait for ever for a request that never ends.
async fn answer(line: Connection, site: Router) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let mut server = Builder::new(TokioExecutor::new()).http1_only();
    server.http1().timer(TokioTimer::new()).header_read_timeout(REQUEST);
    server.serve_connection_with_upgrades(TokioIo::new(line), TowerToHyperService::new(site)).await
}

/// Lets nothing through that is not meant for this server, and seals what it answers.
async fn check(State(app): State<AppState>, request: Request, next: Next) -> Response<Body> {
    let mut response = match app.guard.check_host(text_of(request.headers(), &HOST)) {
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
    State(app): State<AppState>,
    headers: HeaderMap,
    uri: Uri,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response<Body> {
    let Ok(upgrade) = upgrade else { return asset::text(StatusCode::BAD_REQUEST, "Only websockets here.\n") };
    if let Err(reason) = AccessControl::check_origin(text_of(&headers, &HOST), text_of(&headers, &ORIGIN)) {
        return asset::text(StatusCode::FORBIDDEN, &reason);
    }
    let Some((place, access)) = app.open_viewer(uri.query()) else {
        return asset::text(StatusCode::SERVICE_UNAVAILABLE, "Too many pages look already.\n");
    };
    let upgrade = upgrade.max_message_size(RECEIVED_MAX).max_frame_size(RECEIVED_MAX);
    upgrade.on_upgrade(move |socket| socket::serve(socket, app.shown, access, place))
}

/// A header, if it is a text. One that is there and is none is as good as a wrong one.
fn text_of<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    headers.get(name).map(|value| value.to_str().unwrap_or("?"))
}
