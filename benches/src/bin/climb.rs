//! Simulates a scene up to the middle of its climb: what `benches/instructions.py` counts the instructions of.

use crawler2d_benches::Scene;

fn main() {
    let name = std::env::args().nth(1).expect("the name of a scene");
    let scene = Scene::named(&name);
    scene.climbing(&scene.checked());
}
