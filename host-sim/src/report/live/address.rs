//! Where a live page is served.

use std::fmt::{self, Display};
use std::io::ErrorKind;
use std::net::{Ipv6Addr, TcpListener};
use std::str::FromStr;

use anyhow::{Context as _, Error, Result, anyhow};

/// The host if none is named: this machine alone reaches it.
const HERE: &str = "127.0.0.1";

/// Where a page is served if nobody names a place.
pub(crate) const USUAL: &str = "127.0.0.1:8043";

/// A host and a port, 0 for any that is free.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// A name or a number, without brackets.
    pub(super) host: String,
    /// The port.
    pub(super) port: u16,
}

impl FromStr for Address {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let expected = || anyhow!("expected a port or HOST:PORT, as {USUAL} or [::1]:8043");
        let (host, port) = text.rsplit_once(':').unwrap_or((HERE, text));
        let port = port.parse().ok().with_context(expected)?;
        let in_brackets = host.strip_prefix('[').and_then(|it| it.strip_suffix(']'));
        let is_host = match in_brackets {
            Some(number) => number.parse::<Ipv6Addr>().is_ok(),
            None => {
                !host.is_empty() && host.chars().all(|it| it.is_alphanumeric() || "-.".contains(it))
            }
        };
        let host = in_brackets.unwrap_or(host).to_owned();
        is_host.then_some(Self { host, port }).with_context(expected)
    }
}

impl Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { host, port } = self;
        if host.contains(':') { write!(f, "[{host}]:{port}") } else { write!(f, "{host}:{port}") }
    }
}

impl Address {
    /// Begins to listen there.
    ///
    /// # Errors
    /// When the address is in use, or not this machine's.
    pub(super) fn listen(&self) -> Result<TcpListener> {
        TcpListener::bind((&*self.host, self.port)).map_err(|why| match why.kind() {
            ErrorKind::AddrInUse => anyhow!(
                "--live: found {self} in use, expected a free port, as --live={} finds",
                Self { port: 0, ..self.clone() }
            ),
            ErrorKind::PermissionDenied => {
                anyhow!("--live: found {self}, which needs more rights, expected a port above 1023")
            }
            _ => anyhow!("--live: found {self}, expected an address of this machine, as {USUAL}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_a_port_or_a_host_and_a_port() {
        for sound in ["127.0.0.1:8043", "localhost:0", "[::1]:80", "boat-2.local:9000"] {
            assert_eq!(sound.parse::<Address>().unwrap().to_string(), sound);
        }
        assert_eq!("8043".parse::<Address>().unwrap().to_string(), USUAL);
        for wrong in [
            "",
            "nonsense",
            "70000",
            ":8043",
            "127.0.0.1",
            "::1",
            "[::1]",
            "host:",
            "host:70000",
            "::1:80",
            "[x]:80",
            "http://a:80",
            "a b:80",
        ] {
            assert!(wrong.parse::<Address>().is_err(), "{wrong}");
        }
    }
}
