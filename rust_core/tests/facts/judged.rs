//! The core against a judge that shares neither code nor method with it: who gets over, in ensembles.

use crate::common::is_soak;
use crate::judge::{Scene, Settings, Tally, drawn_scene, fixed_scenes, standstills};

/// Runs a scene in both and prints what came out.
fn tally(scene: &Scene, runs: u32, settings: Settings) -> Tally {
    let tally = Tally::of(scene, runs, settings);
    println!("{}: {}", scene.name, tally.report());
    // Deeper, and an overlap may have gone unseen.
    assert!(tally.deepest() < 1e-3);
    tally
}

/// On steps that every run climbs, or none: a few runs tell, and each must end alike.
#[test]
fn core_and_judge_agree_on_low_and_on_tall_steps() {
    for (height, passes) in [(0.08, 2), (0.25, 0)] {
        let scene = fixed_scenes().swap_remove(0).on_step(height);
        assert_eq!(tally(&scene, 2, Settings::default()).passes(), [passes; 2]);
    }
}

/// Ten scenes: at a true chance of one in two hundred each, one set in twenty would fail by luck.
///
/// A robot astride a sharp ridge can be at rest with its motors at their limit and yet go on from there:
/// Coulomb's law has both solutions. The core comes to rest. The judge passes when its springs, loaded
/// when the robot swung to a stop, give back what they hold; contacts that are damped one by one
/// hardly damp two that work against each other. So where the core stands still more often, the judge
/// must stand still there, too, once it is at rest.
#[test]
fn core_and_judge_agree_over_ten_scenes() {
    if !is_soak() {
        return;
    }
    let seeds = 1..=5;
    println!("seeds of the drawn scenes: {seeds:?}");
    let mut scenes = fixed_scenes();
    scenes.extend(seeds.map(drawn_scene));
    for scene in &scenes {
        if tally(scene, 64, Settings::default()).chance() < 0.05 / 10.0 {
            let (found, kept) = standstills(scene, 64);
            println!("{}: judge keeps {kept} of {found} standstills", scene.name);
            // The swing has left more overlap in a few.
            assert!(found > 32 && 10 * kept >= 9 * found, "{}", scene.name);
        }
    }
}

/// The judge's own rates under half the step and four times the stiffness.
#[test]
fn the_judge_agrees_with_itself_when_refined() {
    if !is_soak() {
        return;
    }
    for scene in [&fixed_scenes()[0], &drawn_scene(1)] {
        let tally = Tally::of_refined(scene, 64, Settings::default());
        println!("{}, refined: {}", scene.name, tally.report());
        assert!(tally.chance() > 0.05 / 2.0);
    }
}
