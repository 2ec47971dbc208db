//! The routes of the web server.

use super::access::{AccessControl, value};
use super::asset;
use super::background::Background;
use super::report::{LateReport, Report, Shown};
use super::socket::{self, RECEIVED_MAX};
use super::view::Access;
use axum::Router;
use axum::body::Body;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::{Extension, Request, State};
use axum::http::header::{HOST, HeaderMap, HeaderName, ORIGIN};
use axum::http::{Method, Response, StatusCode, Uri};
use axum::middleware::{self, Next};
use axum::routing::get;
use bus::{Connections, Slot};
use hyper_util::rt::{TokioExecutor, TokioIo, TokioTimer};
use hyper_util::server::conn::auto::Builder;
use hyper_util::service::TowerToHyperService;
use std::future::Future;
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio::time::sleep;
use tokio_io_timeout::TimeoutStream;

/// Maximum number of pages without the operator's token.
const PAGES_MAX: usize = 64;
/// Maximum number of operators' pages; other pages cannot take their slots.
const OPERATORS_MAX: usize = 8;
/// Maximum number of connections that are not WebSockets yet.
const CONNECTIONS_MAX: usize = 192;
/// Time without received bytes after which a connection is closed. WebSockets are pinged more
/// often.
const SILENCE: Duration = Duration::from_secs(60);
/// Time after which a connection that accepts no bytes is closed.
const DEAF: Duration = Duration::from_secs(20);
/// Wait after a failed accept.
const AGAIN: Duration = Duration::from_millis(200);
/// Timeout of a request, from the start of the connection or the previous response.
const REQUEST: Duration = Duration::from_secs(10);

/// The state shared by all requests.
#[derive(Clone)]
struct AppState {
    access_control: Arc<AccessControl>,
    shown: Shown,
    report: LateReport,
    background: Option<Arc<Background>>,
    viewers: Connections,
    operators: Connections,
}

impl AppState {
    /// Calls `get` on the report in a thread that may block. `None` without a report.
    async fn of_report<T: Send + 'static>(
        &self,
        get: impl FnOnce(&dyn Report) -> T + Send + 'static,
    ) -> Option<T> {
        let report = Arc::clone(self.report.get()?);
        // A thread that panicked has already reported it.
        tokio::task::spawn_blocking(move || get(&*report))
            .await
            .ok()
    }

    /// A slot for a page with this address and query, and its access.
    fn admit(&self, from: IpAddr, query: Option<&str>) -> (Room, Access) {
        let access = self.access_control.access(query);
        (
            admit(
                if access == Access::Operate {
                    &self.operators
                } else {
                    &self.viewers
                },
                from,
            ),
            access,
        )
    }
}

/// A slot for a connection, and a signal that a different connection needs it.
pub(super) type Room = (Slot, oneshot::Receiver<()>);

fn admit(connections: &Connections, from: IpAddr) -> Room {
    let (close, closed) = oneshot::channel();
    // The connection may have ended already.
    (
        connections.admit(from, move || close.send(()).unwrap_or_default()),
        closed,
    )
}

pub(super) async fn serve(
    listener: std::net::TcpListener,
    access_control: AccessControl,
    (shown, report, background): (Shown, LateReport, Option<Background>),
    end: impl Future<Output = ()>,
) -> std::io::Result<()> {
    let listener = TcpListener::from_std(listener)?;
    let app = AppState {
        access_control: Arc::new(access_control),
        shown,
        report,
        background: background.map(Arc::new),
        viewers: Connections::new(PAGES_MAX),
        // Operators have separate slots: an E-stop must not queue behind observers. With too many
        // pages, none is refused: the longest-idle page is displaced and reconnects after half a
        // minute, so that one page too many does not make all of them reconnect.
        operators: Connections::new(OPERATORS_MAX),
    };
    let site = Router::new()
        .route("/ws", get(upgrade))
        .fallback(file)
        .layer(middleware::from_fn_with_state(app.clone(), check))
        .with_state(app);
    let connections = Connections::new(CONNECTIONS_MAX);
    let accept_all = async {
        loop {
            let Ok((stream, from)) = listener.accept().await else {
                sleep(AGAIN).await;
                continue;
            };
            let (slot, closed) = admit(&connections, from.ip());
            let served = serve_connection(stream, site.clone(), slot, from.ip());
            tokio::spawn(async move {
                tokio::select! {
                    // An error ends only the connection of one browser.
                    ended = served => drop(ended),
                    // A different connection needs the slot; an error means that the slot is free
                    // again.
                    Ok(()) = closed => {}
                }
            });
        }
    };
    tokio::select! {
        () = accept_all => {}
        () = end => {}
    }
    Ok(())
}

