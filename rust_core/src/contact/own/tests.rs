//! The contacts against a judge that shares no code with them: every line and arc of a part against
//! every one of the ground.

#![allow(clippy::print_stdout)] // a figure is part of what a test tells

mod curve;
mod grounds;
mod judge;
mod motion;
mod outlines;
mod overlap;
mod scene;
mod separated;
