//! Who may see the page.

use std::{net::SocketAddr, sync::Arc};

use anyhow::{Result, anyhow, ensure};
use axum::{
    extract::{Request, State},
    http::{
        HeaderMap, HeaderValue, Method, StatusCode,
        header::{CONTENT_TYPE, COOKIE, HOST, SET_COOKIE},
    },
    middleware::Next,
    response::{IntoResponse, Response},
};

/// The name of the cookie.
const NAME: &str = "foxhunt";
/// The fewest characters of a token.
const SHORTEST: usize = 8;

/// What a browser must know.
pub struct Guard {
    /// None where only this machine can ask.
    token: Option<String>,
}

impl Guard {
    /// For a page at an address: everywhere but on this machine a token is needed, and made up if there is none.
    ///
    /// # Errors
    /// If the token is too short or cannot stand in an address.
    pub fn new(address: SocketAddr, token: Option<String>) -> Result<Self> {
        if let Some(token) = &token {
            ensure!(
                token.len() >= SHORTEST,
                "web: a token has {SHORTEST} characters at the least"
            );
            let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.~".contains(c);
            ensure!(
                token.chars().all(is_plain),
                "web: a token has letters, digits and -_.~ only"
            );
        }
        let token = match token {
            None if !address.ip().is_loopback() => Some(made_up()?),
            token => token,
        };
        Ok(Self { token })
    }

    /// The token.
    pub fn token(&self) -> Option<&str> {
        self.token.as_deref()
    }
}

fn made_up() -> Result<String> {
    let mut bytes = [0; 16];
    rustls::crypto::ring::default_provider()
        .secure_random
        .fill(&mut bytes)
        .map_err(|_| anyhow!("the system has no random numbers for a token"))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(a: &str, b: &str) -> bool {
    let differs = a
        .bytes()
        .zip(b.bytes())
        .fold(0, |all, (a, b)| all | (a ^ b));
    a.len() == b.len() && differs == 0
}

fn cookie(headers: &HeaderMap) -> Option<&str> {
    let cookies = headers.get_all(COOKIE).iter();
    let mut pairs = cookies
        .filter_map(|header| header.to_str().ok())
        .flat_map(|header| header.split(';'));
    pairs.find_map(|pair| {
        let (name, value) = pair.trim().split_once('=')?;
        (name == NAME).then_some(value)
    })
}

/// Lets those pass who may.
pub async fn check(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let refused = |status: StatusCode, text: &'static str| {
        (status, [(CONTENT_TYPE, "text/plain")], text).into_response()
    };
    let headers = request.headers();
    // A page of another site cannot send this type without asking, which is never allowed.
    let is_json = headers
        .get(CONTENT_TYPE)
        .is_some_and(|kind| kind.as_bytes().starts_with(b"application/json"));
    match *request.method() {
        Method::GET | Method::HEAD => {}
        Method::POST if is_json => {}
        Method::POST => return refused(StatusCode::UNSUPPORTED_MEDIA_TYPE, "post JSON\n"),
        _ => return refused(StatusCode::METHOD_NOT_ALLOWED, "only GET and POST\n"),
    }
    let Some(token) = guard.token() else {
        // A name that leads here from another site is not this machine's.
        return if headers.get(HOST).is_none_or(is_this_machine) {
            next.run(request).await
        } else {
            refused(StatusCode::FORBIDDEN, "ask for localhost\n")
        };
    };
    let query = request.uri().query().unwrap_or_default();
    let stated = query
        .split('&')
        .find_map(|pair| pair.strip_prefix("token="));
    if stated.is_some_and(|stated| same(stated, token)) {
        let mut response = next.run(request).await;
        let cookie = format!("{NAME}={token}; HttpOnly; SameSite=Strict; Path=/");
        if let Ok(cookie) = HeaderValue::from_str(&cookie) {
            response.headers_mut().append(SET_COOKIE, cookie);
        }
        return response;
    }
    if cookie(headers).is_some_and(|stated| same(stated, token)) {
        return next.run(request).await;
    }
    refused(
        StatusCode::UNAUTHORIZED,
        "this page needs its token: open it as the program has printed it\n",
    )
}

fn is_this_machine(host: &HeaderValue) -> bool {
    let host = host.to_str().unwrap_or_default();
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|byte| byte.is_ascii_digit()) => name,
        _ => host,
    };
    let is_loopback = |address: std::net::Ipv4Addr| address.is_loopback();
    matches!(name, "localhost" | "[::1]") || name.parse().is_ok_and(is_loopback)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_needed_beyond_this_machine() {
        let here: SocketAddr = "127.0.0.1:1".parse().unwrap();
        let there: SocketAddr = "0.0.0.0:1".parse().unwrap();
        assert_eq!(Guard::new(here, None).unwrap().token(), None);
        let made_up = Guard::new(there, None).unwrap();
        assert_eq!(made_up.token().unwrap().len(), 32);
        assert_ne!(made_up.token(), Guard::new(there, None).unwrap().token());
        for wrong in ["short", "with blanks in it", "semicolon;semicolon"] {
            assert!(Guard::new(there, Some(wrong.into())).is_err());
        }
        assert!(same("abc", "abc") && !same("abc", "abd") && !same("abc", "ab"));
    }

    #[test]
    fn names_of_this_machine() {
        for (host, is) in [
            ("localhost:8073", true),
            ("127.0.0.1", true),
            ("[::1]:8073", true),
            ("example.org:8073", false),
            ("127.example.org", false),
        ] {
            let found = is_this_machine(&HeaderValue::from_str(host).unwrap());
            assert_eq!(found, is, "{host}");
        }
    }
}