/// Serves one connection. `axum::serve` would wait forever for an incomplete request.
async fn serve_connection(
    stream: TcpStream,
    site: Router,
    slot: Slot,
    from: IpAddr,
) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    // A frame is one small write; buffering would only delay it.
    drop(stream.set_nodelay(true));
    let mut stream = TimeoutStream::new(stream);
    stream.set_read_timeout(Some(SILENCE));
    stream.set_write_timeout(Some(DEAF));
    let slot = Arc::new(slot);
    let site = site.layer(middleware::from_fn(
        move |mut request: Request, next: Next| {
            slot.touch();
            request.extensions_mut().insert(from);
            next.run(request)
        },
    ));
    let mut server = Builder::new(TokioExecutor::new()).http1_only();
    server
        .http1()
        .timer(TokioTimer::new())
        .header_read_timeout(REQUEST);
    server
        .serve_connection_with_upgrades(
            TokioIo::new(Box::pin(stream)),
            TowerToHyperService::new(site),
        )
        .await
}

/// Rejects requests for other servers, and adds security headers to responses.
async fn check(State(app): State<AppState>, request: Request, next: Next) -> Response<Body> {
    let mut response = match app
        .access_control
        .check_host(text_of(request.headers(), &HOST))
    {
        Ok(()) => next.run(request).await,
        Err(reason) => asset::text(StatusCode::FORBIDDEN, &reason),
    };
    asset::add_security_headers(response.headers_mut());
    response
}

async fn file(State(app): State<AppState>, method: Method, uri: Uri) -> Response<Body> {
    if method != Method::GET && method != Method::HEAD {
        return asset::text(
            StatusCode::METHOD_NOT_ALLOWED,
            "Only GET and HEAD are allowed.\n",
        );
    }
    if let Some(response) = background_file(app.background.as_deref(), uri.path()) {
        return response;
    }
    let path = uri.path().to_owned();
    let is_root = path == "/" && value(uri.query(), "game").is_none();
    if is_root && app.report.get().is_some() {
        return asset::elsewhere("/report.html");
    }
    match app
        .of_report(move |report| report.file(&path))
        .await
        .flatten()
    {
        Some(contents) => asset::own(uri.path(), Body::from(contents)),
        None => asset::answer(uri.path()),
    }
}

/// The background beneath the field; `null` without one.
fn background_file(background: Option<&Background>, path: &str) -> Option<Response<Body>> {
    let image = background.and_then(|background| background.image.as_ref());
    match path {
        "/background.json" => {
            let json = background.map_or("null", |background| &background.json);
            Some(asset::plain(
                StatusCode::OK,
                "application/json",
                Body::from(json.to_owned()),
            ))
        }
        "/background-image" => {
            image.map(|(kind, bytes)| asset::plain(StatusCode::OK, kind, Body::from(bytes.clone())))
        }
        _ => None,
    }
}

async fn upgrade(
    State(app): State<AppState>,
    Extension(from): Extension<IpAddr>,
    headers: HeaderMap,
    uri: Uri,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response<Body> {
    let Ok(upgrade) = upgrade else {
        return asset::text(
            StatusCode::BAD_REQUEST,
            "Only WebSocket connections are allowed.\n",
        );
    };
    if let Err(reason) =
        AccessControl::check_origin(text_of(&headers, &HOST), text_of(&headers, &ORIGIN))
    {
        return asset::text(StatusCode::FORBIDDEN, &reason);
    }
    let game = value(uri.query(), "game").map(|name| String::from_utf8_lossy(&name).into_owned());
    let game = match game {
        Some(name) => app.of_report(move |report| report.game(&name)).await,
        None => None,
    };
    let (room, access) = app.admit(from, uri.query());
    let upgrade = upgrade
        .max_message_size(RECEIVED_MAX)
        .max_frame_size(RECEIVED_MAX);
    upgrade.on_upgrade(move |socket| socket::serve(socket, game.unwrap_or(app.shown), access, room))
}

/// A header as a string. A header that is not a string counts as invalid.
fn text_of<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    headers.get(name).map(|value| value.to_str().unwrap_or("?"))
}
