//! Each shared scenario takes no more instructions than are kept in `counts.json`: valgrind counts those of its first
//! 1.5 s, in which the robot comes to its obstacle.
//!
//! Unlike times, counts hardly differ from run to run: by what loading takes, some ten thousand. They depend on the
//! compiler and the kind of processor, so those of another one are shown and not judged. `CRAWLER2D_KEEP_COUNTS=1` keeps those of now.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Mutex;
use std::{env, fs, thread};

use crawler2d_core::{Simulation, ValidScenario};
use serde::{Deserialize, Serialize};

/// [s] What is simulated of each scenario.
const DURATION: f64 = 1.5;
/// How many times what is kept a scenario may take; code that is merely laid out anew takes 1.02.
const LIMIT: f64 = 1.05;
/// What this program is called with by itself, before a file.
const SIMULATE: &str = "--simulate";

/// Instructions by scenario, and the compiler that they are of.
#[derive(Serialize, Deserialize)]
struct Counts {
    compiler: String,
    instructions: BTreeMap<String, u64>,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    if let [flag, file] = &arguments[..]
        && flag == SIMULATE
    {
        simulate(Path::new(file));
        return ExitCode::SUCCESS;
    }
    let is_filtered = arguments.iter().any(|each| !each.starts_with('-'));
    if is_filtered || cfg!(debug_assertions) {
        return ExitCode::SUCCESS; // other tests are asked for, or the counts would be those of another build
    }
    if Command::new("valgrind").arg("--version").output().is_err() {
        eprintln!(
            "instructions are not counted without valgrind (Debian: apt-get install valgrind)"
        );
        return ExitCode::SUCCESS;
    }
    let now = Counts {
        compiler: compiler(),
        instructions: count_all(scenarios()),
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/instructions/counts.json");
    if env::var_os("CRAWLER2D_KEEP_COUNTS").is_some() {
        let text = serde_json::to_string_pretty(&now).expect("numbers by name");
        fs::write(&path, text + "\n").expect("the file can be written");
        return ExitCode::SUCCESS;
    }
    let text = fs::read_to_string(&path).expect("counts are kept");
    judge(&now, &serde_json::from_str(&text).expect("counts by name"))
}

/// Simulates the beginning of a scenario.
fn simulate(file: &Path) {
    let text = fs::read_to_string(file).expect("a scenario");
    let checked = ValidScenario::from_json(&text).expect("it is valid");
    let mut simulation = Simulation::new(&checked);
    simulation
        .advance(DURATION)
        .expect("the state stays finite");
}

/// The files of the shared scenarios.
fn scenarios() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/scenarios");
    let entries = fs::read_dir(folder).expect("the shared scenarios");
    let paths = entries.map(|entry| entry.expect("a file").path());
    paths
        .filter(|path| path.extension().is_some_and(|kind| kind == "json"))
        .collect()
}

/// Counts the instructions of all files, on all cores.
fn count_all(files: Vec<PathBuf>) -> BTreeMap<String, u64> {
    let left = Mutex::new(files);
    let counts = Mutex::new(BTreeMap::new());
    let next = || left.lock().expect("nobody panics").pop();
    let work = || {
        while let Some(file) = next() {
            let name = file
                .file_stem()
                .expect("a name")
                .to_string_lossy()
                .into_owned();
            let count = count(&file);
            counts.lock().expect("nobody panics").insert(name, count);
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, Into::into) {
            scope.spawn(work);
        }
    });
    counts.into_inner().expect("nobody panics")
}

/// Counts the instructions of a file.
fn count(file: &Path) -> u64 {
    let done = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(env::current_exe().expect("this program"))
        .args([Path::new(SIMULATE), file])
        .output()
        .expect("valgrind runs");
    let said = String::from_utf8_lossy(&done.stderr);
    let count = said
        .split("Collected : ")
        .nth(1)
        .and_then(|rest| rest.lines().next());
    let count = count.and_then(|number| number.trim().parse().ok());
    count.unwrap_or_else(|| panic!("{}: {said}", file.display()))
}

/// The compiler, and the kind of processor that it compiles for.
fn compiler() -> String {
    let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let said = Command::new(rustc)
        .arg("-vV")
        .output()
        .expect("the compiler");
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    let value = |name: &str| {
        let line = said.lines().find_map(|line| line.strip_prefix(name));
        line.unwrap_or_default().trim().to_owned()
    };
    format!("rustc {} for {}", value("release:"), value("host:"))
}

/// Shows the counts beside those kept; fails if a scenario takes more than the limit, or has no count.
fn judge(now: &Counts, kept: &Counts) -> ExitCode {
    eprintln!(
        "{:24} {:>9} {:>9} ratio",
        "million instructions", "now", "kept"
    );
    let mut worse = Vec::new();
    for (name, count) in &now.instructions {
        let before = kept.instructions.get(name).copied().unwrap_or(0);
        let (count, before) = (*count as f64 / 1e6, before as f64 / 1e6);
        eprintln!("{name:24} {count:9.1} {before:9.1} {:.3}", count / before);
        if count > LIMIT * before {
            worse.push(name.as_str());
        }
    }
    if now.compiler != kept.compiler {
        eprintln!(
            "not judged: kept of {}, now {}",
            kept.compiler, now.compiler
        );
        return ExitCode::SUCCESS;
    }
    if worse.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("more than {LIMIT} times what is kept: {}", worse.join(", "));
    eprintln!("if that is meant: CRAWLER2D_KEEP_COUNTS=1 cargo test --release --test instructions");
    ExitCode::FAILURE
}
