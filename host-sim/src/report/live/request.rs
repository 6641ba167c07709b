//! A request of a browser: which part of it counts, and why it is refused.

use std::net::IpAddr;

/// A request that can be answered.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Request {
    /// What is asked for.
    pub(super) path: String,
    /// The id of the last event that the viewer has got.
    pub(super) last: Option<String>,
}

/// Why a request is refused, with the status of the answer.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Refusal(pub(super) &'static str, pub(super) &'static str);

const MALFORMED: Refusal = Refusal("400 Bad Request", "found no request of HTTP/1.1");

/// Reads the head of a request. `is_own` says whether a host is one under which the page is served.
///
/// # Errors
/// Why it is refused.
pub(super) fn parse(head: &str, is_own: impl Fn(&str) -> bool) -> Result<Request, Refusal> {
    let mut lines = head.split("\r\n");
    let mut words = lines.next().unwrap_or_default().split(' ');
    let (Some(method), Some(target), Some(version), None) =
        (words.next(), words.next(), words.next(), words.next())
    else {
        return Err(MALFORMED);
    };
    if !version.starts_with("HTTP/1.") {
        return Err(MALFORMED);
    }
    let fields: Vec<_> = lines.filter_map(|it| it.split_once(':')).collect();
    let all = |name: &str| {
        let of_name = fields.iter().filter(|(key, _)| key.eq_ignore_ascii_case(name));
        of_name.map(|(_, value)| value.trim()).collect::<Vec<_>>()
    };
    // A page of somebody else's may make its own name lead here; the browser then says that name.
    if !matches!(all("host")[..], [host] if is_own(host)) {
        let why = "found a Host that is not served here, expected that of the link";
        return Err(Refusal("403 Forbidden", why));
    }
    if method != "GET" {
        return Err(Refusal(
            "405 Method Not Allowed",
            "expected GET: a mission can only be watched",
        ));
    }
    let path = target.split('?').next().unwrap_or_default().to_owned();
    let last = all("last-event-id").first().map(|it| (*it).to_owned());
    Ok(Request { path, last })
}

/// Whether a `Host` is one of ours: this machine's own names, and the one that was given. Where others may connect, it may
/// be any number, as a number needs nobody to say where it leads.
pub(super) fn is_own(host: &str, given: &str, is_open: bool) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => host.split(':').next().unwrap_or_default(),
    };
    let is_given = name.eq_ignore_ascii_case("localhost") || name.eq_ignore_ascii_case(given);
    is_given || name.parse::<IpAddr>().is_ok_and(|it| is_open || it.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foreign_host_is_refused() {
        for own in ["127.0.0.1:8043", "localhost", "LOCALHOST:1", "[::1]:8043", "boat.local:80"] {
            assert!(is_own(own, "boat.local", false), "{own}");
        }
        for foreign in [
            "evil.example",
            "localhost.evil.example",
            "192.0.2.7:8043",
            "",
            "127.0.0.1.evil.example",
            "[::1.evil",
        ] {
            assert!(!is_own(foreign, "boat.local", false), "{foreign}");
        }
        assert!(is_own("192.0.2.7:8043", "0.0.0.0", true));
        assert!(!is_own("evil.example", "0.0.0.0", true));
    }

    #[test]
    fn what_counts_of_a_request() {
        let of = |head: &str| parse(head, |host| host == "here");
        let request = Request { path: "/scenes".into(), last: Some("a.3".into()) };
        let head = "GET /scenes?x HTTP/1.1\r\nHost: here\r\nlast-event-id: a.3\r\n\r\n";
        assert_eq!(of(head), Ok(request));
        let status = |head: &str| of(head).map_or_else(|it| it.0, |_| "200 OK");
        assert_eq!(status("POST / HTTP/1.1\r\nHost: here\r\n\r\n"), "405 Method Not Allowed");
        assert_eq!(status("GET / HTTP/1.1\r\nHost: there\r\n\r\n"), "403 Forbidden");
        assert_eq!(status("GET / HTTP/1.1\r\n\r\n"), "403 Forbidden");
        assert_eq!(status("GET / HTTP/1.1\r\nHost: here\r\nHost: here\r\n\r\n"), "403 Forbidden");
        for head in ["", "GET /\r\n", "GET / HTTP/2\r\n", "GET / x HTTP/1.1\r\n"] {
            assert_eq!(status(head), "400 Bad Request");
        }
    }
}
