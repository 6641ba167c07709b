//! The server of a live page: a thread that accepts connections, and one for each of them.

use std::io::{self, Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};

use crate::report::live::address::Address;
use crate::report::live::feed::{Feed, Seat};
use crate::report::live::request::{self, Refusal, Request};

/// How long a request may take, and a part of an answer. A viewer that takes longer is lost.
const PATIENCE: Duration = Duration::from_secs(5);

/// The most bytes of a request.
const MOST: usize = 8 * 1024;

/// After so long without news a viewer gets an empty comment: thus one that has left is noticed.
const BEAT: Duration = Duration::from_secs(1);

const FULL: Refusal = Refusal(
    "503 Service Unavailable",
    "found eight viewers already, expected fewer: try again later",
);

/// What serves a live page.
#[derive(Debug)]
pub(super) struct Server {
    feed: Arc<Feed>,
    /// Where, with the port that was found.
    address: Address,
}

impl Server {
    /// Serves from now on, until the program ends.
    ///
    /// # Errors
    /// As [`Address::listen`].
    pub(super) fn open(address: &Address) -> Result<Self> {
        let listener = address.listen()?;
        let local = listener.local_addr().context("--live")?;
        let feed = Arc::new(Feed::default());
        let server = Self { feed, address: Address { port: local.port(), ..address.clone() } };
        let (feed, host) = (server.feed.clone(), address.host.clone());
        thread::spawn(move || accept(&listener, local, &feed, &host));
        Ok(server)
    }

    pub(super) fn feed(&self) -> &Feed {
        &self.feed
    }

    /// Where the page is.
    pub(super) fn link(&self) -> String {
        format!("http://{}/", self.address)
    }
}

fn accept(listener: &TcpListener, local: SocketAddr, feed: &Arc<Feed>, host: &str) {
    for connection in listener.incoming() {
        let (Ok(connection), Some(seat)) = (connection, Seat::take(feed)) else {
            // There may be no more connections for now, here or on this machine.
            thread::sleep(Duration::from_millis(10));
            continue;
        };
        let host = host.to_owned();
        let feed = feed.clone();
        let serve = move || {
            // A viewer may leave at any time.
            let _ = serve(connection, seat, &feed, |it| {
                request::is_own(it, &host, !local.ip().is_loopback())
            });
        };
        // Without a thread the connection is closed.
        let _ = thread::Builder::new().spawn(serve);
    }
}

fn serve(
    mut to: TcpStream,
    mut seat: Seat,
    feed: &Feed,
    is_own: impl Fn(&str) -> bool,
) -> io::Result<()> {
    to.set_nodelay(true)?;
    to.set_read_timeout(Some(PATIENCE))?;
    to.set_write_timeout(Some(PATIENCE))?;
    let head = head(&mut to)?;
    match request::parse(&head, is_own) {
        Ok(Request { path, .. }) if path == "/" && seat.has_room() => {
            answer(&mut to, "200 OK", "text/html", &feed.page())?;
        }
        Ok(Request { path, last }) if path == "/scenes" && seat.view() => {
            stream(&mut to, feed, last.as_deref())?;
        }
        Ok(Request { path, .. }) if path == "/" || path == "/scenes" => refuse(&mut to, &FULL)?,
        Ok(_) => refuse(&mut to, &Refusal("404 Not Found", "expected / or /scenes"))?,
        Err(refusal) => refuse(&mut to, &refusal)?,
    }
    // What is unread when a connection closes would take the answer with it.
    to.shutdown(Shutdown::Write)?;
    let until = Instant::now() + PATIENCE;
    while Instant::now() < until && to.read(&mut [0; 1024])? > 0 {}
    Ok(())
}

/// The head of a request. It ends with an empty line.
fn head(from: &mut TcpStream) -> io::Result<String> {
    let until = Instant::now() + PATIENCE;
    let mut bytes = Vec::new();
    while !bytes.ends_with(b"\r\n\r\n") && bytes.len() < MOST && Instant::now() < until {
        let mut part = [0; 1024];
        match from.read(&mut part)? {
            0 => break,
            read => bytes.extend(&part[..read]),
        }
        if let Some(end) = bytes.windows(4).position(|it| it == b"\r\n\r\n") {
            bytes.truncate(end + 4);
        }
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// The stream of a mission's events, from behind the last one that the viewer has.
fn stream(to: &mut TcpStream, feed: &Feed, last: Option<&str>) -> io::Result<()> {
    to.write_all(begin("200 OK", "text/event-stream", "").as_bytes())?;
    // After a second a viewer whose connection broke comes again.
    to.write_all(b"retry: 1000\n\n")?;
    let mut place = feed.place(last);
    loop {
        let news = feed.news(&mut place, BEAT);
        for event in &news.events {
            to.write_all(event.as_bytes())?;
        }
        if news.is_last {
            return Ok(());
        }
        if news.events.is_empty() {
            to.write_all(b":\n\n")?;
        }
    }
}

fn refuse(to: &mut TcpStream, Refusal(status, why): &Refusal) -> io::Result<()> {
    answer(to, status, "text/plain", &format!("{why}\n"))
}

fn answer(to: &mut TcpStream, status: &str, kind: &str, text: &str) -> io::Result<()> {
    let length = format!("Content-Length: {}\r\n", text.len());
    to.write_all(begin(status, kind, &length).as_bytes())?;
    to.write_all(text.as_bytes())
}

/// The head of an answer.
fn begin(status: &str, kind: &str, more: &str) -> String {
    let allow = if status.starts_with("405") { "Allow: GET\r\n" } else { "" };
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Connection: close\r\n{allow}{more}\r\n"
    )
}
