//! The files of the page, built in from the folder `web`.

use axum::body::Body;
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Response, StatusCode};
use include_dir::{Dir, include_dir};

static WEB: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/web");

/// Headers of every response. The page uses only its own files and its own server. It cannot be
/// framed, because a page that frames it could redirect clicks to it.
const HEADERS: [(HeaderName, &str); 5] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'self'; connect-src 'self'; img-src 'self' data:; object-src 'none'; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-cache"),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    ),
];

pub(super) fn answer(path: &str) -> Response<Body> {
    let name = match path.trim_start_matches('/') {
        "" => "index.html",
        name => name,
    };
    match WEB.get_file(name) {
        Some(file) => own(name, Body::from(file.contents())),
        None => text(StatusCode::NOT_FOUND, "No such file.\n"),
    }
}

/// A response with the given file.
pub(super) fn own(name: &str, contents: Body) -> Response<Body> {
    plain(StatusCode::OK, kind(name), contents)
}

pub(super) fn elsewhere(path: &'static str) -> Response<Body> {
    let mut response = text(StatusCode::TEMPORARY_REDIRECT, "Redirecting.\n");
    response
        .headers_mut()
        .insert(header::LOCATION, HeaderValue::from_static(path));
    response
}

pub(super) fn text(status: StatusCode, words: &str) -> Response<Body> {
    plain(
        status,
        "text/plain; charset=utf-8",
        Body::from(words.to_owned()),
    )
}

/// Adds the headers of every response.
pub(super) fn add_security_headers(headers: &mut HeaderMap) {
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
}

pub(super) fn plain(status: StatusCode, kind: &'static str, body: Body) -> Response<Body> {
    let mut response = Response::new(body);
    *response.status_mut() = status;
    response
        .headers_mut()
        .insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    response
}

fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("json") => "application/json",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_page_asks_for_is_served() {
        let page = WEB
            .get_file("index.html")
            .and_then(include_dir::File::contents_utf8)
            .expect("a page");
        let words = ["href=\"", "src=\""]
            .iter()
            .flat_map(|word| page.split(word).skip(1));
        let asked: Vec<&str> = words.filter_map(|rest| rest.split('"').next()).collect();
        assert!(asked.len() >= 3, "{asked:?}");
        for path in asked {
            assert_eq!(answer(path).status(), StatusCode::OK, "{path}");
        }
        assert_eq!(kind("a.b.js"), "text/javascript; charset=utf-8");
    }
}
