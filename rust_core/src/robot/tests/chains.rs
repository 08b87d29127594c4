//! Masses of chains of shoes.

use super::*;

#[test]
fn what_circulates_of_a_chain_is_all_of_its_shoes() {
    for robot in on_all_tracks() {
        let model = model(&robot);
        let whole = model.with_circulating_mass();
        for (k, chain) in model.chains.iter().enumerate() {
            assert_relative_eq!(
                whole.drive_masses[k],
                robot.track_mass,
                max_relative = 1e-13
            );
            let Some(sprocket) = &chain.sprocket else {
                continue;
            };
            // A disc as heavy as the shoes on it.
            let shoes = sprocket.teeth.count as f64;
            let mass = robot.track_mass * shoes / chain.path.count as f64;
            let radius = sprocket.teeth.radius;
            assert_relative_eq!(
                sprocket.inertia,
                0.5 * mass * radius * radius,
                max_relative = 1e-13
            );
        }
    }
}

#[test]
fn a_shoe_of_less_than_a_three_thousandth_of_the_rest_is_refused() {
    for robot in on_all_tracks() {
        let chains = model(&robot).chains;
        let Some(chain) = chains.first() else {
            continue;
        };
        let (shoes, rest) = (chain.path.count as f64, robot.mass - robot.track_mass);
        for (share, is_built) in [(0.99, false), (1.01, true)] {
            let mut light = robot.clone();
            light.track_mass = share * rest * shoes / 3000.0;
            light.mass = rest + light.track_mass;
            assert_eq!(Model::new(&light).is_ok(), is_built, "{share}");
        }
    }
}
