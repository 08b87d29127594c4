use crawler2d_core::*;
fn main() {
    let text = std::fs::read_to_string("tests/scenarios/engineer_belt_step.json").unwrap();
    let s = Scenario::from_json(&text).unwrap();
    for (it, dt, sub, freq, zeta) in [
        (8, 1e-3, 4, 120., 5.),
        (200, 1e-3, 4, 120., 5.),
        (200, 2.5e-4, 4, 120., 5.),
        (200, 2.5e-4, 1, 120., 5.),
        (200, 1e-3, 4, 30., 5.),
        (200, 1e-3, 4, 30., 10.),
        (200, 1e-3, 1, 60., 5.),
        (200, 1e-3, 8, 60., 1.),
    ] {
        let mut c = s.clone();
        c.robot.belly = None;
        c.robot.drivetrain.max_torque = 100.;
        c.robot.drivetrain.max_acceleration = 1.0;
        c.robot.center_of_mass = [(0.476562847 - 0.5) * 0.365, 0.011985913];
        c.robot.track = Track::Line(LineOfWheels {
            count: 5,
            wheel_radius: None,
            wheel: Wheel::Round,
        });
        c.terrain = Terrain::Step {
            height: 0.0975850577,
            edge_radius: 0.,
            friction: 1.01589201,
        };
        c.drive.speed = 0.05;
        c.start.approach = 0.02;
        c.duration = 40.;
        c.solver.time_step = dt;
        c.solver.iterations = it;
        c.solver.contact_frequency = freq;
        c.solver.contact_damping_ratio = zeta;
        c.solver.substeps = sub;
        let r = simulate(&c, Record::default()).unwrap();
        println!(
            "it {it} dt {dt} sub {sub} f {freq} z {zeta}: {} t {:.2} a {:.5} pen {:.4}mm",
            r.outcome,
            r.metrics.time,
            r.metrics.final_angle,
            r.metrics.max_penetration * 1e3
        );
        if r.outcome == Outcome::Stopped {
            let mut sim = Simulation::new(&c).unwrap();
            while sim.time() < r.metrics.time.min(30.) {
                sim.step().unwrap();
            }
            for _ in 0..6 {
                sim.step().unwrap();
                let t = sim.contact_table();
                let rd = sim.reading();
                print!(
                    "   v {:+.1e} {:+.1e} w {:+.1e} s {:.4} |",
                    rd.velocity.x, rd.velocity.y, rd.angular_velocity, rd.track_speed
                );
                for i in 0..t.time.len() {
                    print!(
                        " w{} e{} N{:7.2} mu{:+.3} slip{:+.4} |",
                        t.body[i],
                        t.edge[i],
                        t.normal_force[i],
                        t.friction_force[i] / t.normal_force[i],
                        t.surface_speed[i]
                    );
                }
                println!();
            }
        }
    }
}
