//! What goes over the link to a chip: messages, frames, delivery, restarts.

mod charts;
mod link;
mod player;
mod port;
mod protocol;
mod resuming;
mod sensors;
mod traced;
