//! What the viewers of a mission are to get: one list of events that only grows, and who reads it.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The most viewers at a time.
pub(super) const MOST_VIEWERS: usize = 8;

/// The most connections at a time: a browser needs some beside the stream, for a short while.
const MOST_CONNECTIONS: usize = 4 * MOST_VIEWERS;

/// How long the end of a mission waits for its viewers.
const PATIENCE: Duration = Duration::from_secs(10);

/// How long a page may take until it asks for the scenes.
const LOADING: Duration = Duration::from_secs(1);

/// A mission's events, shared by the mission and its viewers.
#[derive(Debug, Default)]
pub(super) struct Feed {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// Tells this mission from others at the address.
    token: String,
    page: Arc<str>,
    /// Events as they are sent.
    events: Vec<Arc<str>>,
    /// Whether there are no more.
    is_over: bool,
    /// What is said last, and how often something was said.
    notice: Option<Arc<str>>,
    notices: usize,
    connections: usize,
    viewers: usize,
    /// Until when a page that was served may ask for the scenes.
    loading: Option<Instant>,
}

/// How far a viewer has read.
#[derive(Debug, Default)]
pub(super) struct Place {
    token: String,
    next: usize,
    notices: usize,
}

/// What is new for a viewer.
pub(super) struct News {
    pub(super) events: Vec<Arc<str>>,
    /// Whether nothing follows.
    pub(super) is_last: bool,
}

/// A connection that counts until it is dropped.
pub(super) struct Seat {
    feed: Arc<Feed>,
    is_viewer: bool,
}

impl Feed {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state, and wakes all who wait for a change.
    fn change<T>(&self, change: impl FnOnce(&mut State) -> T) -> T {
        let changed = change(&mut self.state());
        self.changed.notify_all();
        changed
    }

    /// A mission begins.
    pub(super) fn begin(&self, token: &str, page: String) {
        self.change(|it| {
            (it.token, it.page, it.events) = (token.to_owned(), page.into(), Vec::new());
        });
    }

    /// Appends an event. None of its lines contains a line break.
    pub(super) fn push(&self, kind: &str, lines: &[&str]) {
        let data = lines.join("\ndata: ");
        self.change(|it| {
            let (token, number) = (&it.token, it.events.len());
            let event = format!("id: {token}.{number}\nevent: {kind}\ndata: {data}\n\n");
            it.events.push(event.into());
        });
    }

    /// Replaces what is said beside the events.
    pub(super) fn say(&self, what: &str) {
        let line = what.split_whitespace().collect::<Vec<_>>().join(" ");
        self.change(|it| {
            it.notice = Some(format!("event: notice\ndata: {line}\n\n").into());
            it.notices += 1;
        });
    }

    /// There are no more events.
    pub(super) fn close(&self) {
        self.change(|it| it.is_over = true);
    }

    /// The page of the mission. It is expected to ask for the scenes soon.
    pub(super) fn page(&self) -> Arc<str> {
        self.change(|it| {
            it.loading = Some(Instant::now() + LOADING);
            it.page.clone()
        })
    }

    /// A place behind the event of this id; before the first if it is of another mission.
    pub(super) fn place(&self, last: Option<&str>) -> Place {
        let state = self.state();
        let of_this = last.and_then(|it| it.strip_prefix(&*state.token)?.strip_prefix('.'));
        let last = of_this.and_then(|number| number.parse::<usize>().ok());
        let next = last.map_or(0, |number| number.saturating_add(1).min(state.events.len()));
        Place { token: state.token.clone(), next, notices: 0 }
    }

    /// What is new at a place, which moves behind it. Waits for it so long at most.
    pub(super) fn news(&self, place: &mut Place, patience: Duration) -> News {
        let is_old = |it: &mut State| {
            let has_read = it.token == place.token && it.events.len() == place.next;
            has_read && it.notices == place.notices && !it.is_over
        };
        let waited = self.changed.wait_timeout_while(self.state(), patience, is_old);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if state.token != place.token {
            *place = Place { token: state.token.clone(), next: 0, notices: place.notices };
        }
        let is_said = state.notices != place.notices;
        let notice = state.notice.iter().filter(|_| is_said);
        let events = notice.chain(&state.events[place.next..]).cloned().collect();
        (place.next, place.notices) = (state.events.len(), state.notices);
        News { events, is_last: state.is_over }
    }

    /// Waits until all viewers have got all of it, or have left.
    pub(super) fn settle(&self) {
        let until = Instant::now() + PATIENCE;
        let mut state = self.state();
        loop {
            let now = Instant::now();
            let loading = state.loading.filter(|it| *it > now);
            if now >= until || (state.connections == 0 && loading.is_none()) {
                return;
            }
            let most = if state.connections == 0 { loading.unwrap_or(until) } else { until };
            let waited = self.changed.wait_timeout(state, most.min(until) - now);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl Seat {
    /// A seat for a connection, if one is free.
    pub(super) fn take(feed: &Arc<Feed>) -> Option<Self> {
        let has_room = |it: &mut State| {
            let has_room = it.connections < MOST_CONNECTIONS;
            it.connections += usize::from(has_room);
            has_room
        };
        feed.change(has_room).then(|| Self { feed: feed.clone(), is_viewer: false })
    }

    /// Whether another viewer may come.
    pub(super) fn has_room(&self) -> bool {
        self.feed.state().viewers < MOST_VIEWERS
    }

    /// Makes it a viewer's. Returns whether one was free.
    pub(super) fn view(&mut self) -> bool {
        self.is_viewer = self.feed.change(|it| {
            let has_room = it.viewers < MOST_VIEWERS;
            it.viewers += usize::from(has_room);
            it.loading = None;
            has_room
        });
        self.is_viewer
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.feed.change(|it| {
            it.connections -= 1;
            it.viewers -= usize::from(self.is_viewer);
        });
    }
}
