#!/bin/sh
# The compiler of our own crates for make coverage-rust: they count which of their lines run. Libraries do not.
exec "$@" -C instrument-coverage
