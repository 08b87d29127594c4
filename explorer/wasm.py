"""Compiles the core for a browser, with whatever toolchain is available."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]

TARGET = "wasm32-unknown-unknown"

# Like rustup, Debian has compilers that can build the standard library for browsers.
_DEBIAN = Path("/usr/bin")
_DEBIAN_PACKAGES = "rustc-web cargo-web rust-web-src lld"


def compile_core() -> bytes:
    """Compile the core, if it has changed.

    Returns
    -------
    bytes
        The module.

    Raises
    ------
    SystemExit
        If there is no suitable toolchain, with what is missing, or if it failed.
    """
    folder = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "explorer"
    command, environment = _cargo()
    command += ["build", "--locked", "--profile", "explorer", "--package", "crawler2d-explorer"]
    command += ["--target", TARGET, "--target-dir", str(folder)]
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, **environment}, check=False)
    if done.returncode:
        sys.exit(done.returncode)
    return (folder / TARGET / "explorer" / "crawler2d_explorer.wasm").read_bytes()


def _cargo() -> tuple[list[str], dict[str, str]]:
    """Choose a cargo that has a standard library for browsers: the usual one, or else Debian's."""
    usual = shutil.which("rustc")
    if usual and _asked(usual, "--print", "target-libdir", "--target", TARGET).exists():
        return ["cargo"], {}
    rustc, cargo = _DEBIAN / "rustc", _DEBIAN / "cargo"
    sources = "lib/rustlib/src/rust/library/std"
    if (
        all(program.exists() for program in (rustc, cargo, _DEBIAN / "wasm-ld"))
        and (_asked(str(rustc), "--print", "sysroot") / sources).exists()
    ):
        options = ["-Z", "build-std=std,panic_abort"]
        options += ["--config", f'target.{TARGET}.linker="wasm-ld"']
        # The library needs unstable features, which only its own compiler may use.
        return [str(cargo), *options], {"RUSTC": str(rustc), "RUSTC_BOOTSTRAP": "1"}
    sys.exit(
        f"the explorer needs Rust's standard library for browsers: rustup target add {TARGET}"
        f" (Debian: apt-get install {_DEBIAN_PACKAGES})"
    )


def _asked(rustc: str, *question: str) -> Path:
    """Ask a compiler for a path; return a path that does not exist if it does not know."""
    answer = subprocess.run([rustc, *question], capture_output=True, text=True, check=False)
    return Path(answer.stdout.strip() or os.devnull + "/nowhere")
