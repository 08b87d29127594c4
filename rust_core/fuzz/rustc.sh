#!/bin/sh
# The compiler of our own crates for make fuzz: they count which of their edges are taken, and check their arithmetic.
# Libraries are those of any release build.
case " $* " in
*" --crate-name build_script_build "* | *" - "*) exec "$@" ;;
esac
exec "$@" --cfg fuzzing -Cdebug-assertions=on -Coverflow-checks=on \
	-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
	-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
	-Cllvm-args=-sanitizer-coverage-trace-compares
