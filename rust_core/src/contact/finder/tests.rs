//! The contacts against a judge that shares no code with them: it tries every line and arc of a part
//! against every one of the ground.

#![allow(clippy::print_stdout)] // the printed counts say what was judged

mod curve;
mod grounds;
mod judge;
mod motion;
mod outlines;
mod overlap;
mod scene;
mod separated;
