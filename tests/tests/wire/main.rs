//! What goes over the link to a chip: messages, frames, delivery, restarts.

mod link;
mod missing;
mod on_the_way;
mod player;
mod port;
mod protocol;
mod restarts;
mod resuming;
