//! What people and their programs read: examples, golden outputs, logs, pages, references, the package, the sources.

mod examples;
mod figures;
mod golden;
mod links;
mod live;
mod logs;
mod package;
mod page;
mod playground;
mod reference_pages;
mod storeys;
