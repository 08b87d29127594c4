use crawler2d_core::*;
fn main() {
    let text = std::fs::read_to_string("tests/scenarios/engineer_belt_step.json").unwrap();
    let s = Scenario::from_json(&text).unwrap();
    let go = |j: f64| {
        let n = 10;
        let pts: Vec<[f64; 2]> = (0..=n)
            .map(|i| {
                [
                    -5.0 + 10.0 * i as f64 / n as f64,
                    if i == 0 || i == n { 0.0 } else { j * 0.0 },
                ]
            })
            .collect();
        let g = Ground {
            profile: Profile::new("g", &pts, 0., 0.9, false).unwrap(),
            goal: 4.,
            first_edge: 0.,
        };
        let mut sim = Simulation::on_ground(&s, g).unwrap();
        let mut v = vec![];
        for _ in 0..5000 {
            sim.step().unwrap();
            v.push((sim.reading(), sim.contact_table()));
        }
        v
    };
    let a = go(0.0);
    let b = go(1e-7);
    for i in (0..5000).step_by(50) {
        let (p, q) = (&a[i].0, &b[i].0);
        println!(
            "step {i} x {:.3} dx {:.2e} dy {:.2e} da {:.2e} vx {:.2e} ts {:.9}",
            p.position.x,
            p.position.x - q.position.x,
            p.position.y - q.position.y,
            p.chassis_angle - q.chassis_angle,
            p.velocity.x - q.velocity.x,
            q.track_speed
        );
        if i % 250 == 0 {
            for k in [&a, &b] {
                let t = &k[i].1;
                for j in 0..t.time.len() {
                    print!(
                        " seg{} x{:.5} N{:.3} pen{:.3e} n({:.2e},{:.3}) mu{:.3}|",
                        t.segment[j],
                        t.x[j],
                        t.normal_force[j],
                        t.penetration[j],
                        t.normal_x[j],
                        t.normal_y[j],
                        t.friction_force[j] / t.normal_force[j]
                    );
                }
                println!();
            }
        }
    }
}
