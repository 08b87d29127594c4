//! Facts of mechanics that every model must keep, each with its closed form.

mod common;
mod engine_world;

mod another_engine;
mod basics;
mod belt;
mod climbing;
mod drive;
mod ghosts;
mod repeat;
mod robustness;
mod seizure;
mod slopes;
