//! Facts of mechanics that every model must keep, each with its closed form.

mod common;

mod basics;
mod belt;
mod climbing;
mod drive;
mod seizure;
mod slopes;
