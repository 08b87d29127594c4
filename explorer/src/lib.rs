//! The core for a web page: a request as JSON in, an answer as JSON and columns of numbers out.
//!
//! A page writes the bytes of a request to the address from [`input`], calls [`run`], and reads the answer at the
//! addresses from [`text`] and [`numbers`]. For the request, see `answer::Request`.

// Drawings may differ in the last digit between systems.
#![allow(clippy::disallowed_methods)]

mod answer;
mod carrier;
mod columns;
mod diagnosis;
mod drawing;
mod extent;

use std::panic;
use std::sync::{Mutex, MutexGuard, Once, PoisonError};

/// The request and its answer; there is only one caller at a time.
static EXCHANGE: Mutex<Exchange> = Mutex::new(Exchange {
    request: Vec::new(),
    text: String::new(),
    numbers: Vec::new(),
});

/// The text of a panic, which ends the instance; the page reads it then.
static PANIC: Mutex<String> = Mutex::new(String::new());

struct Exchange {
    request: Vec<u8>,
    text: String,
    numbers: Vec<f64>,
}

/// Access to the value of a lock, even after a panic.
fn held<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes room for a request of this many bytes, and returns its address.
#[allow(unsafe_code)] // only for the attribute: a page calls the function by its name
#[unsafe(no_mangle)]
pub extern "C" fn input(bytes: usize) -> *mut u8 {
    let mut exchange = held(&EXCHANGE);
    exchange.request = vec![0; bytes];
    exchange.request.as_mut_ptr()
}

/// Answers the request.
#[allow(unsafe_code)] // as for `input`
#[unsafe(no_mangle)]
pub extern "C" fn run() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        panic::set_hook(Box::new(|panic| *held(&PANIC) = panic.to_string()));
    });
    let request = std::mem::take(&mut held(&EXCHANGE).request);
    let (text, numbers) = answer::of(&request);
    let mut exchange = held(&EXCHANGE);
    exchange.text = text;
    exchange.numbers = numbers;
}

/// Address of the text of the answer.
#[allow(unsafe_code)] // as for `input`
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    held(&EXCHANGE).text.as_ptr()
}

/// Its number of bytes.
#[allow(unsafe_code)] // as for `input`
#[unsafe(no_mangle)]
pub extern "C" fn text_bytes() -> usize {
    held(&EXCHANGE).text.len()
}

/// Address of the numbers to which the text refers.
#[allow(unsafe_code)] // as for `input`
#[unsafe(no_mangle)]
pub extern "C" fn numbers() -> *const f64 {
    held(&EXCHANGE).numbers.as_ptr()
}

/// Number of these numbers.
#[allow(unsafe_code)] // as for `input`
#[unsafe(no_mangle)]
pub extern "C" fn numbers_count() -> usize {
    held(&EXCHANGE).numbers.len()
}

/// Address of the text of a panic, which a page reads after `run` has failed.
#[allow(unsafe_code)] // as for `input`
#[unsafe(no_mangle)]
pub extern "C" fn panic_text() -> *const u8 {
    held(&PANIC).as_ptr()
}

/// Its number of bytes.
#[allow(unsafe_code)] // as for `input`
#[unsafe(no_mangle)]
pub extern "C" fn panic_bytes() -> usize {
    held(&PANIC).len()
}
